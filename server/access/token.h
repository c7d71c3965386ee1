/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tokens: who may do what in which room, until when. A token is a JSON Web Token (RFC 7519) signed with
 * HMAC-SHA256 (RFC 7518, 3.2), with the claims "sub", "room" (none = any), "rights" (words with spaces
 * between) and "exp"; "nbf" and "iat" are obeyed where they are, and "jti" tells it from others. */
#ifndef FACCIA_ACCESS_TOKEN_H
#define FACCIA_ACCESS_TOKEN_H

#include "server/access/secrets.h"
#include <stdbool.h>

enum right {
    RIGHT_LISTEN = 1u << 0,  /* hear a room */
    RIGHT_SPEAK = 1u << 1,   /* speak, stop, express: on one's own stream, or in the room */
    RIGHT_OPERATE = 1u << 2, /* read the metrics, change what is kept */
    RIGHTS_ALL = RIGHT_LISTEN | RIGHT_SPEAK | RIGHT_OPERATE,
};

enum { TOKEN_SUBJECT = 64, TOKEN_ROOM = 64, TOKEN_DIGEST_BYTES = 33 };

struct token {
    char subject[TOKEN_SUBJECT + 1];
    char room[TOKEN_ROOM + 1]; /* "" = any */
    unsigned rights;
    long expires;                /* s since 1970 */
    long issued;                 /* s since 1970; 0 = it does not say */
    char id[TOKEN_DIGEST_BYTES]; /* token_digest of its "jti"; "" = it has none */
    uint64_t secret;             /* that it was signed with: its secret_number */
};

/* The rights of words such as "listen,speak". -1 with *e. */
int rights_parse(const char *words, unsigned *rights, struct error *e);

/* What a jti or a subject of any length is known by: the first half of its SHA-256, in hexadecimal digits. */
void token_digest(const char *value, char digest[TOKEN_DIGEST_BYTES]);

/* The "jti" of a token that token_check has found good, or NULL; free it. */
char *token_id(const char *text);

/* Signs, with a "jti" of its own; free the text. NULL with *e. */
char *token_make(const struct secrets *secrets, const struct token *token, struct error *e);

/* -1 with *e: "bad-token" (not one of ours, damaged, without a claim), "expired-token" or
 * "early-token". */
int token_check(const struct secrets *secrets, const char *text, long now, struct token *token,
                struct error *e);

#endif
