/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Access tokens. A token grants a subject rights in one room, or in all, until it expires. It is a JSON Web
 * Token (RFC 7519) signed with HMAC-SHA256 (RFC 7518, 3.2). Claims: "sub"; "room" (absent: any room);
 * "rights" (words separated by spaces); "exp"; optionally "nbf" and "iat"; "jti", which identifies the token.
 */
#ifndef FACCIA_ACCESS_TOKEN_H
#define FACCIA_ACCESS_TOKEN_H

#include "server/access/secrets.h"
#include <stdbool.h>

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
