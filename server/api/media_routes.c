/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Recordings: lists their folder (/v1/media) and plays one in a room (POST /v1/play?room=). The recording
 * comes from the folder (&name=) or is uploaded as a form (RFC 7578) with the files "fap" and "sound".
 * Uploads stay in memory until they have been played. */
#include "server/api/api_internal.h"
#include "server/base/mem.h"
#include "server/http/multipart.h"
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

int media_source(const struct api *api, struct recording_source *source, const char *name, struct error *e) {
    source->fap_bytes_max = api->options.play_bytes;
    if (!api->options.media)
        return error_in_field(e, ERROR_UNKNOWN_MEDIA, "name", "this server has no folder of recordings");
    return recording_source_in(source, api->options.media, name, e);
}

/* The folder may be large and remote, so another thread reads it. Owned by the exchange, and by that
 * thread until it is done. */
struct listing {
    uv_work_t work;
    struct exchange *x; /* NULL: the client is gone */
    char *folder;
    json_t *list;
    bool whole; /* false: the folder takes too long */
    bool done;
    atomic_bool left; /* tells the thread that the client is gone */
};

/* Most processor time for listing a folder, s. */
enum { LIST_SECONDS = 10 };

static void add_listed(void *ctx, const char *name, bool sound) {
    struct listing *l = ctx;
    json_array_append_new(l->list, json_pack("{ss sb}", "name", name, "sound", sound));
}

static void list_folder(uv_work_t *work) {
    struct listing *l = work->data;
    struct work_limit limit = work_limit_begin(&l->left, LIST_SECONDS);
    l->whole = recording_list(l->folder, &limit, add_listed, l);
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

static void after_list(uv_work_t *work, int status) {
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

static void leave_list(void *self) {
    struct listing *l = self;
    l->x = NULL;
    atomic_store(&l->left, true);
    if (l->done)
        free_listing(l);
    else
        uv_cancel((uv_req_t *)&l->work);
}

int media_get(struct exchange *x) {
    struct api *api = exchange_api(x);
    if (!api->options.media)
        return exchange_json(x, 200, json_pack("{s[]}", "media"));
    struct listing *l = mem_alloc(sizeof *l);
    *l = (struct listing){.x = x, .folder = mem_strdup(api->options.media), .list = json_array()};
    l->work.data = l;
    exchange_set_work(x, (struct exchange_work){.free = leave_list, .self = l});
    uv_queue_work(api->pipeline->loop, &l->work, list_folder, after_list);
    return 0;
}

struct upload {
    struct exchange *x;
    struct recording_source source;
    struct speech_request request; /* its id, mode and priority */
};

/* Starts playing and answers. */
static int begin_playing(struct exchange *x, struct recording_source *source,
                         const struct speech_request *request) {
    int result = 0;
    struct channel *channel = room_asked(x, &result);
    if (!channel) {
        recording_source_free(source);
        return result;
    }
    source->id = request->id ? mem_strdup(request->id) : NULL;
    stream_play(channel_stream(channel), request, recording_open_source, source);
    recording_source_free(source);
    return exchange_json(x, 202, json_pack("{ss ss}", "type", "accepted", "room", channel_name(channel)));
}

/* Copies the part of that name. Returns as form_part. */
static int take_part(struct upload *u, const char *name, struct buf *out, struct error *e) {
    const uint8_t *part;
    size_t size;
    const char *type = http_header(exchange_request(u->x), "content-type");
    const struct buf *form = exchange_body(u->x);
    int found = form_part(type, form->data, form->size, name, &part, &size, e);
    if (found > 0)
        buf_add(out, part, size);
    return found;
}

static int on_body_end(void *self) {
    struct upload *u = self;
    struct error e;
    if (take_part(u, "fap", &u->source.fap, &e) < 0 || take_part(u, "sound", &u->source.sound, &e) < 0)
        return exchange_error(u->x, &e);
    exchange_drop_body(u->x);
    if (!u->source.fap.size)
        return error_set(&e, ERROR_BAD_FORM, "the form has no file 'fap'"), exchange_error(u->x, &e);
    u->source.name = mem_strdup("upload");
    u->source.fap_bytes_max = exchange_api(u->x)->options.play_bytes;
    return begin_playing(u->x, &u->source, &u->request);
}

static void on_free(void *self) {
    struct upload *u = self;
    recording_source_free(&u->source);
    request_free(&u->request);
    free(u);
}

static int open_upload(struct exchange *x, struct speech_request *request) {
    struct upload *u = mem_alloc(sizeof *u);
    u->x = x;
    u->request = *request;
    exchange_set_work(x, (struct exchange_work){.body_end = on_body_end, .free = on_free, .self = u});
    exchange_expect_body(x, exchange_api(x)->options.play_bytes, ERROR_MEDIA_TOO_LARGE);
    return 0;
}

/* Plays a recording from the folder of the daemon that leads the room. */
static int play_elsewhere(struct exchange *x, const char *name, const struct speech_request *request) {
    struct error e;
    if (name)
        return room_forward(x, json_pack("{ss s{ss*} so}", "type", "play", "message", "name", name, "request",
                                         request_to_json(request)));
    error_set(&e, ERROR_ROOM_AWAY, "another daemon leads this room: upload the recording to that daemon");
    return exchange_error(x, &e);
}

int play_post(struct exchange *x) {
    char value[512];
    struct speech_request request;
    struct recording_source source = {0};
    struct error e;
    int result = 0;
    bool remote = room_is_remote(x);
    if (!remote && !room_asked(x, &result))
        return result;
    request_init(&request);
    const char *name = exchange_query(x, "name", value, sizeof value);
    const char *type = http_header(exchange_request(x), "content-type");
    bool form = type && !strncasecmp(type, "multipart/form-data", 19);
    if (request_from_query(&request, exchange_request(x), "name", &e) ||
        (name && !remote && media_source(exchange_api(x), &source, name, &e))) {
        result = exchange_error(x, &e);
    } else if (remote) {
        result = play_elsewhere(x, name, &request);
    } else if (name) {
        result = begin_playing(x, &source, &request);
    } else if (form) {
        return open_upload(x, &request);
    } else {
        error_set(&e, ERROR_UNSUPPORTED_MEDIA_TYPE,
                  "upload a recording as multipart/form-data, or name one with name=");
        result = exchange_error(x, &e);
    }
    recording_source_free(&source);
    request_free(&request);
    return result;
}
