/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/api/shared_limits.h"
#include "server/api/api_internal.h"
#include "server/base/log.h"
#include "server/base/mem.h"
#include "server/cluster/cluster.h"
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <utlist.h>

enum { CLOCK_SLACK_MS = 500, OWNER_BYTES = 64, MS = 1000 };

/* Names of notes and marks on the store. */
static const char limits_note[] = "limits", use_note[] = "use ", secret_mark_name[] = "secret ",
                  token_mark_name[] = "token ";

/* A daemon whose limits differ from ours. */
struct otherwise {
    struct otherwise *next;
    char owner[OWNER_BYTES], text[PRESENCE_TEXT_BYTES];
};

struct shared_limits {
    struct api *api;
    void (*revoked)(struct api *api);
    struct presence *presence;
    bool longer;   /* something was revoked in this look at the store */
    int64_t ahead; /* shared clock minus loop clock, ms */
    char limits[PRESENCE_TEXT_BYTES];
    struct otherwise *otherwise;
};

static const char *after(const char *name, const char *prefix) {
    size_t size = strlen(prefix);
    return strncmp(name, prefix, size) ? NULL : name + size;
}

static void on_use(void *ctx, const char *key, const struct quota_use *use) {
    struct shared_limits *s = ctx;
    const struct api_options *o = &s->api->options;
    char name[PRESENCE_NAME_BYTES], text[PRESENCE_TEXT_BYTES] = "";
    bool counted = (o->http.address_connections || o->address_requests) && (use->open || use->asked);
    snprintf(name, sizeof name, "%s%s", use_note, key);
    if (counted)
        snprintf(text, sizeof text, "%u %u %" PRIu64, use->open, use->asked, use->minute);
    presence_publish(s->presence, name, text);
}

static void forget_otherwise(struct shared_limits *s, const char *owner) {
    struct otherwise *one, *next;
    LL_FOREACH_SAFE(s->otherwise, one, next) {
        if (owner && strcmp(one->owner, owner) != 0)
            continue;
        LL_DELETE(s->otherwise, one);
        free(one);
        metrics_add(s->api->pipeline->metrics, METRIC_CLUSTER_MISMATCHED, -1);
    }
}

static void compare(struct shared_limits *s, const char *owner, const char *text) {
    forget_otherwise(s, owner);
    if (!*text || !strcmp(text, s->limits))
        return;
    struct otherwise *one = mem_alloc(sizeof *one);
    snprintf(one->owner, sizeof one->owner, "%s", owner);
    snprintf(one->text, sizeof one->text, "%s", text);
    LL_PREPEND(s->otherwise, one);
    metrics_add(s->api->pipeline->metrics, METRIC_CLUSTER_MISMATCHED, 1);
    log_warn("cluster: a daemon has different settings: %s; this daemon: %s", text, s->limits);
}

static void on_seen(void *ctx, const char *owner, const char *name, const char *text) {
    struct shared_limits *s = ctx;
    struct quota_use use = {0};
    const char *key = after(name, use_note);
    if (!strcmp(name, limits_note))
        compare(s, owner, text);
    else if (key && (!*text || sscanf(text, "%9u %9u %18" SCNu64, &use.open, &use.asked, &use.minute) == 3))
        quota_seen(&s->api->quota, owner, key, &use);
}

static void on_gone(void *ctx, const char *owner) {
    struct shared_limits *s = ctx;
    forget_otherwise(s, owner);
    quota_gone(&s->api->quota, owner);
}

static void on_marked(void *ctx, const char *name, uint64_t until) {
    struct shared_limits *s = ctx;
    (void)until; /* the mark itself contains it */
    const char *mark = after(name, secret_mark_name), *text = after(name, token_mark_name);
    struct revoked one;
    if (mark)
        s->longer |= secrets_revoked_add(&s->api->revoked, mark);
    else if (text && revoked_read(&one, text))
        s->longer |= revocations_add(&s->api->revocations, &one, (long)time(NULL));
}

/* Small delays of the store's answer do not change the clock. */
static void on_looked(void *ctx, uint64_t clock) {
    struct shared_limits *s = ctx;
    int64_t ahead = (int64_t)clock - (int64_t)uv_now(s->api->pipeline->loop);
    if (llabs(ahead - s->ahead) > CLOCK_SLACK_MS)
        s->ahead = ahead;
    quota_sweep(&s->api->quota, shared_limits_now(s->api));
    if (s->longer)
        s->revoked(s->api);
    s->longer = false;
}

static const struct presence_callbacks eye = {on_seen, on_gone, on_marked, on_looked};

void shared_limits_change(struct shared_limits *s) {
    if (!s)
        return;
    const struct api_options *o = &s->api->options;
    snprintf(s->limits, sizeof s->limits, "version %s, %s, max-per-address %u, max-requests %u",
             FACCIA_VERSION, o->secrets ? "tokens" : "no tokens", o->http.address_connections,
             o->address_requests);
    presence_publish(s->presence, limits_note, s->limits);
    struct otherwise *list = s->otherwise, *one, *next;
    s->otherwise = NULL;
    LL_FOREACH_SAFE(list, one, next) {
        metrics_add(s->api->pipeline->metrics, METRIC_CLUSTER_MISMATCHED, -1);
        compare(s, one->owner, one->text);
        free(one);
    }
    quota_tell(&s->api->quota);
}

struct shared_limits *shared_limits_open(struct api *api, void (*revoked)(struct api *api)) {
    struct shared_limits *s = mem_alloc(sizeof *s);
    s->api = api;
    s->revoked = revoked;
    s->presence = api->options.presence;
    presence_watch(s->presence, &eye, s);
    api->quota.changed = on_use;
    api->quota.ctx = s;
    shared_limits_change(s);
    return s;
}

void shared_limits_revoke(struct shared_limits *s, const char *secret) {
    char mark[SECRET_MARK_BYTES], name[PRESENCE_NAME_BYTES];
    if (!s)
        return;
    secret_mark(secret, mark);
    secrets_revoked_add(&s->api->revoked, mark);
    snprintf(name, sizeof name, "%s%s", secret_mark_name, mark);
    presence_mark(s->presence, name, 0);
}

void shared_limits_revoke_token(struct shared_limits *s, const struct revoked *one) {
    char text[REVOCATION_BYTES], name[PRESENCE_NAME_BYTES];
    if (!s)
        return;
    revoked_write(one, text);
    snprintf(name, sizeof name, "%s%s", token_mark_name, text);
    presence_mark(s->presence, name, (uint64_t)one->until * MS);
}

uint64_t shared_limits_now(const struct api *api) {
    return uv_now(api->pipeline->loop) + (uint64_t)(api->shared_limits ? api->shared_limits->ahead : 0);
}

void shared_limits_close(struct shared_limits *s) {
    if (!s)
        return;
    s->api->quota.changed = NULL;
    s->api->shared_limits = NULL;
    presence_watch(s->presence, NULL, NULL);
    forget_otherwise(s, NULL);
    free(s);
}
