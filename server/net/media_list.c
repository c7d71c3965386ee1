/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The folder of recordings: what is in it. */
#include "server/base/mem.h"
#include "server/net/net_internal.h"
#include <stdatomic.h>
#include <stdlib.h>

int media_source(const struct net *net, struct recording_source *source, const char *name, struct error *e) {
    source->fap_bytes_max = net->options.play_bytes;
    if (!net->options.media)
        return error_in_field(e, ERROR_UNKNOWN_MEDIA, "name", "there is no folder of recordings here");
    return recording_source_in(source, net->options.media, name, e);
}

/* The folder, which may be large and far away, is read in another thread. The list belongs to the exchange,
 * and to that thread until it is done. */
struct listing {
    uv_work_t work;
    struct exchange *x; /* NULL: its client is gone */
    char *folder;
    json_t *list;
    bool whole; /* false: the folder takes too long */
    bool done;
    atomic_bool left; /* the client, and so the thread stops */
};

/* Processor time for listing a folder, s. */
enum { LIST_SECONDS = 10 };

static void add(void *ctx, const char *name, bool sound) {
    struct listing *l = ctx;
    json_array_append_new(l->list, json_pack("{ss sb}", "name", name, "sound", sound));
}

static void work(uv_work_t *work) {
    struct listing *l = work->data;
    struct work_limit limit = work_limit_begin(&l->left, LIST_SECONDS);
    l->whole = recording_list(l->folder, &limit, add, l);
}

static void free_listing(struct listing *l) {
    json_decref(l->list);
    free(l->folder);
    free(l);
}

static void too_long(struct exchange *x) {
    struct error e;
    error_set(&e, ERROR_SEARCH_TOO_LONG, "the folder of recordings takes too long to list");
    exchange_error(x, &e);
}

static void after(uv_work_t *work, int status) {
    struct listing *l = work->data;
    (void)status; /* cancelled only when the client is gone */
    l->done = true;
    if (!l->x)
        free_listing(l);
    else if (l->whole)
        exchange_json(l->x, 200, json_pack("{sO}", "media", l->list));
    else
        too_long(l->x);
}

static void leave(void *self) {
    struct listing *l = self;
    l->x = NULL;
    atomic_store(&l->left, true);
    if (l->done)
        free_listing(l);
    else
        uv_cancel((uv_req_t *)&l->work);
}

int media_get(struct exchange *x) {
    struct net *net = exchange_net(x);
    if (!net->options.media)
        return exchange_json(x, 200, json_pack("{s[]}", "media"));
    struct listing *l = mem_alloc(sizeof *l);
    *l = (struct listing){.x = x, .folder = mem_strdup(net->options.media), .list = json_array()};
    l->work.data = l;
    exchange_set_work(x, (struct exchange_work){.free = leave, .self = l});
    uv_queue_work(net->pipeline->loop, &l->work, work, after);
    return 0;
}
