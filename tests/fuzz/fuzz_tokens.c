/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Access control. Byte 0 selects: a forged token, the header and claims of a JWT (one per line) to be signed
 * with the right secret, the claims of a token to issue, an origin with host and list (one per line), a file
 * of secrets, or a file of revocations. */
#include "server/access/origin.h"
#include "server/access/revocations.h"
#include "server/access/token.h"
#include "server/base/mem.h"
#include "server/base/utf8.h"
#include "tests/fuzz/fuzz.h"
#include <jwt.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { NOW = 1000000, LIST_MAX = 8 };

static char secret[] = "0123456789abcdef0123456789abcdef";
static const struct secrets secrets = {(char *[]){secret}, 1};

static void check_token(const struct token *t) {
    FUZZ_CHECK(memchr(t->subject, 0, sizeof t->subject) && memchr(t->room, 0, sizeof t->room));
    FUZZ_CHECK(t->rights && !(t->rights & ~(unsigned)RIGHTS_ALL) && t->expires > NOW);
}

/* Random bytes never contain a valid signature. */
static void forged(const char *text) {
    struct token token;
    struct error e = {0};
    FUZZ_CHECK(token_check(&secrets, text, NOW, &token, &e) && e.code);
}

static void signed_claims(struct fuzz_input *in) {
    struct token token;
    struct error e = {0};
    jwt_t *jwt = NULL;
    char *headers = fuzz_line(in), *claims = fuzz_rest_text(in), *text = NULL;
    if (!jwt_new(&jwt) && !jwt_set_alg(jwt, JWT_ALG_HS256, (unsigned char *)secret, (int)strlen(secret)) &&
        !jwt_add_grants_json(jwt, claims) && (!*headers || !jwt_add_headers_json(jwt, headers)))
        text = jwt_encode_str(jwt);
    if (text && !token_check(&secrets, text, NOW, &token, &e))
        check_token(&token);
    free(text);
    jwt_free(jwt);
    free(headers);
    free(claims);
}

/* An issued token reads back unchanged. */
static void made(struct fuzz_input *in) {
    struct token token = {.rights = 1 + fuzz_u8(in) % RIGHTS_ALL, .expires = NOW + 1 + fuzz_u16(in)}, again;
    char *subject = fuzz_line(in), *room = fuzz_rest_text(in);
    struct error e = {0};
    snprintf(token.subject, sizeof token.subject, "%s", *subject ? subject : "anna");
    snprintf(token.room, sizeof token.room, "%s", room);
    bool is_text = utf8_check(token.subject, strlen(token.subject)) == strlen(token.subject) &&
                   utf8_check(token.room, strlen(token.room)) == strlen(token.room);
    char *text = is_text ? token_make(&secrets, &token, &e) : NULL;
    if (text) {
        FUZZ_CHECK(!token_check(&secrets, text, NOW, &again, &e));
        FUZZ_CHECK(!strcmp(again.subject, token.subject) && !strcmp(again.room, token.room) &&
                   again.rights == token.rights && again.expires == token.expires);
    }
    free(text);
    free(subject);
    free(room);
}

static void origin(struct fuzz_input *in) {
    char *list[LIST_MAX + 1] = {NULL}, *from = fuzz_line(in), *host = fuzz_line(in);
    for (size_t i = 0; i < LIST_MAX && fuzz_left(in); i++)
        list[i] = fuzz_line(in);
    origin_allowed(from, host, list);
    bool alone = origin_allowed(from, NULL, NULL);
    FUZZ_CHECK(!alone || origin_allowed(from, NULL, list)); /* a list only adds */
    free(from);
    free(host);
    for (size_t i = 0; i < LIST_MAX; i++)
        free(list[i]);
}

static void secrets_file(struct fuzz_input *in) {
    struct secrets loaded;
    struct error e = {0};
    char path[FUZZ_PATH];
    fuzz_write("secrets", in->at, fuzz_left(in), path);
    if (secrets_load(&loaded, path, &e)) {
        FUZZ_CHECK(e.code);
        return;
    }
    for (size_t i = 0; i < loaded.count; i++)
        FUZZ_CHECK(strlen(loaded.list[i]) >= SECRET_BYTES_MIN);
    secrets_free(&loaded);
}

static void check_revoked(void *ctx, const struct revoked *one) {
    char text[REVOCATION_BYTES];
    struct revoked again;
    (void)ctx;
    FUZZ_CHECK(one->until > NOW && one->issued >= 0);
    revoked_write(one, text);
    FUZZ_CHECK(revoked_read(&again, text) && !strcmp(again.key, one->key));
}

static void revoked_file(struct fuzz_input *in) {
    struct revocations loaded = {0};
    struct error e = {0};
    char path[FUZZ_PATH];
    fuzz_write("revoked", in->at, fuzz_left(in), path);
    FUZZ_CHECK(!revocations_load(&loaded, path, NOW, &e) || e.code);
    revocations_each(&loaded, check_revoked, NULL);
    revocations_free(&loaded);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    struct fuzz_input in = fuzz_input(data, size);
    char *text;
    switch (fuzz_below(&in, 5)) {
    case 0:
        forged(text = fuzz_rest_text(&in));
        free(text);
        break;
    case 1:
        signed_claims(&in);
        break;
    case 2:
        made(&in);
        break;
    case 3:
        origin(&in);
        break;
    default: /* the same bytes as either */
        secrets_file(&in);
        revoked_file(&in);
    }
    return 0;
}
