/* SPDX-License-Identifier: GPL-3.0-or-later */
/* faccia-voice PLUGIN.so: runs one voice plugin for the daemon, which starts it with a socket on descriptor
 * WIRE_FD. */
#include "server/base/log.h"
#include "server/base/program.h"
#include "server/voice/memory_limit.h"
#include "server/voice/plugin_allowed.h"
#include "server/voice/plugin_loader.h"
#include "server/voice/sandbox.h"
#include "server/voice/worker_io.h"
#include "server/voice/worker_keeper.h"
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#define SEND_BUFFER (1 << 20)

/* So much more processor time from now on; then SIGXCPU. What it starts may have no more either. */
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

/* The worker ends when its socket does; an interrupt of the terminal is for the daemon to handle. What it
 * signals to its own group does not reach the daemon's. */
static void set_signals(void) {
    signal(SIGINT, SIG_IGN);
    signal(SIGTERM, SIG_IGN);
    setpgid(0, 0);
    prctl(PR_SET_PDEATHSIG, SIGKILL);
}

static int set_socket(void) {
    int size = SEND_BUFFER, flags = fcntl(WIRE_FD, F_GETFL);
    if (flags < 0 || fcntl(WIRE_FD, F_SETFL, flags & ~O_NONBLOCK) < 0)
        return -1;
    setsockopt(WIRE_FD, SOL_SOCKET, SO_SNDBUF, &size, sizeof size);
    fcntl(WIRE_FD, F_SETFD, FD_CLOEXEC);
    close_range(WIRE_FD + 1, ~0u, 0); /* whatever the daemon left open is not for plugins */
    return 0;
}

/* Speaks until the daemon has gone. Returns the exit status. */
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
            log_error("a voice worker was asked for something that it does not understand");
            return 1;
        }
    }
    return 0;
}

/* What the daemon says first. It is read by the only thread, as a process must be confined before it has a
 * second one. */
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

/* False when the daemon has gone before it has said all of it. */
static bool hear_opening(struct opening *opening) {
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

/* Rights first, then the plugin's code, from its initialisers on. */
static int load(struct loaded_plugin *host, const char *plugin, const struct allowed *allowed, bool confined,
                char *message, size_t cap) {
    struct needs needs;
    needs_read(&needs, plugin);
    if (needs.capabilities & WORKER_KEEPER_WANTED)
        worker_keeper_start(plugin);
    const struct sandbox sandbox = {plugin, &needs, allowed->paths, allowed->count, getppid()};
    host->gaps = (struct sandbox_gaps){0};
    if (confined)
        sandbox_enter(&sandbox, &host->gaps);
    else
        setenv("FACCIA_SANDBOX", "off", 1); /* for a second voice, too */
    int result = loaded_plugin_load(host, plugin, confined ? needs.capabilities : UINT32_MAX, message, cap);
    needs_free(&needs);
    return result;
}

static int run(const struct opening *opening, const char *plugin) {
    struct loaded_plugin host = {0};
    struct allowed allowed;
    char message[256];
    memory_limit(opening->limits.megabytes);
    limit_processor(opening->limits.seconds);
    int result = allowed_read(&allowed, opening->config, message, sizeof message);
    allowed_add_packs(&allowed);
    if (!result)
        result = load(&host, plugin, &allowed, opening->limits.sandbox, message, sizeof message);
    struct worker_io *m = worker_io_open(WIRE_FD);
    if (!result)
        result = loaded_plugin_open(&host, allowed.config, message, sizeof message);
    allowed_free(&allowed);
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
    if (hear_opening(&opening)) {
        if (!opening.config)
            log_error("a voice worker was not told its configuration");
        status = opening.config ? run(&opening, argv[1]) : 1;
    }
    buf_free(&opening.bytes);
    return status;
}
