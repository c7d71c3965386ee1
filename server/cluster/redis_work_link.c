/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/buf.h"
#include "server/base/log.h"
#include "server/cluster/redis_work_internal.h"
#include <stdlib.h>

enum { WORDS_MOST = 12 };

bool redis_work_run(struct redis_link *link, const char *script, const struct link_text *more, int count,
                    link_answered answered, void *ctx) {
    struct link_text words[WORDS_MOST] = {link_text_of("EVAL"), link_text_of(script), link_text_of("1"),
                                          link_text_of(REDIS_WORK)};
    for (int i = 0; i < count; i++)
        words[4 + i] = more[i];
    return redis_link_send(link, words, 4 + count, answered, ctx);
}

struct redis_link *redis_work_link(uv_loop_t *loop, const char *address, const char *what,
                                   void (*changed)(void *ctx, bool up), void *ctx, struct error *e) {
    struct redis_address read;
    struct buf shown = {0};
    if (redis_address_read(address, &read, e))
        return NULL;
    buf_printf(&shown, "%s (%s)", read.shown, what);
    buf_add(&shown, "", 1);
    free(read.shown);
    read.shown = (char *)shown.data;
    return redis_link_open(loop, &read, changed, ctx);
}

bool redis_work_well(const redisReply *reply) {
    if (reply && reply->type == REDIS_REPLY_ERROR)
        log_warn("cluster: the work queue: %s", reply->str);
    return reply && reply->type != REDIS_REPLY_ERROR;
}

const char *redis_work_text(const redisReply *array, size_t index) {
    const redisReply *one =
        array->type == REDIS_REPLY_ARRAY && index < array->elements ? array->element[index] : NULL;
    return one && one->type == REDIS_REPLY_STRING ? one->str : "";
}
