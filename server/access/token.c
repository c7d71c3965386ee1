/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/access/token.h"
#include "server/base/mem.h"
#include <errno.h>
#include <jwt.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A token is longer than it need be: nobody's. */
enum { TOKEN_BYTES = 2048, RIGHTS_BYTES = 64 };

static const struct {
    const char *word;
    enum right right;
} rights_words[] = {{"listen", RIGHT_LISTEN}, {"speak", RIGHT_SPEAK}, {"operate", RIGHT_OPERATE}};

int secrets_load(struct secrets *secrets, const char *path, struct error *e) {
    *secrets = (struct secrets){0};
    FILE *file = fopen(path, "r");
    if (!file)
        return error_set(e, "bad-file", "%s: %s", path, strerror(errno));
    char *line = NULL;
    size_t cap = 0, list_cap = 0, number = 0;
    int result = 0;
    for (ssize_t n; !result && (n = getline(&line, &cap, file)) >= 0;) {
        number++;
        n = (ssize_t)strcspn(line, "\r\n");
        if (!n)
            continue;
        line[n] = '\0';
        if (n < TOKEN_SECRET_MIN) {
            result = error_at_line(e, "bad-file", number, 1, "%s: a secret must have at least %d bytes", path,
                                   TOKEN_SECRET_MIN);
            break;
        }
        secrets->list = mem_grow(secrets->list, &list_cap, secrets->count + 1, sizeof *secrets->list);
        secrets->list[secrets->count++] = mem_strdup(line);
    }
    free(line);
    fclose(file);
    if (!result && !secrets->count)
        result = error_set(e, "bad-file", "%s: holds no secret", path);
    if (result)
        secrets_free(secrets);
    return result;
}

void secrets_free(struct secrets *secrets) {
    for (size_t i = 0; i < secrets->count; i++)
        free(secrets->list[i]);
    free(secrets->list);
    *secrets = (struct secrets){0};
}

int rights_parse(const char *words, unsigned *rights, struct error *e) {
    *rights = 0;
    for (size_t n; *words; words += n + (words[n] != '\0')) {
        n = strcspn(words, ", ");
        unsigned found = 0;
        for (size_t i = 0; i < sizeof rights_words / sizeof *rights_words; i++)
            if (strlen(rights_words[i].word) == n && !strncmp(rights_words[i].word, words, n))
                found = rights_words[i].right;
        if (n && !found)
            return error_in_field(e, "bad-field", "rights",
                                  "no right '%.*s'; there are listen, speak, operate", (int)n, words);
        *rights |= found;
    }
    return *rights ? 0 : error_in_field(e, "bad-field", "rights", "names no right");
}

char *token_make(const struct secrets *secrets, const struct token *token, struct error *e) {
    char rights[RIGHTS_BYTES] = "", *text = NULL;
    for (size_t i = 0; i < sizeof rights_words / sizeof *rights_words; i++)
        if (token->rights & rights_words[i].right)
            snprintf(rights + strlen(rights), sizeof rights - strlen(rights), "%s%s", *rights ? " " : "",
                     rights_words[i].word);
    jwt_t *jwt = NULL;
    const char *secret = secrets->list[0];
    if (jwt_new(&jwt) ||
        jwt_set_alg(jwt, JWT_ALG_HS256, (const unsigned char *)secret, (int)strlen(secret)) ||
        jwt_add_grant(jwt, "sub", token->subject) ||
        (*token->room && jwt_add_grant(jwt, "room", token->room)) || jwt_add_grant(jwt, "rights", rights) ||
        jwt_add_grant_int(jwt, "exp", token->expires) || !(text = jwt_encode_str(jwt)))
        error_set(e, "bad-token", "the token could not be made");
    jwt_free(jwt);
    return text;
}

static int copy_claim(char *out, size_t cap, jwt_t *jwt, const char *name, bool needed, struct error *e) {
    const char *value = jwt_get_grant(jwt, name);
    if ((!value && needed) || (value && strlen(value) >= cap))
        return error_set(e, "bad-token", "the token's claim '%s' is missing or too long", name);
    snprintf(out, cap, "%s", value ? value : "");
    return 0;
}

static int read_claims(jwt_t *jwt, long now, struct token *token, struct error *e) {
    char rights[RIGHTS_BYTES];
    if (copy_claim(token->subject, sizeof token->subject, jwt, "sub", true, e) ||
        copy_claim(token->room, sizeof token->room, jwt, "room", false, e) ||
        copy_claim(rights, sizeof rights, jwt, "rights", true, e))
        return -1;
    if (rights_parse(rights, &token->rights, e))
        return error_set(e, "bad-token", "the token names rights that there are not");
    token->expires = jwt_get_grant_int(jwt, "exp");
    if (token->expires <= now)
        return error_set(e, "expired-token", "the token has expired");
    return 0;
}

int token_check(const struct secrets *secrets, const char *text, long now, struct token *token,
                struct error *e) {
    if (strchr(text, '~') && strlen(text) < TOKEN_BYTES)
        return token_check_short(secrets, text, now, token, e);
    *token = (struct token){0};
    jwt_t *jwt = NULL;
    for (size_t i = 0; !jwt && i < secrets->count && strlen(text) < TOKEN_BYTES; i++) {
        const char *secret = secrets->list[i];
        if (jwt_decode(&jwt, text, (const unsigned char *)secret, (int)strlen(secret)))
            jwt = NULL;
    }
    /* a token may say that it is not signed: that is no token of ours */
    int result = !jwt || jwt_get_alg(jwt) != JWT_ALG_HS256
                     ? error_set(e, "bad-token", "the token is not signed with a secret of this server")
                     : read_claims(jwt, now, token, e);
    jwt_free(jwt);
    return result;
}
