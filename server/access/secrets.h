/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Secrets for signing tokens, read from a file: one per line, at least SECRET_BYTES_MIN bytes each. The
 * first signs; all are accepted, so that a secret can be replaced without invalidating tokens. */
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

/* Returns -1 with *e "bad-secrets": with the line if a secret is too short; also for a folder, or a file
 * that anybody but its owner can write or replace. Logs a warning if the file is world-readable. */
int secrets_load(struct secrets *secrets, const char *path, struct error *e);
void secrets_free(struct secrets *secrets);

/* Opens a file that controls access, for reading. Returns NULL with *e if anybody but its owner can write it.
 * secret: also warn if it is world-readable. */
FILE *secrets_file_open(const char *path, bool secret, struct error *e);

/* Identifies a secret without storing it. */
uint64_t secret_number(const char *secret);
bool secrets_have(const struct secrets *secrets, uint64_t number);

/* A secret's public name among daemons, which reveals no more about it than a token does: the first half
 * of HMAC-SHA256, keyed with the secret, over a fixed text, in hexadecimal digits. */
enum { SECRET_MARK_BYTES = 33 };
void secret_mark(const char *secret, char mark[SECRET_MARK_BYTES]);

/* Adds a copy of the secret. */
void secrets_add(struct secrets *secrets, const char *secret);

/* secrets_revoked.c: revoked secrets, by their marks. */
struct secrets_revoked {
    char (*marks)[SECRET_MARK_BYTES];
    size_t count;
};

/* Returns false when the mark is known, or malformed. */
bool secrets_revoked_add(struct secrets_revoked *revoked, const char *mark);

/* Returns a copy of the secrets that are not revoked. */
struct secrets secrets_good(const struct secrets *secrets, const struct secrets_revoked *revoked);

#endif
