/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/cli/puppet_capture.h"
#include "server/base/mem.h"
#include "server/cli/cli.h"
#include "server/cli/face_capture.h"
#include <math.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <uv.h>

enum { DATAGRAM_MAX = 65536, DEPTH_MAX = 4, BUNDLE_HEADER = 16, HOST_MAX = 64, SIGNALS = 2 };

struct puppet {
    uv_loop_t loop;
    uv_udp_t socket;
    uv_timer_t timer;
    uv_signal_t signals[SIGNALS];
    double seconds;
    uint64_t begun; /* loop time of the first row in ns; 0 = none */
    double weights[ARKIT_SHAPES];
    bool known; /* a weight has come since the row before */
    struct capture_row *rows;
    size_t count, cap;
    char datagram[DATAGRAM_MAX];
};

static uint32_t get32(const uint8_t *at) {
    return (uint32_t)at[0] << 24 | (uint32_t)at[1] << 16 | (uint32_t)at[2] << 8 | at[3];
}

/* Returns the text at *at, and moves *at behind its padding to four bytes; NULL: it does not end. */
static const char *text_at(const uint8_t *data, size_t size, size_t *at) {
    const char *text = (const char *)data + *at;
    const void *end = *at < size ? memchr(text, '\0', size - *at) : NULL;
    if (!end)
        return NULL;
    size_t length = (size_t)((const char *)end - text);
    *at += (length / 4 + 1) * 4;
    return *at <= size ? text : NULL;
}

static void stop(struct puppet *p) {
    uv_udp_recv_stop(&p->socket);
    uv_stop(&p->loop);
}

static void on_time(uv_timer_t *timer) {
    stop(timer->data);
}

static void on_signal(uv_signal_t *signal, int number) {
    (void)number;
    stop(signal->data);
}

static void add_row(void *puppet) {
    struct puppet *p = puppet;
    uint64_t now = uv_hrtime();
    if (!p->known)
        return;
    if (!p->count) {
        p->begun = now;
        if (p->seconds > 0)
            uv_timer_start(&p->timer, on_time, (uint64_t)(p->seconds * 1000), 0);
    }
    p->rows = mem_grow(p->rows, &p->cap, p->count + 1, sizeof *p->rows);
    struct capture_row *row = &p->rows[p->count++];
    *row = (struct capture_row){.time = (double)(now - p->begun) / 1e9};
    memcpy(row->weights, p->weights, sizeof row->weights);
    p->known = false;
    if (p->count == CAPTURE_ROWS_MAX)
        stop(p);
}

static void take_weight(void *puppet, int shape, double weight) {
    struct puppet *p = puppet;
    p->weights[shape] = weight;
    p->known = true;
}

static void take_message(const uint8_t *data, size_t size, const struct puppet_sink *sink) {
    size_t at = 0;
    const char *address = text_at(data, size, &at), *types = address ? text_at(data, size, &at) : NULL;
    if (types && !strcmp(address, "/VMC/Ext/Blend/Apply"))
        sink->apply(sink->ctx);
    if (!types || strcmp(address, "/VMC/Ext/Blend/Val") || strcmp(types, ",sf"))
        return;
    const char *name = text_at(data, size, &at);
    if (!name || size - at < 4)
        return;
    uint32_t bits = get32(data + at);
    float weight;
    memcpy(&weight, &bits, sizeof weight);
    for (int i = 0; i < ARKIT_SHAPES; i++)
        if (!strcasecmp(name, arkit_table[i].name) && isfinite(weight))
            sink->weight(sink->ctx, i, (double)weight);
}

static void take_packet(const uint8_t *data, size_t size, int depth, const struct puppet_sink *sink) {
    if (size < BUNDLE_HEADER || memcmp(data, "#bundle", 8)) {
        take_message(data, size, sink);
        return;
    }
    for (size_t at = BUNDLE_HEADER, length; size - at >= 4 && depth < DEPTH_MAX; at += length) {
        length = get32(data + at);
        at += 4;
        if (length > size - at)
            return;
        take_packet(data + at, length, depth + 1, sink);
    }
}

void puppet_packet(const uint8_t *data, size_t size, const struct puppet_sink *sink) {
    take_packet(data, size, 0, sink);
}

static void on_room(uv_handle_t *handle, size_t wanted, uv_buf_t *out) {
    (void)wanted;
    struct puppet *p = handle->data;
    *out = uv_buf_init(p->datagram, sizeof p->datagram);
}

static void on_datagram(uv_udp_t *socket, ssize_t size, const uv_buf_t *data, const struct sockaddr *from,
                        unsigned flags) {
    (void)from;
    const struct puppet_sink sink = {socket->data, take_weight, add_row};
    if (size > 0 && !(flags & UV_UDP_PARTIAL))
        puppet_packet((const uint8_t *)data->base, (size_t)size, &sink);
}

static int bind_to(struct puppet *p, const char *text) {
    const char *colon = strrchr(text, ':'), *port = colon ? colon + 1 : text;
    char host[HOST_MAX] = "127.0.0.1", *end;
    long number = strtol(port, &end, 10);
    size_t length = colon ? (size_t)(colon - text) : 0;
    bool bracketed = length > 2 && text[0] == '[' && colon[-1] == ']';
    struct sockaddr_storage address;
    if (*end || end == port || number < 0 || number > 65535 || length >= sizeof host || (colon && !length))
        return -1;
    if (colon)
        snprintf(host, sizeof host, "%.*s", (int)(length - 2 * bracketed), text + bracketed);
    if (uv_ip4_addr(host, (int)number, (struct sockaddr_in *)&address) &&
        uv_ip6_addr(host, (int)number, (struct sockaddr_in6 *)&address))
        return -1;
    return uv_udp_bind(&p->socket, (struct sockaddr *)&address, 0);
}

static void say_address(const struct puppet *p) {
    struct sockaddr_storage address;
    int size = sizeof address;
    char host[HOST_MAX] = "";
    uv_udp_getsockname(&p->socket, (struct sockaddr *)&address, &size);
    uv_ip_name((struct sockaddr *)&address, host, sizeof host);
    unsigned port = ntohs(((struct sockaddr_in *)&address)->sin_port); /* where IPv6 has it, too */
    cli_complain("waiting for a face at %s port %u; Ctrl-C ends the recording", host, port);
}

static void on_close(uv_handle_t *handle, void *ctx) {
    (void)ctx;
    uv_close(handle, NULL);
}

int puppet_capture(const char *address, double seconds, double fps, struct fapfile *out) {
    static const int numbers[SIGNALS] = {SIGINT, SIGTERM};
    struct puppet *p = mem_alloc(sizeof *p);
    p->seconds = seconds;
    uv_loop_init(&p->loop);
    uv_udp_init(&p->loop, &p->socket);
    uv_timer_init(&p->loop, &p->timer);
    p->socket.data = p->timer.data = p;
    for (int i = 0; i < SIGNALS; i++) {
        uv_signal_init(&p->loop, &p->signals[i]);
        p->signals[i].data = p;
        uv_signal_start(&p->signals[i], on_signal, numbers[i]);
    }
    int failure = bind_to(p, address), status = EXIT_FAILED;
    if (!failure) {
        say_address(p);
        uv_udp_recv_start(&p->socket, on_room, on_datagram);
        uv_run(&p->loop, UV_RUN_DEFAULT);
    }
    if (failure)
        cli_complain("--osc: cannot receive at '%s': %s", address,
                     failure == -1 ? "expected [HOST:]PORT with a numeric address" : uv_strerror(failure));
    else if (!p->count)
        cli_complain("no weight of an ARKit shape has come");
    else if (capture_frames(p->rows, p->count, fps, out))
        cli_complain("there would be more than %d frames", CAPTURE_FRAMES_MAX);
    else
        status = EXIT_DONE;
    uv_walk(&p->loop, on_close, NULL);
    uv_run(&p->loop, UV_RUN_DEFAULT);
    uv_loop_close(&p->loop);
    free(p->rows);
    free(p);
    return status;
}
