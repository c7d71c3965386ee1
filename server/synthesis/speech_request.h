/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A request to speak, as the socket, HTTP and the command line make it: what is spoken, when, and how.
 * Members that clients may set are named as in the `speak` message; protocol/messages.json declares their
 * ranges. */
#ifndef FACCIA_SYNTHESIS_SPEECH_REQUEST_H
#define FACCIA_SYNTHESIS_SPEECH_REQUEST_H

#include "server/base/json/field.h"
#include "server/expression/expressions.h"
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct lexicons;

/* When a request is spoken on a stream that is already speaking. */
enum speech_mode {
    SPEAK_QUEUE,     /* after all waiting utterances */
    SPEAK_REPLACE,   /* now; cuts the current utterance and drops the waiting ones */
    SPEAK_INTERRUPT, /* now; cuts the current utterance, the waiting ones follow */
    SPEAK_QUIET,     /* now if the stream is idle, else refused */
};

/* In ascending order. A request goes before those of lower priority and may cut them, never the reverse. */
enum speech_priority { PRIORITY_BACKGROUND, PRIORITY_CHAT, PRIORITY_ALARM };

/* Gender of the voice to choose when the request names no voice. */
enum voice_gender { GENDER_ANY, GENDER_FEMALE, GENDER_MALE };

/* How expressions and speech share the mouth. */
enum speech_blend {
    SPEAK_BLEND_AUTO, /* weighted if the text sets a weight, else by regions */
    SPEAK_BLEND_REGIONS,
    SPEAK_BLEND_WEIGHTED,
};

/* Whether numbers, signs and abbreviations are expanded to words before the voice sees them, and Markdown
 * syntax is left out. */
enum speech_normalize { NORMALIZE_ON, NORMALIZE_OFF };

/* How lines that end without punctuation are read. */
enum speech_verse { VERSE_RUN_ON, VERSE_PAUSE, VERSE_SCAN };

/* Whether the speakers of a passage have the voices of the work's cast. */
enum speech_cast {
    SPEAK_CAST_AUTO, /* if the request names no voice */
    SPEAK_CAST_ON,
    SPEAK_CAST_OFF,
};

/* Who speaks the dialogue of plain prose. */
enum speech_dialogue { DIALOGUE_ONE_VOICE, DIALOGUE_VOICES };

enum speech_directions { DIRECTIONS_SILENT, DIRECTIONS_SPOKEN };

struct speech_request {
    char *text; /* as received: not validated, may contain NUL */
    size_t text_size;
    char *passage;   /* id of a passage of the library, spoken instead of a text */
    double from;     /* where to start in the passage, UTF-16 units */
    char *languages; /* stretches of a plain text in other languages (language_runs.h) */
    char *speaker;   /* who speaks: any name, or an id of the cast of `work`; NULL = nobody */
    char *speakers;  /* who speaks which stretch of a plain text (speaker_runs.h) */
    enum speech_cast cast;
    enum speech_directions directions; /* of a passage */
    enum speech_dialogue dialogue;     /* if nothing else says who speaks */
    bool names;                        /* of a passage: the speakers' names are spoken */
    char *id;                          /* the client's id for the utterance, at most 64 bytes; NULL = none */
    char *lang, *voice, *engine;       /* NULL = the default */
    enum voice_gender gender;          /* of the voice, if `voice` is NULL */
    char *markup;                      /* NULL = plain */
    double rate;                       /* words per minute, 40..500; 0 = the voice's own */
    double pitch, volume;              /* factors, 0.25..4 */
    double fps;                        /* 1..120 */
    double seed;                       /* integer, 0..2^53; negative = not given */
    double life;                       /* strength of idle motion, 0..2; negative = not given */
    char *affect;                      /* emotion of the whole text; NULL = none */
    enum speech_blend blend;
    enum face_contacts contacts; /* whether to close lips that must touch, whatever the engine produces */
    enum speech_normalize normalize;
    enum speech_verse verse;
    char *work;    /* or passage of the library, whose lexicons hold for the text; NULL = that of `passage` */
    char *lexicon; /* a PLS document: how words of the text are said; NULL = none */
    bool still;    /* only the lips move */
    bool bell;     /* a bell sounds first */
    bool phones;   /* report phones as events, too */
    bool again;    /* if the daemon that speaks it is lost, the next leader of the room speaks it again */
    bool ahead;    /* prerendering for the cache: runs in the background (voice_pool.h) */
    bool open;     /* the text is still being written: see synthesis_write */
    enum speech_mode mode;
    enum speech_priority priority;
    char *topic; /* replaces waiting requests with the same topic; NULL = none */
    /* The daemon sets the following members; clients cannot. */
    /* Lexicons of the room, which go before the daemon's; NULL = none. Borrowed until the synthesis is open.
     */
    const struct lexicons *around;
    double speed;        /* factor of the rate, for interfaces that know no words per minute; 0 = none */
    uint64_t origin;     /* not 0: forwarded by another daemon, which reports the end itself if it loses this
                            one. Its name as a number, and its session with this daemon, 32 bits each */
    uint64_t command;    /* cluster-wide number of the command that caused it, repeated in events; 0 = none */
    uint32_t quota_key;  /* client that it counts against; 0 = none */
    uint32_t connection; /* connection within the quota key; 0 = none */
    uint16_t half;       /* high surrogate at the end of an open text, waiting for its low one; 0 = none */
};

void request_init(struct speech_request *request);
void request_free(struct speech_request *request);
void request_copy(struct speech_request *to, const struct speech_request *from);

/* Returns "female", "male", or NULL for any. */
const char *request_gender(const struct speech_request *request);

/* Returns the name of the i-th field that clients may set, or NULL after the last. */
const char *request_field(size_t i);

/* Gets the i-th field's value as in JSON; strings are borrowed. Returns false if it was not given. */
bool request_get(const struct speech_request *request, size_t i, struct request_value *value);

/* Sets the field of that name. Returns 1 if there is no such field, and -1 with *e ("bad-field") if the
 * value has the wrong type or is out of range. */
int request_set(struct speech_request *request, const char *name, struct request_value value,
                struct error *e);

#endif
