/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Single tokens that count no more, by their "jti", and all tokens of a subject that were issued up to a
 * time: each until the last of them would have expired anyway, when it is forgotten. */
#ifndef FACCIA_ACCESS_REVOCATIONS_H
#define FACCIA_ACCESS_REVOCATIONS_H

#include "server/access/token.h"

struct revocation;

/* Of that many at most; the one that ends first makes room. */
enum { REVOCATIONS_MOST = 4000, REVOCATION_BYTES = 80 };

struct revocations {
    struct revocation *by_key;
};

/* What is taken back. Times are s since 1970. */
struct revoked {
    char key[TOKEN_DIGEST_BYTES + 1]; /* 't' and the digest of a jti, or 's' and the digest of a subject */
    long issued;                      /* of a subject: its tokens up to that second */
    long until;
};

/* -1 with *e: "bad-field", named as the claim ("jti", "sub", "exp"), when the id or name has no byte or too
 * many, or what is taken back has ended. */
int revoked_token(struct revoked *one, const char *jti, long until, long now, struct error *e);
int revoked_subject(struct revoked *one, const char *subject, long issued, long until, long now,
                    struct error *e);

/* As a short text, for other daemons. */
void revoked_write(const struct revoked *one, char text[REVOCATION_BYTES]);
bool revoked_read(struct revoked *one, const char *text);

/* False: that is known, or over. */
bool revocations_add(struct revocations *all, const struct revoked *one, long now);
bool revocations_have(const struct revocations *all, const struct token *token);

/* Adds what a file says: "token UNTIL JTI" or "subject ISSUED UNTIL NAME" in each line, in s since 1970;
 * empty lines, and those that begin with '#', are passed over, and so is what has ended. -1 with *e:
 * "bad-secrets", with the line; others than its owner may not write it. */
int revocations_load(struct revocations *all, const char *path, long now, struct error *e);

/* Tells all that there are. */
void revocations_each(const struct revocations *all, void (*told)(void *ctx, const struct revoked *one),
                      void *ctx);

void revocations_free(struct revocations *all);

#endif
