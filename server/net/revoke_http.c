/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A token, or all of a subject's, is taken back over HTTP. */
#include "server/base/mem.h"
#include "server/net/net_internal.h"
#include <stdlib.h>
#include <string.h>
#include <time.h>

struct taking_back {
    struct exchange *x;
};

/* -1 with *e when it is missing, no whole number, or none of a time. */
static int take_time(const json_t *body, const char *name, long otherwise, long *seconds, struct error *e) {
    const json_t *value = json_object_get(body, name);
    *seconds = value ? (long)json_integer_value(value) : otherwise;
    if (value ? json_is_integer(value) && *seconds >= 0 : otherwise >= 0)
        return 0;
    return error_in_field(e, value ? ERROR_BAD_FIELD : ERROR_MISSING_FIELD, name,
                          "must be a time in whole seconds since 1970");
}

/* A token itself says all that is needed; whatever is wrong with it, it opens nothing. */
static int whole(const struct net *net, const char *text, long now, struct revoked *one, struct error *e) {
    struct token token;
    if (!net->options.secrets)
        return error_in_field(e, ERROR_BAD_FIELD, "token", "this server demands no tokens");
    if (token_check(&net->secrets, text, now, &token, e))
        return error_in_field(e, ERROR_BAD_FIELD, "token", "is not one that this server takes");
    if (!*token.id)
        return error_in_field(e, ERROR_BAD_FIELD, "token",
                              "has no 'jti': take back what its subject, 'sub', has");
    *one = (struct revoked){.key = "t", .until = token.expires};
    memcpy(one->key + 1, token.id, sizeof token.id);
    return 0;
}

static int read_body(const struct net *net, const json_t *body, struct revoked *one, struct error *e) {
    const char *token = json_string_value(json_object_get(body, "token"));
    const char *jti = json_string_value(json_object_get(body, "jti"));
    const char *subject = json_string_value(json_object_get(body, "sub"));
    long now = (long)time(NULL), issued, until;
    if ((token != NULL) + (jti != NULL) + (subject != NULL) != 1)
        return error_in_field(e, ERROR_MISSING_FIELD, "token",
                              "one of 'token', 'jti' and 'sub' must be there, as a string");
    if (token)
        return whole(net, token, now, one, e);
    if (take_time(body, "exp", -1, &until, e) || take_time(body, "iat", now, &issued, e))
        return -1;
    return jti ? revoked_token(one, jti, until, now, e)
               : revoked_subject(one, subject, issued, until, now, e);
}

static int on_body_end(void *self) {
    struct exchange *x = ((struct taking_back *)self)->x;
    struct net *net = exchange_net(x);
    const struct buf *bytes = exchange_body(x);
    struct revoked one;
    struct error e;
    json_error_t why;
    json_t *body = json_loadb(bytes->size ? (const char *)bytes->data : "", bytes->size, 0, &why);
    int failed = body ? read_body(net, body, &one, &e) : message_bad_json(&why, &e);
    json_decref(body);
    if (failed)
        return exchange_error(x, &e);
    rights_revoke(net, &one);
    failed = exchange_json(x, 200, json_pack("{ss sI}", "type", "revoked", "exp", (json_int_t)one.until));
    rights_renew(net); /* who asked may be among them */
    return failed;
}

int revoke_post(struct exchange *x) {
    struct taking_back *t = mem_alloc(sizeof *t);
    t->x = x;
    exchange_set_work(x, (struct exchange_work){.body_end = on_body_end, .free = free, .self = t});
    exchange_expect_body(x, exchange_net(x)->options.message_bytes, ERROR_MESSAGE_TOO_LONG);
    return 0;
}
