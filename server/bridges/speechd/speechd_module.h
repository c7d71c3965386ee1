/* SPDX-License-Identifier: GPL-3.0-or-later */
/* ---- protocol of speech-dispatcher's output modules: commands in, lines and sound out ---- */
#ifndef FACCIA_BRIDGES_SPEECHD_MODULE_H
#define FACCIA_BRIDGES_SPEECHD_MODULE_H

#include "server/base/buf.h"
#include "server/bridges/bridge.h"
#include "server/bridges/remote.h"
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { READER_LINE_MOST = 1 << 20, READER_TEXT_MOST = 100000 };

enum reader_kind { READER_TEXT, READER_CHAR, READER_KEY, READER_SOUND_ICON };

struct reader_calls {
    /* False: it cannot speak now. */
    bool (*speak)(void *ctx, enum reader_kind kind, const char *text);
    void (*stop)(void *ctx);
    void (*pause)(void *ctx);
    void (*list_voices)(void *ctx);
    /* False: invalid value. */
    bool (*set)(void *ctx, const char *name, const char *value);
    void (*quit)(void *ctx);
};

struct reader_protocol {
    struct reader_calls calls;
    void *ctx;
    struct buf come, text;
    enum reader_state { READER_COMMANDS, READER_MESSAGE, READER_SETTINGS } state;
    enum reader_kind kind;
    const char *received; /* reply after the last setting */
    bool settings_count;  /* the settings are for this module */
    bool wrong;
    unsigned lines;
};

/* Handles bytes from the server. */
void reader_take(struct reader_protocol *protocol, const char *bytes, size_t size);
void reader_free(struct reader_protocol *protocol);

/* Sends a line to the server immediately; it must not contain untrusted text. */
void reader_say(const char *format, ...) __attribute__((format(printf, 1, 2)));

/* Sends up to three untrusted texts, separated by tabs, as one line after "CODE-". NULL: fewer. Line ends
 * in them become spaces. */
void reader_list(int code, const char *first, const char *second, const char *third);

/* Reports an index mark. */
void reader_mark(const char *name);

/* Sends 16-bit mono sound for the server to play. */
void reader_sound(const int16_t *samples, size_t count, unsigned rate);

/* ---- the screen reader's settings, as members of a request ---- */

struct reader_manner {
    char lang[36], voice[129], gender[8]; /* empty: none */
    char rate[16], pitch[16], volume[16];
    bool spells;
};

enum { READER_MEMBERS = 8 };

/* Applies a setting of speech-dispatcher (SSIP). False: invalid value. Accepts any language and voice: the
 * daemon ignores unknown ones. */
bool manner_set(struct reader_manner *manner, const char *name, const char *value);

/* Lists the members, up to one with name NULL; they point into the settings. */
void manner_members(const struct reader_manner *manner, struct remote_member members[READER_MEMBERS + 1]);

/* Returns the message as SSML. Free it. */
char *manner_text(const struct reader_manner *manner, enum reader_kind kind, const char *text);

/* ---- the module: speaks one message at a time ---- */

struct mark {
    char *name;
    double time;
};

struct reader_module {
    uv_loop_t loop;
    uv_pipe_t input;
    char bytes[16384];
    struct reader_protocol protocol;
    struct reader_manner manner;
    struct daemon_address place;
    struct remote *remote;
    char *room, *url;
    char *text; /* being spoken; NULL: none */
    char id[40];
    struct fetch *fetch; /* of the sound, or of the room's speech */
    struct fetch *rooms; /* whether a face speaks it; NULL: known */
    const char *ended;   /* event for the server, once the sound is complete; NULL: it is not */
    struct mark *marks;
    size_t mark_count, mark_cap, marks_told;
    struct buf sound;
    unsigned rate;    /* Hz; 0: not known yet */
    size_t samples;   /* sent to the server */
    bool begun, face; /* the room's face speaks it */
    bool watched;     /* it spoke the message before */
    bool hurried;     /* the message before was cut short */
    bool early;       /* the sound was requested without waiting for `rooms` */
    bool plain;       /* its markup was given up */
};

/* Reports the start of the message. */
void module_begin(struct reader_module *module);

/* Cancels the request, and forgets its sound and marks. */
void module_drop_sound(struct reader_module *module);

/* Ends the message with an event for the server. */
void module_finish(struct reader_module *module, const char *event);

/* Returns the request to speak, without what the daemon does not support. */
void module_ask(struct reader_module *module, const char *path, const struct remote_member *members,
                remote_bytes *bytes, remote_answered *answered);

/* A text that the daemon refuses is tried once more, its words alone. False: it was refused for something
 * else, or tried already. */
bool module_give_up_markup(struct reader_module *module, const struct remote_answer *answer);

#endif
