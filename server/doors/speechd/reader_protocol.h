/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The protocol of speech-dispatcher's output modules: commands in, lines and sound out. */
#ifndef FACCIA_DOORS_READER_PROTOCOL_H
#define FACCIA_DOORS_READER_PROTOCOL_H

#include "server/base/buf.h"
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { READER_LINE_MOST = 1 << 20, READER_TEXT_MOST = 100000 };

enum reader_kind { READER_TEXT, READER_CHAR, READER_KEY, READER_SOUND_ICON };

struct reader_calls {
    /* False: it cannot be spoken now. */
    bool (*speak)(void *ctx, enum reader_kind kind, const char *text);
    void (*stop)(void *ctx);
    void (*pause)(void *ctx);
    void (*list_voices)(void *ctx);
    /* False: no such value. */
    bool (*set)(void *ctx, const char *name, const char *value);
    void (*quit)(void *ctx);
};

struct reader_protocol {
    struct reader_calls calls;
    void *ctx;
    struct buf come, text;
    enum reader_state { READER_COMMANDS, READER_MESSAGE, READER_SETTINGS } state;
    enum reader_kind kind;
    const char *received; /* what is said when all settings have come */
    bool settings_count;  /* they are ours */
    bool wrong;
    unsigned lines;
};

/* What has come from the server. */
void reader_take(struct reader_protocol *protocol, const char *bytes, size_t size);
void reader_free(struct reader_protocol *protocol);

/* A line to the server, at once; or two, of which nothing was written by others. */
void reader_say(const char *format, ...) __attribute__((format(printf, 1, 2)));

/* Up to three texts of others, with tabs between them, as one line behind "CODE-". NULL: fewer. What would
 * end the line becomes a space, so that no text makes a line of its own. */
void reader_list(int code, const char *first, const char *second, const char *third);

/* An index mark has been reached. */
void reader_mark(const char *name);

/* Sound, 16 bit, mono, for the server to play. */
void reader_sound(const int16_t *samples, size_t count, unsigned rate);

#endif
