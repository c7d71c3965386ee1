/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What somebody wants spoken, and how: the same for the socket, HTTP and the command line. The members of the
 * `speak` message have its names, and their ranges are declared in protocol/messages.json. */
#ifndef FACCIA_SYNTHESIS_SPEECH_REQUEST_H
#define FACCIA_SYNTHESIS_SPEECH_REQUEST_H

#include "server/base/field.h"
#include "server/expression/expressions.h"
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* When it is spoken, on a stream that speaks already. */
enum speech_mode {
    SPEAK_QUEUE,     /* after all that waits */
    SPEAK_REPLACE,   /* now: all else is forgotten */
    SPEAK_INTERRUPT, /* now: what speaks is cut, what waits comes afterwards */
    SPEAK_QUIET,     /* now, when nothing speaks or waits; else not at all */
};

/* Of two, the higher one comes first and cuts the lower one; nothing does so to a higher one. */
enum speech_priority { PRIORITY_BACKGROUND, PRIORITY_CHAT, PRIORITY_ALARM };

/* Of the voice, where none is named. */
enum voice_gender { GENDER_ANY, GENDER_FEMALE, GENDER_MALE };

/* How expressions share the mouth with speech. */
enum speech_blend {
    SPEAK_BLEND_AUTO, /* as the text asks: by weights where it names one, else by regions */
    SPEAK_BLEND_REGIONS,
    SPEAK_BLEND_WEIGHTED,
};

/* Whether what a text does not write in words (numbers, signs, short forms) is put into words before the
 * voice sees it, and what Markdown writes is left out. */
enum speech_normalize { NORMALIZE_ON, NORMALIZE_OFF };

/* How lines that end without punctuation are read. */
enum speech_verse { VERSE_RUN_ON, VERSE_PAUSE };

struct speech_request {
    char *text; /* as it came: not checked, may hold NUL */
    size_t text_size;
    char *passage;               /* the id of a passage of the library, to be spoken instead of a text */
    double from;                 /* UTF-16 units of the passage that are left out */
    char *languages;             /* of a plain text: the stretches in others (language_runs.h) */
    char *id;                    /* the client's own name for it; NULL = none; at most 64 bytes */
    char *lang, *voice, *engine; /* NULL = the default */
    enum voice_gender gender;    /* of the voice, when none is named */
    char *markup;                /* NULL = plain */
    double rate;                 /* words per minute, 40..500; 0 = the voice's own */
    double pitch, volume;        /* factors, 0.25..4 */
    double fps;                  /* 1..120 */
    double seed;                 /* integer, 0..2^53; negative = not given */
    double life;                 /* strength of the signs of life, 0..2; negative = not given */
    enum speech_blend blend;
    enum face_contacts contacts; /* whether lips that must touch do, whatever the engine makes */
    enum speech_normalize normalize;
    enum speech_verse verse;
    bool still;      /* only the lips move */
    bool phones;     /* its phones are events, too */
    bool again;      /* what is lost with the daemon that was to speak it is asked of the next */
    uint64_t abroad; /* not 0: another daemon asks, which tells the end when it has lost this one. Its name as
                        a number, and which time it follows, 32 bits each. No field */
    uint64_t
        order;  /* not 0: its number among what is asked at all daemons, which its events tell. No field */
    bool ahead; /* nobody waits for it: its sentences are to be kept (voice_pool.h) */
    bool open;  /* the text is still being written: see synthesis_write */
    enum speech_mode mode;
    enum speech_priority priority;
    uint16_t
        half; /* the high half of a character with which the text of an open one ends; 0 = none. No field */
    uint32_t quota_key;  /* whose it is, as a number; 0 = nobody's. No field: those who ask do not say */
    uint32_t connection; /* by which of the quota key's connections, likewise */
    char *topic;         /* what it is about: takes the place of those that wait with the same; NULL = none */
};

void request_init(struct speech_request *request);
void request_free(struct speech_request *request);
void request_copy(struct speech_request *to, const struct speech_request *from);

/* "female", "male"; NULL = any. */
const char *request_gender(const struct speech_request *request);

/* The name of the i-th field; NULL: there are no more. */
const char *request_field(size_t i);

/* The value of the i-th field, as JSON has it; borrowed. False: it was not given. */
bool request_get(const struct speech_request *request, size_t i, struct request_value *value);

/* Sets the field of that name. 0; 1 when there is no such field (nothing is done); -1 with *e "bad-field"
 * when the value is not of the field's type or range. */
int request_set(struct speech_request *request, const char *name, struct request_value value,
                struct error *e);

#endif
