/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/access/token.h"
#include "server/base/mem.h"
#include <jansson.h>
#include <jwt.h>
#include <openssl/evp.h>
#include <openssl/rand.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A token longer than TOKEN_BYTES is invalid. LEEWAY_SECONDS: allowed difference between clocks. */
enum { TOKEN_BYTES = 2048, RIGHTS_BYTES = 64, ID_BYTES = 16, LEEWAY_SECONDS = 30 };

#define LATEST 253402300799.0 /* end of the year 9999 */

static const struct {
    const char *word;
    enum right right;
} rights_words[] = {{"listen", RIGHT_LISTEN}, {"speak", RIGHT_SPEAK}, {"operate", RIGHT_OPERATE}};

int rights_parse(const char *words, unsigned *rights, struct error *e) {
    *rights = 0;
    for (size_t n; *words; words += n + (words[n] != '\0')) {
        n = strcspn(words, ", ");
        unsigned found = 0;
        for (size_t i = 0; i < sizeof rights_words / sizeof *rights_words; i++)
            if (strlen(rights_words[i].word) == n && !strncmp(rights_words[i].word, words, n))
                found = rights_words[i].right;
        if (n && !found)
            return error_in_field(e, ERROR_BAD_FIELD, "rights",
                                  "unknown right '%.*s'; the rights are listen, speak and operate", (int)n,
                                  words);
        *rights |= found;
    }
    return *rights ? 0 : error_in_field(e, ERROR_BAD_FIELD, "rights", "names no right");
}

/* Writes hexadecimal digits and a NUL. */
static void write_digits(const unsigned char *bytes, size_t count, char *digits) {
    for (size_t i = 0; i < count; i++)
        snprintf(digits + 2 * i, 3, "%02x", bytes[i]);
}

void token_digest(const char *value, char digest[TOKEN_DIGEST_BYTES]) {
    unsigned char bytes[EVP_MAX_MD_SIZE];
    EVP_Digest(value, strlen(value), bytes, NULL, EVP_sha256(), NULL);
    write_digits(bytes, (TOKEN_DIGEST_BYTES - 1) / 2, digest);
}

char *token_make(const struct secrets *secrets, const struct token *token, struct error *e) {
    char rights[RIGHTS_BYTES] = "", id[2 * ID_BYTES + 1], *text = NULL;
    unsigned char random[ID_BYTES];
    for (size_t i = 0; i < sizeof rights_words / sizeof *rights_words; i++)
        if (token->rights & rights_words[i].right)
            snprintf(rights + strlen(rights), sizeof rights - strlen(rights), "%s%s", *rights ? " " : "",
                     rights_words[i].word);
    jwt_t *jwt = NULL;
    const char *secret = secrets->list[0];
    if (RAND_bytes(random, sizeof random) == 1)
        write_digits(random, sizeof random, id);
    else
        return error_set(e, ERROR_BAD_TOKEN, "no random numbers for the token's id"), NULL;
    if (jwt_new(&jwt) ||
        jwt_set_alg(jwt, JWT_ALG_HS256, (const unsigned char *)secret, (int)strlen(secret)) ||
        jwt_add_grant(jwt, "sub", token->subject) ||
        (*token->room && jwt_add_grant(jwt, "room", token->room)) || jwt_add_grant(jwt, "rights", rights) ||
        jwt_add_grant(jwt, "jti", id) || (token->issued && jwt_add_grant_int(jwt, "iat", token->issued)) ||
        jwt_add_grant_int(jwt, "exp", token->expires) || !(text = jwt_encode_str(jwt)))
        error_set(e, ERROR_BAD_TOKEN, "cannot create the token");
    jwt_free(jwt);
    return text;
}

static int copy_claim(char *out, size_t cap, const json_t *claims, const char *name, bool needed,
                      struct error *e) {
    const json_t *claim = json_object_get(claims, name);
    const char *value = json_string_value(claim);
    if ((!value && (claim || needed)) || (value && json_string_length(claim) >= cap) ||
        (value && strlen(value) != json_string_length(claim)))
        return error_set(e, ERROR_BAD_TOKEN, "the token's claim '%s' is missing, too long, or not a string",
                         name);
    snprintf(out, cap, "%s", value ? value : "");
    return 0;
}

/* Copies a NumericDate (RFC 7519, 2); *seconds is unchanged if the claim is missing. */
static int copy_date(long *seconds, const json_t *claims, const char *name, bool needed, struct error *e) {
    const json_t *claim = json_object_get(claims, name);
    double value = json_number_value(claim);
    if (!claim && !needed)
        return 0;
    if (!json_is_number(claim) || !(value >= 0 && value <= LATEST))
        return error_set(e, ERROR_BAD_TOKEN, "the token's claim '%s' is missing or not a date", name);
    *seconds = (long)value;
    return 0;
}

static int read_claims(const json_t *claims, long now, struct token *token, struct error *e) {
    char rights[RIGHTS_BYTES];
    long from = 0;
    if (copy_claim(token->subject, sizeof token->subject, claims, "sub", true, e) ||
        copy_claim(token->room, sizeof token->room, claims, "room", false, e) ||
        copy_claim(rights, sizeof rights, claims, "rights", true, e) ||
        copy_date(&token->expires, claims, "exp", true, e) || copy_date(&from, claims, "nbf", false, e) ||
        copy_date(&token->issued, claims, "iat", false, e))
        return -1;
    const char *id = json_string_value(json_object_get(claims, "jti"));
    if (id && *id)
        token_digest(id, token->id);
    if (rights_parse(rights, &token->rights, e))
        return error_set(e, ERROR_BAD_TOKEN, "the token names unknown rights");
    if (token->expires <= now)
        return error_set(e, ERROR_EXPIRED_TOKEN, "the token has expired");
    if (from > now + LEEWAY_SECONDS || token->issued > now + LEEWAY_SECONDS)
        return error_set(e, ERROR_EARLY_TOKEN, "the token is not valid yet");
    return 0;
}

/* Parses JSON text allocated by the library, and frees the text. */
static json_t *object_of(char *text) {
    json_t *object = text ? json_loads(text, 0, NULL) : NULL;
    free(text);
    return object;
}

char *token_id(const char *text) {
    jwt_t *jwt = NULL;
    const char *id = jwt_decode(&jwt, text, NULL, 0) ? NULL : jwt_get_grant(jwt, "jti");
    char *copy = id && *id ? mem_strdup(id) : NULL;
    jwt_free(jwt);
    return copy;
}

static int read_token(jwt_t *jwt, long now, struct token *token, struct error *e) {
    json_t *header = object_of(jwt_get_headers_json(jwt, NULL));
    json_t *claims = object_of(jwt_get_grants_json(jwt, NULL));
    int result;
    /* a token with "crit" must be rejected by implementations that do not understand it (RFC 7515, 4.1.11) */
    if (json_object_get(header, "crit"))
        result = error_set(e, ERROR_BAD_TOKEN,
                           "the token's header has 'crit', which this server does not support");
    else
        result = read_claims(claims, now, token, e);
    json_decref(header);
    json_decref(claims);
    return result;
}

int token_check(const struct secrets *secrets, const char *text, long now, struct token *token,
                struct error *e) {
    *token = (struct token){0};
    jwt_t *jwt = NULL;
    for (size_t i = 0; !jwt && i < secrets->count && strlen(text) < TOKEN_BYTES; i++) {
        const char *secret = secrets->list[i];
        if (jwt_decode(&jwt, text, (const unsigned char *)secret, (int)strlen(secret)))
            jwt = NULL;
        token->secret = secret_number(secret);
    }
    /* a token may declare itself unsigned: reject it */
    int result = !jwt || jwt_get_alg(jwt) != JWT_ALG_HS256
                     ? error_set(e, ERROR_BAD_TOKEN, "the token is not signed with a secret of this server")
                     : read_token(jwt, now, token, e);
    jwt_free(jwt);
    return result;
}
