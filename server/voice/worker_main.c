/* SPDX-License-Identifier: GPL-3.0-or-later */
/* faccia-voice PLUGIN.so: runs one voice plugin for the daemon, which starts it with a socket on descriptor
 * WIRE_FD. */
#include "server/base/log.h"
#include "server/voice/host.h"
#include "server/voice/mouthpiece.h"
#include "server/voice/sandbox.h"
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

/* A plugin that asks for more memory is out of it, alone. */
static void limit_memory(uint32_t megabytes) {
    const struct rlimit none = {0, 0};
    setrlimit(RLIMIT_CORE, &none);
#if !defined __SANITIZE_ADDRESS__ && !defined __SANITIZE_THREAD__ /* they map terabytes */
    const rlim_t bytes = (rlim_t)megabytes << 20;
    const struct rlimit space = {bytes, bytes};
    setrlimit(RLIMIT_AS, &space);
#else
    (void)megabytes;
#endif
}

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

/* The worker ends when its socket does; an interrupt of the terminal is for the daemon to handle. */
static void set_signals(void) {
    signal(SIGINT, SIG_IGN);
    signal(SIGTERM, SIG_IGN);
    signal(SIGPIPE, SIG_IGN);
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
static int serve(struct mouthpiece *m, struct host *host) {
    struct wire_frame frame;
    while (mouthpiece_next(m, &frame)) {
        struct faccia_sentence sentence;
        struct faccia_span *spans = NULL;
        struct wire_reader r = wire_read(&frame);
        uint32_t seconds = wire_get_u32(&r);
        bool understood = frame.type == WIRE_SPEAK && wire_get_sentence(&r, &sentence, &spans);
        if (understood) {
            limit_processor(seconds);
            mouthpiece_speak(m, host->api, host->self, frame.job, &sentence);
        }
        free(spans);
        if (!understood) {
            log_error("a voice worker was asked for something that it does not understand");
            return 1;
        }
    }
    return 0;
}

/* Without a sandbox it goes on. */
static void confine(const struct host *host, const struct wire_limits *limits) {
    char why[160];
    if (limits->sandbox && sandbox_enter(host->capabilities, why, sizeof why) < 0 && !limits->quiet)
        log_warn("the voice %s runs without a sandbox: %s", host->api->name, why);
}

static int run(struct mouthpiece *m, const char *plugin) {
    struct wire_frame frame;
    struct host host;
    char message[256];
    if (!mouthpiece_next(m, &frame))
        return 0;
    struct wire_reader r = wire_read(&frame);
    const char *config = wire_get_string(&r);
    const struct wire_limits limits = wire_get_limits(&r);
    if (frame.type != WIRE_OPEN || !config || r.bad) {
        log_error("a voice worker was not told its configuration");
        return 1;
    }
    limit_memory(limits.megabytes);
    limit_processor(limits.seconds);
    int result = host_load(&host, plugin, message, sizeof message);
    if (!result) {
        confine(&host, &limits);
        result = host_open(&host, config, message, sizeof message);
    }
    if (result) {
        mouthpiece_say(m, result > 0 ? WIRE_ABSENT : WIRE_FAILED, message);
        return 1;
    }
    char *description = host_describe(&host);
    mouthpiece_say(m, WIRE_HELLO, description);
    free(description);
    int status = serve(m, &host);
    host_close(&host);
    return status;
}

int main(int argc, char **argv) {
    bool help = argc == 2 && !strcmp(argv[1], "--help");
    if (argc != 2 || help || set_socket() < 0) {
        fprintf(stderr,
                "usage: faccia-voice PLUGIN.so\nRuns a voice plugin for facciad, which starts this program "
                "by itself.\n");
        return help ? 0 : 2;
    }
    set_signals();
    struct mouthpiece *m = mouthpiece_open(WIRE_FD);
    return run(m, argv[1]); /* m is the listening thread's, too */
}
