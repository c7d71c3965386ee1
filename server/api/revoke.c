/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Revoked secrets and tokens: by changed settings, and over HTTP. */
#include "server/api/api_internal.h"
#include "server/api/shared_limits.h"
#include "server/base/log.h"
#include "server/base/mem.h"
#include <stdlib.h>
#include <string.h>
#include <time.h>

void rights_renew(struct api *api) {
    const struct secrets *all = api->options.secrets;
    size_t before = api->secrets.count;
    secrets_free(&api->secrets);
    api->secrets = secrets_good(all, &api->revoked);
    if (all && api->secrets.count < all->count && api->secrets.count != before)
        log_warn("%zu of the %zu secrets in the secret file are revoked: another daemon of this cluster has "
                 "dropped them",
                 all->count - api->secrets.count, all->count);
    clients_revoke(api);
    room_events_revoke(api);
}

/* Compares with the previously accepted secrets, because the old list may have been changed in place. */
void rights_replace(struct api *api, const struct secrets *secrets) {
    for (size_t i = 0; i < api->secrets.count; i++)
        if (!secrets || !secrets_have(secrets, secret_number(api->secrets.list[i])))
            shared_limits_revoke(api->shared_limits, api->secrets.list[i]);
    api->options.secrets = secrets;
    rights_renew(api);
}

/* Revokes a token or a subject on every daemon. rights_renew then removes its clients. */
static void rights_revoke(struct api *api, const struct revoked *one) {
    if (revocations_add(&api->revocations, one, (long)time(NULL)))
        shared_limits_revoke_token(api->shared_limits, one);
}

static void revoke_one(void *ctx, const struct revoked *one) {
    rights_revoke(ctx, one);
}

void rights_revoke_all(struct api *api, const struct revocations *all) {
    if (all)
        revocations_each(all, revoke_one, api);
}

struct taking_back {
    struct exchange *x;
};

/* Reads a time. -1 with *e if it is missing without a default, not an integer, or negative. */
static int take_time(const json_t *body, const char *name, long otherwise, long *seconds, struct error *e) {
    const json_t *value = json_object_get(body, name);
    *seconds = value ? (long)json_integer_value(value) : otherwise;
    if (value ? json_is_integer(value) && *seconds >= 0 : otherwise >= 0)
        return 0;
    return error_in_field(e, value ? ERROR_BAD_FIELD : ERROR_MISSING_FIELD, name,
                          "must be a time in seconds since 1970");
}

/* Revokes a token by its full text. If the token is invalid, there is nothing to revoke: an error. */
static int whole(const struct api *api, const char *text, long now, struct revoked *one, struct error *e) {
    struct token token;
    if (!api->options.secrets)
        return error_in_field(e, ERROR_BAD_FIELD, "token", "this server does not require tokens");
    if (token_check(&api->secrets, text, now, &token, e))
        return error_in_field(e, ERROR_BAD_FIELD, "token", "is not a token of this server");
    if (!*token.id)
        return error_in_field(e, ERROR_BAD_FIELD, "token",
                              "has no 'jti': revoke its subject, 'sub', instead");
    *one = (struct revoked){.key = "t", .until = token.expires};
    memcpy(one->key + 1, token.id, sizeof token.id);
    return 0;
}

static int read_body(const struct api *api, const json_t *body, struct revoked *one, struct error *e) {
    const char *token = json_string_value(json_object_get(body, "token"));
    const char *jti = json_string_value(json_object_get(body, "jti"));
    const char *subject = json_string_value(json_object_get(body, "sub"));
    long now = (long)time(NULL), issued, until;
    if ((token != NULL) + (jti != NULL) + (subject != NULL) != 1)
        return error_in_field(e, ERROR_MISSING_FIELD, "token",
                              "one of 'token', 'jti' and 'sub' is needed, as a string");
    if (token)
        return whole(api, token, now, one, e);
    if (take_time(body, "exp", -1, &until, e) || take_time(body, "iat", now, &issued, e))
        return -1;
    return jti ? revoked_token(one, jti, until, now, e)
               : revoked_subject(one, subject, issued, until, now, e);
}

static int on_body_end(void *self) {
    struct exchange *x = ((struct taking_back *)self)->x;
    struct api *api = exchange_api(x);
    const struct buf *bytes = exchange_body(x);
    struct revoked one;
    struct error e;
    json_error_t why;
    json_t *body = json_loadb(bytes->size ? (const char *)bytes->data : "", bytes->size, 0, &why);
    int failed = body ? read_body(api, body, &one, &e) : error_bad_json(&why, &e);
    json_decref(body);
    if (failed)
        return exchange_error(x, &e);
    rights_revoke(api, &one);
    failed = exchange_json(x, 200, json_pack("{ss sI}", "type", "revoked", "exp", (json_int_t)one.until));
    rights_renew(api); /* the client that asked may be affected */
    return failed;
}

int revoke_post(struct exchange *x) {
    struct taking_back *t = mem_alloc(sizeof *t);
    t->x = x;
    exchange_set_work(x, (struct exchange_work){.body_end = on_body_end, .free = free, .self = t});
    exchange_expect_body(x, exchange_api(x)->options.http.message_bytes, ERROR_MESSAGE_TOO_LONG);
    return 0;
}
