/* SPDX-License-Identifier: GPL-3.0-or-later */
/* faccia-voice PLUGIN.so: runs one voice plugin for the daemon, which starts it with a socket on
 * descriptor WIRE_FD. A thread listens to the socket, so that a sentence can be cancelled while the plugin
 * speaks, the daemon gets signs of life, and the process ends with the daemon. */
#include "server/base/log.h"
#include "server/base/mem.h"
#include "server/base/program.h"
#include "server/voice/faccia-voice.h"
#include "server/voice/plugin_loader.h"
#include "server/voice/sandbox.h"
#include "server/voice/wire.h"
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <poll.h>
#include <pthread.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <sys/uio.h>
#include <time.h>
#include <unistd.h>

struct worker_io;

/* Output is sent in blocks of about this size, so that a short sentence takes one system call. */
enum { BLOCK_BYTES = 128 << 10, READ_BYTES = 64 << 10 };

/* Longest time, in ms, that finished output is held back, so that the daemon sees progress. */
enum { SILENCE_MS = 200 };

/* Seconds that the plugin has to end when the daemon is gone. */
enum { GRACE = 1 };

struct worker_io {
    int fd;
    pthread_mutex_t saying; /* held while writing a frame */
    /* shared with the listening thread */
    pthread_mutex_t lock;
    pthread_cond_t heard;
    struct buf inbox; /* complete SPEAK frames */
    bool alone;       /* the daemon has closed the socket */
    bool busy;        /* a sentence was received and is not finished */
    uint32_t job;     /* being spoken, 0 = none */
    const struct faccia_voice *api;
    void *self;
    atomic_bool cancelled;
    /* used by the speaking thread only */
    struct buf current; /* the frame in progress */
    struct buf audio, events;
    size_t audio_place, events_place;
    uint32_t rate;  /* of the open audio frame */
    uint64_t since; /* ms: time of the last write */
};

/* Cancels the sentence only if it is the current one: a late cancel must not hit the next. */
static void cancel(struct worker_io *m, uint32_t job) {
    pthread_mutex_lock(&m->lock);
    if (m->job == job) {
        atomic_store(&m->cancelled, true);
        if (m->api->cancel)
            m->api->cancel(m->self);
    }
    pthread_mutex_unlock(&m->lock);
}

/* Gives the speaking thread a moment to end. */
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

/* Sends ALIVE, unless the other thread is writing. */
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

/* Waits for input, sending ALIVE meanwhile. */
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
            log_error("a voice worker received an invalid frame");
            end(m);
        }
        buf_consume(&in, at);
    }
    return NULL;
}

/* Starts the listening thread. The socket stays open until the process ends. */
static struct worker_io *worker_io_open(int fd) {
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

/* Waits for the next SPEAK; the payload is valid until the next call. Returns false when the daemon is
 * gone: the process must end, and is killed after GRACE. */
static bool worker_io_next(struct worker_io *m, struct wire_frame *frame) {
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

/* Sends both buffers. */
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
            break; /* the other end is closed: the listening thread ends the process */
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

/* Result of the sink's functions. */
static int made(struct worker_io *m) {
    if (now_ms() - m->since >= SILENCE_MS)
        flush(m);
    return atomic_load_explicit(&m->cancelled, memory_order_relaxed);
}

/* Sends a frame with one string. */
static void worker_io_say(struct worker_io *m, enum wire_type type, const char *string) {
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

/* Speaks a sentence with the plugin and sends all output, including DONE. */
static void worker_io_speak(struct worker_io *m, const struct faccia_voice *api, void *self, uint32_t job,
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

/* Receives a descriptor; -1 at the end, or if the message has none. */
static int receive(int socket) {
    union {
        struct cmsghdr header;
        char room[CMSG_SPACE(sizeof(int))];
    } control;
    char byte;
    int fd;
    struct iovec data = {&byte, 1};
    struct msghdr message = {
        .msg_iov = &data, .msg_iovlen = 1, .msg_control = &control, .msg_controllen = sizeof control.room};
    if (recvmsg(socket, &message, MSG_CMSG_CLOEXEC) <= 0)
        return -1;
    const struct cmsghdr *part = CMSG_FIRSTHDR(&message);
    if (!part || part->cmsg_type != SCM_RIGHTS || part->cmsg_len != CMSG_LEN(sizeof fd))
        return -1;
    memcpy(&fd, CMSG_DATA(part), sizeof fd);
    return fd;
}

/* Becomes a worker on that socket; dup2 clears close-on-exec. */
_Noreturn static void become_worker(int fd, const char *plugin) {
    signal(SIGCHLD, SIG_DFL);
    if (fd == WIRE_FD)
        fcntl(fd, F_SETFD, 0);
    else
        dup2(fd, WIRE_FD);
    execl("/proc/self/exe", "faccia-voice", plugin, (char *)NULL);
    _exit(127); /* the plugin sees its socket close */
}

_Noreturn static void keep(int socket, const char *plugin, pid_t parent) {
    program_end_with(parent);
    private_memory();
    signal(SIGCHLD, SIG_IGN); /* children are reaped automatically */
    close(WIRE_FD);           /* the daemon's socket */
    for (int fd; (fd = receive(socket)) >= 0; close(fd))
        if (fork() == 0)
            become_worker(fd, plugin);
    _exit(0);
}

/* Forks a spawner, whose socket is WIRE_SPAWNER_FD: it starts a worker of espeak.so, in the plugin's
 * folder, for every socket sent to it. Call while the process has one thread. On failure the plugin finds
 * the descriptor closed. The spawner and its workers end with this process. */
static void spawner_start(const char *plugin) {
    char espeak[PATH_MAX];
    const char *slash = strrchr(plugin, '/');
    int ends[2];
    snprintf(espeak, sizeof espeak, "%.*sespeak.so", slash ? (int)(slash - plugin) + 1 : 0, plugin);
    if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends))
        return;
    const pid_t parent = getpid(), child = fork();
    if (child == 0) {
        close(ends[0]);
        keep(ends[1], espeak, parent);
    }
    close(ends[1]);
    if (ends[0] != WIRE_SPAWNER_FD) {
        dup3(ends[0], WIRE_SPAWNER_FD, O_CLOEXEC);
        close(ends[0]);
    }
    if (child < 0)
        close(WIRE_SPAWNER_FD);
}

#define SEND_BUFFER (1 << 20)

/* Allows this much more processor time, then SIGXCPU. Children cannot raise it. */
static void limit_processor(uint32_t seconds) {
    struct rusage used;
    struct rlimit time;
    getrusage(RUSAGE_SELF, &used);
    getrlimit(RLIMIT_CPU, &time);
    timeradd(&used.ru_utime, &used.ru_stime, &used.ru_utime);
    time.rlim_cur = (rlim_t)used.ru_utime.tv_sec + 1 + seconds;
    if (time.rlim_cur > time.rlim_max)
        time.rlim_cur = time.rlim_max;
    setrlimit(RLIMIT_CPU, &time);
}

/* The worker ends when its socket closes; the terminal's interrupt is for the daemon. Signals that it
 * sends to its own group do not reach the daemon's. */
static void set_signals(void) {
    signal(SIGINT, SIG_IGN);
    signal(SIGTERM, SIG_IGN);
    setpgid(0, 0);
    program_end_with_parent(WIRE_FD, SIGKILL);
}

static int set_socket(void) {
    int size = SEND_BUFFER, flags = fcntl(WIRE_FD, F_GETFL);
    if (flags < 0 || fcntl(WIRE_FD, F_SETFL, flags & ~O_NONBLOCK) < 0)
        return -1;
    setsockopt(WIRE_FD, SOL_SOCKET, SO_SNDBUF, &size, sizeof size);
    fcntl(WIRE_FD, F_SETFD, FD_CLOEXEC);
    close_range(WIRE_FD + 1, ~0u, 0); /* plugins must not use the daemon's open descriptors */
    return 0;
}

/* Speaks sentences until the daemon is gone. Returns the exit status. */
static int serve(struct worker_io *m, struct loaded_plugin *host) {
    struct wire_frame frame;
    while (worker_io_next(m, &frame)) {
        struct faccia_sentence sentence;
        struct faccia_span *spans = NULL;
        struct wire_reader r = wire_read(&frame);
        uint32_t seconds = wire_get_u32(&r);
        bool understood = frame.type == WIRE_SPEAK && wire_get_sentence(&r, &sentence, &spans);
        if (understood) {
            limit_processor(seconds);
            worker_io_speak(m, host->api, host->self, frame.job, &sentence);
        }
        free(spans);
        if (!understood) {
            log_error("a voice worker received an unknown request");
            return 1;
        }
    }
    return 0;
}

/* The OPEN frame. It is read before the listening thread starts, because a process must be confined while
 * it has one thread. */
struct opening {
    struct buf bytes;
    const char *config;
    struct wire_limits limits;
};

static bool read_all(struct buf *b, size_t size) {
    for (ssize_t n; b->size < size; b->size += (size_t)n) {
        n = read(WIRE_FD, buf_reserve(b, size - b->size), size - b->size);
        if (n < 0 && errno == EINTR)
            n = 0;
        else if (n <= 0)
            return false;
    }
    return true;
}

/* Returns false when the daemon is gone before the frame is complete. */
static bool read_opening(struct opening *opening) {
    struct wire_frame frame;
    size_t used;
    uint32_t size;
    if (!read_all(&opening->bytes, WIRE_HEADER_BYTES))
        return false;
    memcpy(&size, opening->bytes.data, sizeof size);
    if (size <= WIRE_PAYLOAD_MAX && !read_all(&opening->bytes, WIRE_HEADER_BYTES + size))
        return false;
    if (wire_next(opening->bytes.data, opening->bytes.size, &frame, &used) != 1 || frame.type != WIRE_OPEN)
        return true;
    struct wire_reader r = wire_read(&frame);
    const char *config = wire_get_string(&r);
    opening->limits = wire_get_limits(&r);
    opening->config = r.bad ? NULL : config;
    return true;
}

/* Enters the sandbox, then runs the plugin's code, starting with its initialisers. */
static int load(struct loaded_plugin *host, const char *plugin, const struct allowed_paths *allowed,
                bool confined, char *message, size_t cap) {
    struct plugin_needs needs;
    plugin_needs_read(&needs, plugin);
    if (needs.capabilities & WORKER_SPAWNER_WANTED)
        spawner_start(plugin);
    const struct sandbox sandbox = {plugin, &needs, allowed->paths, allowed->count, getppid()};
    host->gaps = (struct sandbox_gaps){0};
    if (confined)
        sandbox_enter(&sandbox, &host->gaps);
    else
        setenv("FACCIA_SANDBOX", "off", 1); /* also for a second voice */
    int result = loaded_plugin_load(host, plugin, confined ? needs.capabilities : UINT32_MAX, message, cap);
    plugin_needs_free(&needs);
    return result;
}

static int run(const struct opening *opening, const char *plugin) {
    struct loaded_plugin host = {0};
    struct allowed_paths allowed;
    char message[256];
    memory_limit(opening->limits.megabytes);
    limit_processor(opening->limits.seconds);
    int result = allowed_paths_read(&allowed, opening->config, message, sizeof message);
    allowed_paths_add_packs(&allowed);
    if (!result)
        result = load(&host, plugin, &allowed, opening->limits.sandbox, message, sizeof message);
    struct worker_io *m = worker_io_open(WIRE_FD);
    if (!result)
        result = loaded_plugin_open(&host, allowed.config, message, sizeof message);
    allowed_paths_free(&allowed);
    if (result) {
        worker_io_say(m, result > 0 ? WIRE_ABSENT : WIRE_FAILED, message);
        return 1;
    }
    char *description = loaded_plugin_describe(&host);
    worker_io_say(m, WIRE_HELLO, description);
    free(description);
    int status = serve(m, &host);
    loaded_plugin_close(&host);
    return status;
}

int main(int argc, char **argv) {
    program_begin();
    bool help = argc == 2 && !strcmp(argv[1], "--help");
    bool well = (argc == 2 || (argc == 3 && log_open_named(argv[2]))) && !help;
    if (!well || set_socket() < 0) {
        fprintf(stderr, "usage: faccia-voice PLUGIN.so [text|json|journal]\nRuns a voice plugin for facciad, "
                        "which starts this program "
                        "by itself.\n");
        return help ? 0 : 2;
    }
    set_signals();
    struct opening opening = {0};
    int status = 0;
    if (read_opening(&opening)) {
        if (!opening.config)
            log_error("a voice worker received no configuration");
        status = opening.config ? run(&opening, argv[1]) : 1;
    }
    buf_free(&opening.bytes);
    return status;
}
