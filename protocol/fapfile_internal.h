/* SPDX-License-Identifier: MIT */
/* A FAP file's lines and words, with their places. Private to fapfile*.c. */
#ifndef FACCIA_PROTOCOL_FAPFILE_INTERNAL_H
#define FACCIA_PROTOCOL_FAPFILE_INTERNAL_H

#include "protocol/fapfile.h"

/* The line that is being read, without its end, and where in it the next word begins. */
struct fapfile_reader {
    const char *text, *limit; /* what has not been cut into lines yet */
    const char *line, *line_end, *at;
    size_t line_number;
    struct fapfile_error *error;
    bool (*stop)(void *ctx); /* NULL: never */
    void *ctx;
    bool stopped;
};

struct fapfile_word {
    const char *at;
    size_t size;
};

static inline bool fapfile_is_space(char c) {
    return c == ' ' || (c >= '\t' && c <= '\r');
}

static inline bool fapfile_is_digit(char c) {
    return c >= '0' && c <= '9';
}

/* Marks the place `at` in the current line. Returns -1. */
int fapfile_wrong(struct fapfile_reader *r, const char *at, const char *message);

/* The next line that is neither blank nor a comment, from its first word on. At the end of the file the place
 * is the beginning of the line that would follow. */
bool fapfile_next_content(struct fapfile_reader *r);

void fapfile_skip_space(struct fapfile_reader *r); /* in the line */

/* The next word of the line; its size is 0 at the end. */
struct fapfile_word fapfile_next_word(struct fapfile_reader *r);

/* Returns false if the word is not a number. */
bool fapfile_parse_number(struct fapfile_word w, double *value);
bool fapfile_is_infinite(struct fapfile_word w);

#endif
