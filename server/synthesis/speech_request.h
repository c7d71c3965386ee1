/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A request to speak: the same for WebSocket, HTTP and the command line. */
#ifndef FACCIA_SYNTHESIS_SPEECH_REQUEST_H
#define FACCIA_SYNTHESIS_SPEECH_REQUEST_H

#include "server/base/error.h"
#include "server/expression/expressions.h"
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* What happens when the stream is already speaking. */
enum speech_mode {
    SPEAK_QUEUE,     /* speak after everything queued */
    SPEAK_REPLACE,   /* speak now, drop everything else */
    SPEAK_INTERRUPT, /* cut the current utterance, keep the queue */
    SPEAK_QUIET,     /* speak only if nothing is playing or queued */
};

/* A higher priority is spoken first and cuts a lower one. */
enum speech_priority { PRIORITY_BACKGROUND, PRIORITY_CHAT, PRIORITY_ALARM };

/* Used when no voice is named. */
enum voice_gender { GENDER_ANY, GENDER_FEMALE, GENDER_MALE };

/* How expressions and speech share the mouth. */
enum speech_blend {
    SPEAK_BLEND_AUTO, /* weighted if the text sets a weight, else by regions */
    SPEAK_BLEND_REGIONS,
    SPEAK_BLEND_WEIGHTED,
};

enum { REQUEST_RATE_MIN = 40, REQUEST_RATE_MAX = 500 }; /* words per minute */

struct speech_request {
    char *text; /* as received: unchecked, may contain NUL */
    size_t text_size;
    char *passage;               /* id of a library passage to speak instead of a text */
    double from;                 /* UTF-16 units to skip in the passage */
    char *languages;             /* of a plain text: stretches in other languages (language_runs.h) */
    char *id;                    /* the client's own id, at most 64 bytes; NULL = none */
    char *lang, *voice, *engine; /* NULL = the default */
    enum voice_gender gender;    /* of the voice, if none is named */
    char *markup;                /* NULL = plain */
    double rate;                 /* words per minute, 40..500; 0 = the voice's own */
    double pitch, volume;        /* factors, 0.25..4 */
    double fps;                  /* 1..120 */
    double seed;                 /* integer, 0..2^53; negative = not set */
    double life;                 /* strength of idle motion, 0..2; negative = not set */
    enum speech_blend blend;
    enum face_contacts contacts; /* whether lips close where they must, whatever the engine produces */
    bool still;                  /* move only the lips */
    bool phones;                 /* send phones as events */
    bool again;                  /* another daemon repeats it if this one is lost */
    uint64_t abroad; /* not 0: the remote node that asks, and its session, 32 bits each; the request ends when
                        that node is lost. Not a field */
    uint64_t order;  /* not 0: number of the forwarded command, for its events. Not a field */
    bool ahead;      /* prerendering: nobody waits, the sentences are cached (voice_pool.h) */
    bool open;       /* the text is still being written: see synthesis_write */
    enum speech_mode mode;
    enum speech_priority priority;
    uint16_t half;  /* pending high surrogate at the end of an open text; 0 = none. Not a field */
    uint32_t payer; /* quota key; 0 = none. Set by the server, not a field */
    uint32_t asker; /* connection within the quota key, likewise */
    char *topic;    /* replaces waiting utterances of the same topic; NULL = none */
};

void request_init(struct speech_request *request);
void request_free(struct speech_request *request);
void request_copy(struct speech_request *to, const struct speech_request *from);

/* A value as received: JSON is typed, queries and options are strings. */
struct request_value {
    enum {
        REQUEST_STRING,
        REQUEST_NUMBER,
        REQUEST_BOOL,
        REQUEST_WORD,     /* a string to be converted to the field's type */
        REQUEST_STRUCTURE /* an array or object, which no field accepts */
    } type;
    const char *string;
    size_t size;
    double number; /* NUMBER, BOOL */
};

/* "female", "male"; NULL = any. */
const char *request_gender(const struct speech_request *request);

/* Returns the name of the i-th field, or NULL at the end. */
const char *request_field(size_t i);

/* Gets the i-th field's value, borrowed. Returns false if it was not set. */
bool request_get(const struct speech_request *request, size_t i, struct request_value *value);

/* Sets a field by name. Returns 0, 1 when there is no such field, or -1 with *e ("bad-field") for a wrong
 * type or range. */
int request_set(struct speech_request *request, const char *name, struct request_value value,
                struct error *e);

#endif
