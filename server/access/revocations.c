/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/access/revocations.h"
#include "server/base/log.h"
#include "server/base/mem.h"
#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <uthash.h>

enum { NAME_BYTES_MOST = 1024 };

#define LATEST 253402300799 /* end of the year 9999 */

struct revocation {
    struct revoked is;
    UT_hash_handle hh;
};

static void key_of(struct revoked *one, char kind, const char *value) {
    one->key[0] = kind;
    token_digest(value, one->key + 1);
}

static int check(const char *value, const char *claim, long until, long now, struct error *e) {
    if (!*value || strlen(value) > NAME_BYTES_MOST)
        return error_in_field(e, ERROR_BAD_FIELD, claim, "must have 1 to %d bytes", NAME_BYTES_MOST);
    if (until <= now || until > LATEST)
        return error_in_field(e, ERROR_BAD_FIELD, "exp",
                              "must be in the future: expired tokens are refused anyway");
    return 0;
}

int revoked_token(struct revoked *one, const char *jti, long until, long now, struct error *e) {
    *one = (struct revoked){.until = until};
    key_of(one, 't', jti);
    return check(jti, "jti", until, now, e);
}

int revoked_subject(struct revoked *one, const char *subject, long issued, long until, long now,
                    struct error *e) {
    *one = (struct revoked){.issued = issued, .until = until};
    key_of(one, 's', subject);
    if (issued < 0 || issued > now)
        return error_in_field(e, ERROR_BAD_FIELD, "iat", "must not be in the future");
    return check(subject, "sub", until, now, e);
}

void revoked_write(const struct revoked *one, char text[REVOCATION_BYTES]) {
    snprintf(text, REVOCATION_BYTES, "%s %ld %ld", one->key, one->issued, one->until);
}

bool revoked_read(struct revoked *one, const char *text) {
    char end;
    *one = (struct revoked){0};
    if (strlen(text) >= REVOCATION_BYTES || strcspn(text, " ") != sizeof one->key - 1 ||
        (*text != 't' && *text != 's') ||
        sscanf(text + sizeof one->key, "%12ld %12ld%c", &one->issued, &one->until, &end) != 2)
        return false;
    memcpy(one->key, text, sizeof one->key - 1);
    return one->issued >= 0 && one->until > 0 && one->until <= LATEST;
}

static void drop(struct revocations *all, struct revocation *r) {
    HASH_DEL(all->by_key, r);
    free(r);
}

/* Drops all expired revocations, or else the one that expires first. */
static void make_room(struct revocations *all, long now) {
    struct revocation *r, *next, *first = NULL;
    HASH_ITER(hh, all->by_key, r, next) {
        if (r->is.until <= now)
            drop(all, r);
        else if (!first || r->is.until < first->is.until)
            first = r;
    }
    if (HASH_COUNT(all->by_key) < REVOCATIONS_MOST || !first)
        return;
    log_warn("more than %d tokens are revoked: the one that expires first is valid again", REVOCATIONS_MOST);
    drop(all, first);
}

bool revocations_add(struct revocations *all, const struct revoked *one, long now) {
    struct revocation *r;
    if (one->until <= now)
        return false;
    HASH_FIND_STR(all->by_key, one->key, r);
    if (r && r->is.issued >= one->issued && r->is.until >= one->until)
        return false;
    if (!r) {
        if (HASH_COUNT(all->by_key) >= REVOCATIONS_MOST)
            make_room(all, now);
        r = mem_alloc(sizeof *r);
        r->is = *one;
        HASH_ADD_STR(all->by_key, is.key, r);
    }
    if (r->is.issued < one->issued)
        r->is.issued = one->issued;
    if (r->is.until < one->until)
        r->is.until = one->until;
    return true;
}

bool revocations_have(const struct revocations *all, const struct token *token) {
    struct revocation *r = NULL;
    struct revoked one;
    if (!all->by_key)
        return false;
    one.key[0] = 't';
    memcpy(one.key + 1, token->id, sizeof token->id);
    if (*token->id)
        HASH_FIND_STR(all->by_key, one.key, r);
    if (r)
        return true;
    key_of(&one, 's', token->subject);
    HASH_FIND_STR(all->by_key, one.key, r);
    return r && token->issued <= r->is.issued;
}

void revocations_each(const struct revocations *all, void (*told)(void *ctx, const struct revoked *one),
                      void *ctx) {
    for (const struct revocation *r = all->by_key; r; r = r->hh.next)
        told(ctx, &r->is);
}

/* Parses a number of seconds and the space after it. */
static bool take_time(char **at, long *seconds) {
    char *end;
    *seconds = isdigit((unsigned char)**at) ? strtol(*at, &end, 10) : -1;
    if (*seconds < 0 || *end != ' ')
        return false;
    *at = end + 1;
    return true;
}

static int read_line(struct revocations *all, char *line, long now, struct error *e) {
    static const char token[] = "token ", subject[] = "subject ";
    struct revoked one = {0};
    long until, issued;
    char *at = line;
    int result;
    if (!strncmp(line, token, strlen(token)) && (at += strlen(token), take_time(&at, &until)))
        result = revoked_token(&one, at, until, now < until ? now : until - 1, e);
    else if (!strncmp(line, subject, strlen(subject)) &&
             (at += strlen(subject), take_time(&at, &issued) && take_time(&at, &until)))
        result = revoked_subject(&one, at, issued, until, now < until ? now : until - 1, e);
    else
        result = error_plain(e, ERROR_BAD_SECRETS);
    if (!result)
        revocations_add(all, &one, now);
    return result;
}

int revocations_load(struct revocations *all, const char *path, long now, struct error *e) {
    char *line = NULL;
    size_t cap = 0, number = 0;
    int result = 0;
    FILE *file = secrets_file_open(path, false, e);
    if (!file)
        return -1;
    for (ssize_t n; !result && (n = getline(&line, &cap, file)) >= 0;) {
        number++;
        line[strcspn(line, "\r\n")] = '\0';
        if (*line && *line != '#' && read_line(all, line, now, e))
            result = error_at_line(e, ERROR_BAD_SECRETS, number, 1,
                                   "%s: must be 'token UNTIL JTI' or 'subject ISSUED UNTIL NAME'", path);
    }
    free(line);
    fclose(file);
    return result;
}

void revocations_free(struct revocations *all) {
    struct revocation *r, *next;
    HASH_ITER(hh, all->by_key, r, next) {
        drop(all, r);
    }
}
