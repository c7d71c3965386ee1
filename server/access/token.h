/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Access tokens. A token grants a subject rights in one room, or in all, until it expires. It is a JSON Web
 * Token (RFC 7519) signed with HMAC-SHA256 (RFC 7518, 3.2). Claims: "sub"; "room" (absent: any room);
 * "rights" (words separated by spaces); "exp"; optionally "nbf" and "iat"; "jti", which identifies the token.
 */
#ifndef FACCIA_ACCESS_TOKEN_H
#define FACCIA_ACCESS_TOKEN_H

#include "server/base/error.h"

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

/* Secrets for signing tokens, read from a file: one per line, at least SECRET_BYTES_MIN bytes each. The
 * first signs; all are accepted, so that a secret can be replaced without invalidating tokens. */

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

enum right {
    RIGHT_LISTEN = 1u << 0,  /* listen to a room */
    RIGHT_SPEAK = 1u << 1,   /* speak, stop, express: on a client's own stream, or in the room */
    RIGHT_OPERATE = 1u << 2, /* read metrics, change stored data */
    RIGHTS_ALL = RIGHT_LISTEN | RIGHT_SPEAK | RIGHT_OPERATE,
};

enum { TOKEN_SUBJECT = 64, TOKEN_ROOM = 64, TOKEN_DIGEST_BYTES = 33 };

struct token {
    char subject[TOKEN_SUBJECT + 1];
    char room[TOKEN_ROOM + 1]; /* "" = any */
    unsigned rights;
    long expires;                /* s since 1970 */
    long issued;                 /* s since 1970; 0 = not given */
    char id[TOKEN_DIGEST_BYTES]; /* token_digest of its "jti"; "" = none */
    uint64_t secret;             /* secret_number of the secret that signed it */
};

/* Parses words such as "listen,speak". Returns -1 with *e. */
int rights_parse(const char *words, unsigned *rights, struct error *e);

/* A fixed-size name for a jti or subject of any length: the first half of its SHA-256, in hexadecimal
 * digits. */
void token_digest(const char *value, char digest[TOKEN_DIGEST_BYTES]);

/* Returns the "jti" of a token that token_check has accepted, or NULL; the caller frees it. */
char *token_id(const char *text);

/* Signs a token, with a new "jti". The caller frees the text. Returns NULL with *e. */
char *token_make(const struct secrets *secrets, const struct token *token, struct error *e);

/* Verifies a token. Returns -1 with *e: "bad-token" (not signed by us, damaged, or a claim missing),
 * "expired-token" or "early-token". */
int token_check(const struct secrets *secrets, const char *text, long now, struct token *token,
                struct error *e);

#endif
