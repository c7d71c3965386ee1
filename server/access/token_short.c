/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/access/token.h"
#include "server/base/mem.h"
#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    SIGNATURE_CHARS = 22, /* of base64: 132 bits; RFC 2104, 5 wants half of the hash at least */
    PARTS = 5,
};

static const char rights_letters[] = "lso"; /* in the order of their bits */

/* What may stand in a sub-protocol's name (RFC 7230, 3.2.6), but for the sign between the parts. */
static bool is_plain(const char *text) {
    for (const char *c = text; *c; c++)
        if (!isalnum((unsigned char)*c) && !strchr("!#$%&'*+-.^_`|", *c))
            return false;
    return true;
}

static void put_expiry(char out[16], long seconds) {
    static const char digits[] = "0123456789abcdefghijklmnopqrstuvwxyz";
    char reversed[16];
    size_t n = 0;
    do
        reversed[n++] = digits[seconds % 36];
    while ((seconds /= 36) && n < sizeof reversed - 1);
    for (size_t i = 0; i < n; i++)
        out[i] = reversed[n - 1 - i];
    out[n] = '\0';
}

char *token_make_short(const struct secrets *secrets, const struct token *token, struct error *e) {
    char rights[sizeof rights_letters] = "", expiry[16];
    if (!is_plain(token->subject) || !is_plain(token->room)) {
        error_in_field(e, ERROR_BAD_FIELD, is_plain(token->room) ? "subject" : "room",
                       "must have letters, digits, - _ . only in a short token");
        return NULL;
    }
    char *jwt = token_make(secrets, token, e);
    const char *signature = jwt ? strrchr(jwt, '.') : NULL;
    if (!signature)
        return NULL;
    for (size_t i = 0; rights_letters[i]; i++)
        if (token->rights & 1u << i)
            snprintf(rights + strlen(rights), 2, "%c", rights_letters[i]);
    put_expiry(expiry, token->expires);
    size_t cap = strlen(token->subject) + strlen(token->room) + 64;
    char *text = mem_alloc(cap);
    snprintf(text, cap, "%s~%s~%s~%s~%.*s", token->subject, token->room, rights, expiry, SIGNATURE_CHARS,
             signature + 1);
    free(jwt);
    return text;
}

/* The claims, as they stand there. */
static int parse(const char *text, struct token *token) {
    char parts[PARTS][TOKEN_SUBJECT + 1];
    for (size_t i = 0; i < PARTS; i++) {
        size_t n = strcspn(text, "~");
        if (n >= sizeof parts[i] || (text[n] == '~') != (i + 1 < PARTS))
            return -1;
        memcpy(parts[i], text, n);
        parts[i][n] = '\0';
        text += n + (text[n] == '~');
    }
    snprintf(token->subject, sizeof token->subject, "%s", parts[0]);
    snprintf(token->room, sizeof token->room, "%s", parts[1]);
    for (const char *c = parts[2]; *c; c++)
        if (strchr(rights_letters, *c))
            token->rights |= 1u << (strchr(rights_letters, *c) - rights_letters);
    token->expires = strlen(parts[3]) < 12 ? strtol(parts[3], NULL, 36) : -1;
    return *token->subject && token->rights && token->expires >= 0 ? 0 : -1;
}

/* In a time that does not tell where they differ. */
static bool same(const char *a, const char *b) {
    size_t size = strlen(a);
    unsigned differs = 0;
    if (size != strlen(b))
        return false;
    for (size_t i = 0; i < size; i++)
        differs |= (unsigned char)(a[i] ^ b[i]);
    return !differs;
}

int token_check_short(const struct secrets *secrets, const char *text, long now, struct token *token,
                      struct error *e) {
    struct error ignored;
    *token = (struct token){0};
    bool good = false, read = !parse(text, token);
    for (size_t i = 0; read && i < secrets->count && !good; i++) {
        const struct secrets one = {secrets->list + i, 1};
        char *ours = token_make_short(&one, token, &ignored);
        good = ours && same(ours, text);
        token->secret = secret_number(secrets->list[i]);
        free(ours);
    }
    if (!good)
        return error_set(e, ERROR_BAD_TOKEN, "the token is not signed with a secret of this server");
    return token->expires <= now ? error_set(e, ERROR_EXPIRED_TOKEN, "the token has expired") : 0;
}
