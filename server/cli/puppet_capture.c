/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/cli/puppet_capture.h"
#include "server/base/mem.h"
#include "server/cli/cli.h"
#include "server/cli/face_capture.h"
#include "server/cli/puppet_text.h"
#include <math.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>

enum { DATAGRAM_MAX = 65536, HOST_MAX = 64, SIGNALS = 2, STRANGE_MOST = 1000, ASK_MS = 1000, ASKED = 2 };

#define SENDER_SILENCE 3. /* s without a face after which another sender may take over */
#define STEP_MOST 0.5     /* s between frames; by a longer step the sender's clock has begun anew */
#define STEP_LEAST 1e-4   /* s */

struct receiver {
    const struct puppet_capture *capture;
    uv_loop_t *loop;
    uv_udp_t socket;
    uv_timer_t timer, asking;
    struct sockaddr_storage asked[ASKED]; /* ports of the telephone, one for each app */
    uv_signal_t signals[SIGNALS];
    struct puppet_face face;
    struct sockaddr_storage sender;
    double heard;         /* s of this program's clock: when its last face came */
    double begun, time;   /* s: when the first face came; that of the last one, from the first */
    double sender_offset; /* s: from the sender's clock to the times of faces */
    size_t faces, strange;
    bool warned, ended; /* by its time, a signal or its size; otherwise by uv_stop of another */
    struct capture_row *rows;
    size_t count, cap;
    char datagram[DATAGRAM_MAX];
};

static void stop(struct receiver *r) {
    r->ended = true;
    uv_udp_recv_stop(&r->socket);
    uv_stop(r->loop);
}

static void on_time(uv_timer_t *timer) {
    stop(timer->data);
}

static void on_signal(uv_signal_t *signal, int number) {
    (void)number;
    stop(signal->data);
}

/* Returns the time of a face: by the sender's clock as long as it advances in small steps, as that has no
 * jitter; otherwise by when it came. */
static double time_of(struct receiver *r, const struct puppet_face *face) {
    double came = r->heard - r->begun, told = face->time + r->sender_offset;
    if (r->faces && face->time >= 0 && told - r->time >= STEP_LEAST && told - r->time <= STEP_MOST)
        return told;
    double time = r->faces ? fmax(came, r->time + STEP_LEAST) : 0;
    r->sender_offset = time - face->time;
    return time;
}

static void add_row(struct receiver *r, const struct puppet_face *face) {
    r->rows = mem_grow(r->rows, &r->cap, r->count + 1, sizeof *r->rows);
    struct capture_row *row = &r->rows[r->count++];
    *row = (struct capture_row){.time = r->time, .head = face->head};
    memcpy(row->weights, face->weights, sizeof row->weights);
    if (r->count == CAPTURE_ROWS_MAX)
        stop(r);
}

static void on_face(void *receiver, const struct puppet_face *face) {
    struct receiver *r = receiver;
    r->heard = (double)uv_hrtime() / 1e9;
    if (!r->faces) {
        r->begun = r->heard;
        if (r->capture->seconds > 0)
            uv_timer_start(&r->timer, on_time, (uint64_t)(r->capture->seconds * 1000), 0);
    }
    r->time = time_of(r, face);
    r->faces++;
    if (r->capture->record)
        add_row(r, face);
    if (r->capture->face)
        r->capture->face(r->capture->ctx, face, r->time);
}

static void on_room(uv_handle_t *handle, size_t wanted, uv_buf_t *out) {
    (void)wanted;
    struct receiver *r = handle->data;
    *out = uv_buf_init(r->datagram, sizeof r->datagram);
}

static bool same_sender(const struct sockaddr_storage *a, const struct sockaddr *b) {
    size_t size = b->sa_family == AF_INET6 ? sizeof(struct sockaddr_in6) : sizeof(struct sockaddr_in);
    return a->ss_family == b->sa_family && !memcmp(a, b, size);
}

static bool same_host(const struct sockaddr_storage *a, const struct sockaddr *b) {
    if (a->ss_family != b->sa_family)
        return false;
    return b->sa_family == AF_INET6
               ? !memcmp(&((const struct sockaddr_in6 *)a)->sin6_addr,
                         &((const struct sockaddr_in6 *)b)->sin6_addr, sizeof(struct in6_addr))
               : ((const struct sockaddr_in *)a)->sin_addr.s_addr ==
                     ((const struct sockaddr_in *)b)->sin_addr.s_addr;
}

/* Follows one sender, because the faces of two would alternate: the telephone, if there is one. */
static bool is_followed(struct receiver *r, const struct sockaddr *from) {
    if (r->capture->phone && !same_host(r->asked, from))
        return false;
    if (r->faces && same_sender(&r->sender, from))
        return true;
    if (r->faces && (double)uv_hrtime() / 1e9 - r->heard < SENDER_SILENCE)
        return false;
    memset(&r->sender, 0, sizeof r->sender);
    memcpy(&r->sender, from,
           from->sa_family == AF_INET6 ? sizeof(struct sockaddr_in6) : sizeof(struct sockaddr_in));
    return true;
}

static void on_datagram(uv_udp_t *socket, ssize_t size, const uv_buf_t *data, const struct sockaddr *from,
                        unsigned flags) {
    struct receiver *r = socket->data;
    if (size <= 0 || flags & UV_UDP_PARTIAL || !is_followed(r, from))
        return;
    size_t before = r->faces;
    puppet_packet(&r->face, (const uint8_t *)data->base, (size_t)size, on_face, r);
    r->strange = r->faces > before ? 0 : r->strange + 1;
    if (r->strange < STRANGE_MOST || r->warned || r->face.pending)
        return;
    r->warned = true;
    cli_complain(
        "warning: what comes has no ARKit shapes, neither from Live Link Face or iFacialMocap nor by the VMC "
        "protocol");
}

static int set_address(const char *host, long port, struct sockaddr_storage *out) {
    return uv_ip4_addr(host, (int)port, (struct sockaddr_in *)out) &&
                   uv_ip6_addr(host, (int)port, (struct sockaddr_in6 *)out)
               ? -1
               : 0;
}

/* Reads "HOST:PORT", with an IPv6 address in brackets, or "PORT" for this machine. */
static int read_address(const char *text, struct sockaddr_storage *out) {
    const char *colon = strrchr(text, ':'), *port = colon ? colon + 1 : text;
    char host[HOST_MAX] = "127.0.0.1", *end;
    long number = strtol(port, &end, 10);
    size_t length = colon ? (size_t)(colon - text) : 0;
    bool bracketed = length > 2 && text[0] == '[' && colon[-1] == ']';
    if (*end || end == port || number < 0 || number > 65535 || length >= sizeof host || (colon && !length))
        return -1;
    if (colon)
        snprintf(host, sizeof host, "%.*s", (int)(length - 2 * bracketed), text + bracketed);
    return set_address(host, number, out);
}

static int bind_to(struct receiver *r, const char *text) {
    struct sockaddr_storage address;
    return read_address(text, &address) ? -1 : uv_udp_bind(&r->socket, (struct sockaddr *)&address, 0);
}

/* Asks until a face comes, and again when none has come for a while. */
static void on_asking(uv_timer_t *timer) {
    struct receiver *r = timer->data;
    static const char *const words[ASKED] = {PUPPET_TEXT_ASK, PUPPET_TEXT_ASK_OTHER};
    if (r->faces && (double)uv_hrtime() / 1e9 - r->heard < SENDER_SILENCE)
        return;
    for (int i = 0; i < ASKED; i++) {
        uv_buf_t bytes = uv_buf_init((char *)words[i], (unsigned)strlen(words[i]));
        uv_udp_try_send(&r->socket, &bytes, 1, (struct sockaddr *)&r->asked[i]); /* the next may arrive */
    }
}

static int ask(struct receiver *r, const char *phone) {
    static const int ports[ASKED] = {PUPPET_TEXT_PORT, PUPPET_TEXT_PORT_OTHER};
    for (int i = 0; i < ASKED; i++)
        if (set_address(phone, ports[i], &r->asked[i]) &&
            (!strchr(phone, ':') || read_address(phone, &r->asked[i]))) {
            cli_complain("--phone: '%s' is no numeric address: expected HOST or HOST:PORT", phone);
            return -1;
        }
    uv_timer_start(&r->asking, on_asking, 0, ASK_MS);
    return 0;
}

static void say_address(const struct receiver *r) {
    struct sockaddr_storage address;
    int size = sizeof address;
    char host[HOST_MAX] = "";
    uv_udp_getsockname(&r->socket, (struct sockaddr *)&address, &size);
    uv_ip_name((struct sockaddr *)&address, host, sizeof host);
    unsigned port = ntohs(((struct sockaddr_in *)&address)->sin_port); /* where IPv6 has it, too */
    cli_complain("waiting for a face at %s port %u; Ctrl-C ends the recording", host, port);
}

static int finish(const struct receiver *r, struct fapfile *out) {
    if (!r->faces) {
        if (r->ended)
            cli_complain("no weight of an ARKit shape has come");
        return EXIT_FAILED;
    }
    if (r->capture->record && capture_frames(r->rows, r->count, r->capture->fps, out)) {
        cli_complain("there would be more than %d frames", CAPTURE_FRAMES_MAX);
        return EXIT_FAILED;
    }
    return EXIT_DONE;
}

int puppet_capture(uv_loop_t *loop, const struct puppet_capture *capture, struct fapfile *out) {
    static const int numbers[SIGNALS] = {SIGINT, SIGTERM};
    struct receiver *r = mem_alloc(sizeof *r);
    r->capture = capture;
    r->loop = loop;
    uv_udp_init(loop, &r->socket);
    uv_timer_init(loop, &r->timer);
    uv_timer_init(loop, &r->asking);
    r->socket.data = r->timer.data = r->asking.data = r;
    for (int i = 0; i < SIGNALS; i++) {
        uv_signal_init(loop, &r->signals[i]);
        r->signals[i].data = r;
        uv_signal_start(&r->signals[i], on_signal, numbers[i]);
    }
    int failure = bind_to(r, capture->address), status = EXIT_FAILED;
    if (failure)
        cli_complain("--udp: cannot receive at '%s': %s", capture->address,
                     failure == -1 ? "expected [HOST:]PORT with a numeric address" : uv_strerror(failure));
    else if (!capture->phone || !ask(r, capture->phone)) {
        say_address(r);
        uv_udp_recv_start(&r->socket, on_room, on_datagram);
        uv_run(loop, UV_RUN_DEFAULT);
        status = finish(r, out);
    }
    uv_close((uv_handle_t *)&r->socket, NULL);
    uv_close((uv_handle_t *)&r->timer, NULL);
    uv_close((uv_handle_t *)&r->asking, NULL);
    for (int i = 0; i < SIGNALS; i++)
        uv_close((uv_handle_t *)&r->signals[i], NULL);
    uv_run(loop, UV_RUN_NOWAIT); /* until they are closed */
    free(r->rows);
    free(r);
    return status;
}
