/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/voice/worker_io.h"
#include "server/base/log.h"
#include "server/base/mem.h"
#include <errno.h>
#include <poll.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/uio.h>
#include <time.h>
#include <unistd.h>

/* What is said goes out in blocks of about this size, so that a short sentence costs one system call. */
enum { BLOCK_BYTES = 128 << 10, READ_BYTES = 64 << 10 };

/* But something that has been made is not held back for longer than this, ms: it shows that the voice is at
 * work. */
enum { SILENCE_MS = 200 };

/* When the daemon has gone, the plugin has this long to end, seconds. */
enum { GRACE = 1 };

struct worker_io {
    int fd;
    pthread_mutex_t saying; /* held while a frame is written */
    /* shared with the listening thread */
    pthread_mutex_t lock;
    pthread_cond_t heard;
    struct buf inbox; /* whole frames: SPEAK */
    bool alone;       /* the daemon has gone */
    bool busy;        /* a sentence was heard, and not all is said of it */
    uint32_t job;     /* the sentence that is spoken, 0 = none */
    const struct faccia_voice *api;
    void *self;
    atomic_bool cancelled;
    /* of the speaking thread */
    struct buf current; /* the frame that is worked on */
    struct buf audio, events;
    size_t audio_place, events_place;
    uint32_t rate;  /* of the open audio frame */
    uint64_t since; /* ms: the last block went out */
};

/* The sentence is known by its job: a late cancel cannot hit the next one. */
static void cancel(struct worker_io *m, uint32_t job) {
    pthread_mutex_lock(&m->lock);
    if (m->job == job) {
        atomic_store(&m->cancelled, true);
        if (m->api->cancel)
            m->api->cancel(m->self);
    }
    pthread_mutex_unlock(&m->lock);
}

/* Lets the speaking thread come to its end, but does not wait for long. */
_Noreturn static void end(struct worker_io *m) {
    pthread_mutex_lock(&m->lock);
    m->alone = true;
    atomic_store(&m->cancelled, true);
    if (m->job && m->api->cancel)
        m->api->cancel(m->self);
    pthread_cond_signal(&m->heard);
    pthread_mutex_unlock(&m->lock);
    sleep(GRACE);
    _exit(1);
}

static void deliver(struct worker_io *m, const uint8_t *frame, size_t size) {
    pthread_mutex_lock(&m->lock);
    m->busy = true;
    buf_add(&m->inbox, frame, size);
    pthread_cond_signal(&m->heard);
    pthread_mutex_unlock(&m->lock);
}

static bool is_busy(struct worker_io *m) {
    pthread_mutex_lock(&m->lock);
    bool busy = m->busy;
    pthread_mutex_unlock(&m->lock);
    return busy;
}

/* Shows that the process runs, unless the other thread is about to. */
static void say_alive(struct worker_io *m) {
    struct buf b = {0};
    wire_end(&b, wire_begin(&b, WIRE_ALIVE, 0));
    if (pthread_mutex_trylock(&m->saying) == 0) {
        if (is_busy(m))
            send(m->fd, b.data, b.size, MSG_DONTWAIT | MSG_NOSIGNAL);
        pthread_mutex_unlock(&m->saying);
    }
    buf_free(&b);
}

/* Waits until there is something to read. */
static void wait_for_daemon(struct worker_io *m) {
    struct pollfd socket = {.fd = m->fd, .events = POLLIN};
    while (poll(&socket, 1, is_busy(m) ? WIRE_ALIVE_MS : -1) == 0)
        say_alive(m);
}

static void *listen_to_daemon(void *ctx) {
    struct worker_io *m = ctx;
    struct buf in = {0};
    for (;;) {
        wait_for_daemon(m);
        ssize_t n = read(m->fd, buf_reserve(&in, READ_BYTES), READ_BYTES);
        if (n < 0 && errno == EINTR)
            continue;
        if (n <= 0)
            end(m);
        in.size += (size_t)n;
        struct wire_frame frame;
        size_t used = 0, at = 0;
        int found;
        while ((found = wire_next(in.data + at, in.size - at, &frame, &used)) == 1) {
            if (frame.type == WIRE_CANCEL)
                cancel(m, frame.job);
            else
                deliver(m, in.data + at, used);
            at += used;
        }
        if (found < 0) {
            log_error("a voice worker was sent something that it does not understand");
            end(m);
        }
        buf_consume(&in, at);
    }
    return NULL;
}

struct worker_io *worker_io_open(int fd) {
    struct worker_io *m = mem_alloc(sizeof *m);
    pthread_t thread;
    m->fd = fd;
    pthread_mutex_init(&m->lock, NULL);
    pthread_mutex_init(&m->saying, NULL);
    pthread_cond_init(&m->heard, NULL);
    if (pthread_create(&thread, NULL, listen_to_daemon, m) != 0) {
        log_error("a voice worker cannot start a thread");
        exit(1);
    }
    pthread_detach(thread);
    return m;
}

bool worker_io_next(struct worker_io *m, struct wire_frame *frame) {
    size_t used = 0;
    m->current.size = 0;
    pthread_mutex_lock(&m->lock);
    while (!m->alone && wire_next(m->inbox.data, m->inbox.size, frame, &used) != 1)
        pthread_cond_wait(&m->heard, &m->lock);
    if (!m->alone) {
        buf_add(&m->current, m->inbox.data, used);
        buf_consume(&m->inbox, used);
    }
    pthread_mutex_unlock(&m->lock);
    return wire_next(m->current.data, m->current.size, frame, &used) == 1;
}

static uint64_t now_ms(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (uint64_t)t.tv_sec * 1000 + (uint64_t)t.tv_nsec / 1000000;
}

/* Sends everything in the two buffers. */
static void flush(struct worker_io *m) {
    if (m->audio.size)
        wire_end(&m->audio, m->audio_place);
    if (m->events.size && m->events_place != SIZE_MAX)
        wire_end(&m->events, m->events_place);
    struct iovec parts[2] = {{m->audio.data, m->audio.size}, {m->events.data, m->events.size}};
    pthread_mutex_lock(&m->saying);
    while (parts[0].iov_len + parts[1].iov_len) {
        ssize_t n = writev(m->fd, parts, 2);
        if (n < 0 && errno == EINTR)
            continue;
        if (n < 0)
            break; /* nobody listens: the other thread ends the process */
        for (int i = 0; i < 2; i++) {
            size_t gone = (size_t)n < parts[i].iov_len ? (size_t)n : parts[i].iov_len;
            if (gone)
                parts[i].iov_base = (char *)parts[i].iov_base + gone;
            parts[i].iov_len -= gone;
            n -= (ssize_t)gone;
        }
    }
    pthread_mutex_unlock(&m->saying);
    m->audio.size = m->events.size = 0;
    m->events_place = SIZE_MAX;
    m->since = now_ms();
}

/* What the sink's functions return. */
static int made(struct worker_io *m) {
    if (now_ms() - m->since >= SILENCE_MS)
        flush(m);
    return atomic_load_explicit(&m->cancelled, memory_order_relaxed);
}

void worker_io_say(struct worker_io *m, enum wire_type type, const char *string) {
    size_t place = wire_begin(&m->events, type, 0);
    wire_put_string(&m->events, string);
    wire_end(&m->events, place);
    m->events_place = SIZE_MAX;
    flush(m);
}

static int on_audio(void *ctx, const int16_t *samples, size_t count, uint32_t rate) {
    struct worker_io *m = ctx;
    while (count) {
        if (m->audio.size && (m->rate != rate || m->audio.size >= BLOCK_BYTES))
            flush(m);
        if (!m->audio.size) {
            m->audio_place = wire_begin(&m->audio, WIRE_AUDIO, m->job);
            wire_put_u32(&m->audio, m->rate = rate);
        }
        size_t part = count < BLOCK_BYTES ? count : BLOCK_BYTES;
        buf_add(&m->audio, samples, part * sizeof *samples);
        samples += part;
        count -= part;
    }
    return made(m);
}

static int add_event(struct worker_io *m, const struct wire_event *event) {
    if (m->events.size >= BLOCK_BYTES)
        flush(m);
    if (!m->events.size)
        m->events_place = wire_begin(&m->events, WIRE_EVENTS, m->job);
    wire_put_event(&m->events, event);
    return made(m);
}

static int on_phone(void *ctx, const struct faccia_phone *phone) {
    return add_event(ctx, &(struct wire_event){.kind = WIRE_PHONE, .phone = *phone});
}

static int on_word(void *ctx, const struct faccia_word *word) {
    return add_event(ctx, &(struct wire_event){.kind = WIRE_WORD, .word = *word});
}

static int on_mark(void *ctx, const char *name, uint64_t at) {
    return add_event(ctx, &(struct wire_event){.kind = WIRE_MARK, .text = name, .at = at});
}

static int on_warning(void *ctx, const char *message) {
    return add_event(ctx, &(struct wire_event){.kind = WIRE_WARNING, .text = message});
}

static void set_job(struct worker_io *m, const struct faccia_voice *api, void *self, uint32_t job) {
    pthread_mutex_lock(&m->lock);
    m->api = api;
    m->self = self;
    m->job = job;
    atomic_store(&m->cancelled, m->alone);
    pthread_mutex_unlock(&m->lock);
}

void worker_io_speak(struct worker_io *m, const struct faccia_voice *api, void *self, uint32_t job,
                     const struct faccia_sentence *sentence) {
    char message[256] = "";
    const struct faccia_sink sink = {sizeof sink, m, on_audio, on_phone, on_word, on_mark, on_warning};
    m->audio.size = m->events.size = 0;
    m->events_place = SIZE_MAX;
    m->since = now_ms();
    set_job(m, api, self, job);
    int result = api->speak(self, sentence, &sink, message, sizeof message);
    set_job(m, api, self, 0);
    message[sizeof message - 1] = '\0';
    if (m->events.size && m->events_place != SIZE_MAX)
        wire_end(&m->events, m->events_place);
    m->events_place = wire_begin(&m->events, WIRE_DONE, job);
    wire_put_u32(&m->events, result ? 1 : 0);
    wire_put_string(&m->events, message);
    pthread_mutex_lock(&m->lock);
    m->busy = false;
    pthread_mutex_unlock(&m->lock);
    flush(m);
}
