/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/app/osc_play.h"
#include "server/app/cli.h"
#include "server/base/mem.h"
#include "server/codec/arkit_weights.h"
#include "server/codec/osc.h"
#include <math.h>
#include <netdb.h>
#include <stdlib.h>
#include <string.h>

struct osc_play {
    uv_udp_t socket;
    uv_timer_t timer;
    struct sockaddr_storage target;
    struct export export; /* its out: the weights of the frames that wait */
    struct osc_packets packets;
    double fps;
    uint64_t start; /* us on the loop's clock, at which frame 0 stands; 0 = nothing has come yet */
    uint64_t shown; /* frames */
    int open;       /* handles */
    bool ended;
};

enum { FRAME_BYTES = ARKIT_SHAPES * sizeof(double) };

static void piece(struct export *x, const struct media_segment *segment, uint32_t to) {
    uint32_t end = export_frames_until(x, segment, to);
    for (; x->frames < end; x->frames++) {
        struct fap_frame frame;
        export_frame(x, segment, x->frames, &frame);
        arkit_weights(x->coder, &frame, buf_reserve(&x->out, FRAME_BYTES));
        x->out.size += FRAME_BYTES;
    }
}

static const struct export_format weights_format = {
    .name = "weights", .piece = piece, .free = export_arkit_free};

static int find(const char *target, struct sockaddr_storage *out) {
    const char *colon = strrchr(target, ':');
    bool bracketed = target[0] == '[' && colon && colon > target && colon[-1] == ']';
    if (!colon || colon == target || !colon[1])
        return -1;
    char *host = mem_strndup(target + bracketed, (size_t)(colon - target) - (bracketed ? 2 : 0));
    struct addrinfo hints = {.ai_socktype = SOCK_DGRAM, .ai_flags = AI_NUMERICSERV}, *found = NULL;
    int result = getaddrinfo(host, colon + 1, &hints, &found);
    free(host);
    if (result)
        return -1;
    memcpy(out, found->ai_addr, found->ai_addrlen);
    freeaddrinfo(found);
    return 0;
}

struct osc_play *osc_play_open(uv_loop_t *loop, const char *target, const struct export_source *source) {
    struct sockaddr_storage address;
    if (find(target, &address)) {
        cli_complain("--osc: no address like '%s': HOST:PORT is wanted", target);
        return NULL;
    }
    struct osc_play *p = mem_alloc(sizeof *p);
    p->target = address;
    p->fps = source->fps;
    export_begin(&p->export, &weights_format, source);
    p->export.coder = arkit_solver_new();
    uv_udp_init(loop, &p->socket);
    uv_timer_init(loop, &p->timer);
    p->socket.data = p->timer.data = p;
    p->open = 2;
    return p;
}

/* Nobody may listen there: that is no error. */
static void send_frame(struct osc_play *p, const double *weights) {
    osc_frame(weights, &p->packets);
    for (size_t i = 0, from = 0; i < p->packets.count; from = p->packets.ends[i++]) {
        uv_buf_t bytes =
            uv_buf_init((char *)p->packets.bytes.data + from, (unsigned)(p->packets.ends[i] - from));
        uv_udp_try_send(&p->socket, &bytes, 1, (const struct sockaddr *)&p->target);
    }
}

static uint64_t waiting(const struct osc_play *p) {
    return p->export.out.size / FRAME_BYTES;
}

static void on_time(uv_timer_t *timer);

static void wait_for_next(struct osc_play *p) {
    uint64_t due = p->start + (uint64_t)((double)p->shown / p->fps * 1e6), now = uv_hrtime() / 1000;
    uv_timer_start(&p->timer, on_time, due > now ? (due - now + 999) / 1000 : 0, 0);
}

/* What is late is left out, but for the last. */
static void on_time(uv_timer_t *timer) {
    struct osc_play *p = timer->data;
    uint64_t now = uv_hrtime() / 1000;
    double late = (double)(now - p->start) / 1e6 * p->fps - (double)p->shown;
    uint64_t skip = late > 1 ? (uint64_t)late : 0, most = waiting(p) - 1;
    skip = skip < most ? skip : most;
    double weights[ARKIT_SHAPES];
    memcpy(weights, p->export.out.data + skip * FRAME_BYTES, sizeof weights);
    buf_consume(&p->export.out, (skip + 1) * FRAME_BYTES);
    p->shown += skip + 1;
    send_frame(p, weights);
    if (waiting(p))
        wait_for_next(p);
}

void osc_play_add(struct osc_play *p, const struct media_segment *segment) {
    bool idle = !waiting(p);
    export_segment(&p->export, segment);
    if (!idle || !waiting(p))
        return;
    /* One that comes too late is shown now, and all that follow it as much later. */
    uint64_t now = uv_hrtime() / 1000, since = (uint64_t)((double)p->shown / p->fps * 1e6);
    if (!p->start || p->start + since < now)
        p->start = now - since;
    wait_for_next(p);
}

void osc_play_end(struct osc_play *p) {
    p->ended = true;
}

bool osc_play_busy(const struct osc_play *p) {
    return !p->ended || waiting(p);
}

static void on_close(uv_handle_t *handle) {
    struct osc_play *p = handle->data;
    if (--p->open)
        return;
    export_free(&p->export);
    osc_packets_free(&p->packets);
    free(p);
}

void osc_play_free(struct osc_play *p) {
    if (!p)
        return;
    uv_close((uv_handle_t *)&p->socket, on_close);
    uv_close((uv_handle_t *)&p->timer, on_close);
}
