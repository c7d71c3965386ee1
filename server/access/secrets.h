/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The secrets that tokens are signed with, out of a file: one in each line, of at least SECRET_BYTES_MIN
 * bytes. The first signs; all are accepted, so that one can be replaced without cutting anybody off. */
#ifndef FACCIA_ACCESS_SECRETS_H
#define FACCIA_ACCESS_SECRETS_H

#include "server/base/error.h"
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

enum { SECRET_BYTES_MIN = 32 };

struct secrets {
    char **list;
    size_t count;
};

/* -1 with *e: "bad-secrets" (also one that is no file, or that others than its owner may write or replace),
 * or the line of a secret that is too short. One that all may read is worth a warning in the log. */
int secrets_load(struct secrets *secrets, const char *path, struct error *e);
void secrets_free(struct secrets *secrets);

/* A file that decides who may come in, to be read: NULL with *e when others than its owner may write it.
 * secret: nor should they read it, which is worth that warning. */
FILE *secrets_file_open(const char *path, bool secret, struct error *e);

/* Tells secrets from each other without holding them. */
uint64_t secret_number(const char *secret);
bool secrets_have(const struct secrets *secrets, uint64_t number);

/* A secret's name among daemons, which gives away no more of it than a token does: the first half of
 * HMAC-SHA256, with it as the key, of a text of ours, in hexadecimal digits. */
enum { SECRET_MARK_BYTES = 33 };
void secret_mark(const char *secret, char mark[SECRET_MARK_BYTES]);

/* Adds a copy. */
void secrets_add(struct secrets *secrets, const char *secret);

/* secrets_revoked.c: secrets that count no more, by their marks. */
struct secrets_revoked {
    char (*marks)[SECRET_MARK_BYTES];
    size_t count;
};

/* False: it is known, or no mark. */
bool secrets_revoked_add(struct secrets_revoked *revoked, const char *mark);

/* A copy of those that count. */
struct secrets secrets_good(const struct secrets *secrets, const struct secrets_revoked *revoked);

#endif
