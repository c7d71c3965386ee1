/* SPDX-License-Identifier: GPL-3.0-or-later */
/* faccia-reader: parses one untrusted input for the daemon, which starts it for each input or live voice
 * (base/work/reader_process.h). It may read standard input and the system's libraries, write to standard
 * output, and use limited processor time and memory. */
#include "server/base/program.h"
#include "server/library/works/work.h"
#include "server/live/opus_process.h"
#include "server/voice/sandbox.h"
#include "server/voice/sound_reader.h"
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

enum { SECONDS = 1, MEGABYTES, SANDBOX, KIND, INPUT, LANG, RATE = INPUT, CHANNELS = LANG };

static unsigned number(const char *text) {
    return (unsigned)strtoul(text, NULL, 10);
}

static void limit(const char *seconds, const char *megabytes) {
    const rlim_t most = (rlim_t)strtoul(seconds, NULL, 10);
    const struct rlimit time = {most, most + 1}, nothing = {0, 0};
    signal(SIGINT, SIG_IGN);
    program_end_with_parent(STDOUT_FILENO, SIGKILL);
    close_range(3, ~0u, 0); /* closes descriptors that the daemon leaked */
    setrlimit(RLIMIT_CPU, &time);
    setrlimit(RLIMIT_FSIZE, &nothing);
    memory_limit((uint32_t)strtoul(megabytes, NULL, 10));
}

/* Denies all files: the input is already open. */
static void confine(const char *program) {
    const struct plugin_needs needs = {.capabilities = 0};
    const struct sandbox sandbox = {program, &needs, NULL, 0, getppid()};
    struct sandbox_gaps gaps;
    sandbox_enter(&sandbox, &gaps);
}

/* Parses the input as the arguments say. 1: this build does not know its kind. -1: it failed. */
static int parse(int argc, char **argv) {
    const char *kind = argv[KIND];
    if (argc == INPUT + 1 && !strcmp(kind, "sound"))
        return sound_reader_serve(number(argv[INPUT]), STDIN_FILENO, STDOUT_FILENO) ? -1 : 0;
#ifdef HAVE_LIVE
    if (argc == LANG + 1 && !strcmp(kind, "opus"))
        return opus_process_serve(number(argv[RATE]), number(argv[CHANNELS]), STDIN_FILENO, STDOUT_FILENO)
                   ? -1
                   : 0;
#endif
#ifdef HAVE_LIBRARY
    if (argc == LANG + 1 && !strcmp(kind, "work"))
        return work_apart_read(argv[INPUT], argv[LANG], STDIN_FILENO, STDOUT_FILENO) ? -1 : 0;
    if (argc == INPUT + 1 && !strcmp(kind, "check"))
        return work_apart_check(argv[INPUT], STDIN_FILENO, STDOUT_FILENO) ? -1 : 0;
#endif
    return 1;
}

int main(int argc, char **argv) {
    program_begin();
    int result = 1;
    if (argc > KIND) {
        limit(argv[SECONDS], argv[MEGABYTES]);
        if (strcmp(argv[SANDBOX], "off") != 0)
            confine(argv[0]);
        result = parse(argc, argv);
    }
    if (result == 1)
        fputs("usage: faccia-reader SECONDS MEGABYTES on|off work NAME LANG | check NAME | sound "
              "CHANNELS | opus RATE CHANNELS\nParses a file or packets, its standard input, for facciad, "
              "which starts this program by itself.\n",
              stderr);
    return result != 1 ? -result : argc == 2 && !strcmp(argv[1], "--help") ? 0 : 2;
}
