/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Revocations of single tokens, by "jti", and of all tokens of a subject issued up to a time. Each is
 * forgotten once the last token it revokes would have expired anyway. */
#ifndef FACCIA_ACCESS_REVOCATIONS_H
#define FACCIA_ACCESS_REVOCATIONS_H

#include "server/access/token.h"

struct revocation;

/* Once REVOCATIONS_MOST are stored, a new one replaces the one that expires first. */
enum { REVOCATIONS_MOST = 4000, REVOCATION_BYTES = 80 };

struct revocations {
    struct revocation *by_key;
};

/* One revocation. Times are s since 1970. */
struct revoked {
    char key[TOKEN_DIGEST_BYTES + 1]; /* 't' and the digest of a jti, or 's' and the digest of a subject */
    long issued;                      /* of a subject: revokes tokens issued up to this second */
    long until;
};

/* Return -1 with *e: "bad-field", naming the claim ("jti", "sub", "exp"), when the id or name is empty or
 * too long, or the revocation has already ended. */
int revoked_token(struct revoked *one, const char *jti, long until, long now, struct error *e);
int revoked_subject(struct revoked *one, const char *subject, long issued, long until, long now,
                    struct error *e);

/* Writes and reads a short text, for other daemons. */
void revoked_write(const struct revoked *one, char text[REVOCATION_BYTES]);
bool revoked_read(struct revoked *one, const char *text);

/* Returns false when the revocation is known, or has ended. */
bool revocations_add(struct revocations *all, const struct revoked *one, long now);
bool revocations_have(const struct revocations *all, const struct token *token);

/* Adds revocations from a file: "token UNTIL JTI" or "subject ISSUED UNTIL NAME" in each line, times in s
 * since 1970. Skips empty lines, lines that begin with '#', and revocations that have ended. Returns -1
 * with *e: "bad-secrets", with the line; also when others than the file's owner may write it. */
int revocations_load(struct revocations *all, const char *path, long now, struct error *e);

/* Calls told for every revocation. */
void revocations_each(const struct revocations *all, void (*told)(void *ctx, const struct revoked *one),
                      void *ctx);

void revocations_free(struct revocations *all);

#endif
