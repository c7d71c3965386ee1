/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tries everything that a plugin must not do to the daemon or to the machine: all of it in an initialiser,
 * before the first request, and by name when it speaks. A warning reports both results, as in "refused,
 * done"; either may be another error. Built twice, once as a plugin that may start programs.
 * $FACCIA_TEST_SECRET is a file that the daemon may read, $FACCIA_TEST_FOLDER a folder in which it may write.
 */
#include "server/voice/faccia-voice.h"
#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <sched.h>
#include <setjmp.h>
#include <signal.h>
#include <spawn.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mount.h>
#include <sys/ptrace.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>

/* 0, or the error. */
static int error_of(long result) {
    return result < 0 ? errno : 0;
}

static int try_open(const char *path, int flags) {
    int fd = open(path, flags, 0600), result = error_of(fd);
    if (fd >= 0)
        close(fd);
    return result;
}

static int of_parent(const char *name, int flags) {
    char path[64];
    snprintf(path, sizeof path, "/proc/%d/%s", (int)getppid(), name);
    return try_open(path, flags);
}

static const char *in_folder(const char *name) {
    static char path[512];
    const char *folder = getenv("FACCIA_TEST_FOLDER");
    snprintf(path, sizeof path, "%s/%s", folder ? folder : "/tmp", name);
    return path;
}

static int memory(void) {
    return of_parent("mem", O_RDWR);
}

static int read_memory(void) {
    return of_parent("mem", O_RDONLY);
}

static int read_environment(void) {
    return of_parent("environ", O_RDONLY);
}

static int trace(void) {
    return error_of(ptrace(PTRACE_SEIZE, getppid(), NULL, NULL));
}

static int copy_memory(long call) {
    char here[8] = "";
    struct iovec local = {here, sizeof here}, remote = {here, sizeof here};
    return error_of(syscall(call, getppid(), &local, 1, &remote, 1, 0));
}

static int peek(void) {
    return copy_memory(SYS_process_vm_readv);
}

static int poke(void) {
    return copy_memory(SYS_process_vm_writev);
}

/* SIGURG does no harm where it arrives. */
static int signal_parent(void) {
    return error_of(kill(getppid(), SIGURG));
}

static int signal_group(void) {
    return error_of(kill(-getpgid(getppid()), SIGURG));
}

static int signal_all(void) {
    return error_of(kill(-1, SIGURG));
}

static int signal_thread(void) {
    return error_of(syscall(SYS_tgkill, getppid(), getppid(), SIGURG));
}

static int queue_signal(void) {
    return error_of(sigqueue(getppid(), SIGURG, (union sigval){0}));
}

static int open_process(void) {
    long fd = syscall(SYS_pidfd_open, getppid(), 0);
    int result = error_of(fd);
    if (fd >= 0)
        close((int)fd);
    return result;
}

/* The kernel then sends signals to the owner. */
static int own_descriptor(void) {
    int ends[2];
    if (pipe(ends))
        return errno;
    int result = error_of(fcntl(ends[0], F_SETOWN, getppid()));
    close(ends[0]);
    close(ends[1]);
    return result;
}

static int priority(void) {
    return error_of(setpriority(PRIO_PROCESS, (id_t)getppid(), 1));
}

static int priority_of_user(void) {
    return error_of(setpriority(PRIO_USER, 0, 0));
}

static int disk_priority(void) {
    return error_of(syscall(SYS_ioprio_set, 1, getppid(), 2 << 13 | 4));
}

static int processors(void) {
    cpu_set_t set;
    CPU_ZERO(&set);
    CPU_SET(0, &set);
    return error_of(sched_setaffinity(getppid(), sizeof set, &set));
}

static int limits(void) {
    struct rlimit limit;
    return error_of(prlimit(getppid(), RLIMIT_NOFILE, NULL, &limit));
}

static int out_of_memory_score(void) {
    return of_parent("oom_score_adj", O_WRONLY);
}

static int datagram(void) {
    int fd = socket(AF_INET, SOCK_DGRAM, 0), result = error_of(fd);
    if (fd >= 0)
        close(fd);
    return result;
}

static const struct sockaddr_un nobody = {AF_UNIX, "/nonexistent"};

static int send_to(int fd) {
    return error_of(sendto(fd, "x", 1, MSG_NOSIGNAL, (const struct sockaddr *)&nobody, sizeof nobody));
}

/* A pair's ends may send to others, too. */
static int datagram_of_a_pair(void) {
    int ends[2];
    if (socketpair(AF_UNIX, SOCK_DGRAM, 0, ends))
        return errno;
    int result = send_to(ends[0]);
    close(ends[0]);
    close(ends[1]);
    return result;
}

static int send_with_address(void) {
    return send_to(3); /* the worker's own socket */
}

static int connect_socket(void) {
    int fd = socket(AF_UNIX, SOCK_STREAM, 0);
    int result = fd < 0 ? errno : error_of(connect(fd, (const struct sockaddr *)&nobody, sizeof nobody));
    if (fd >= 0)
        close(fd);
    return result;
}

static sigjmp_buf no_table;

static void on_fault(int number) {
    siglongjmp(no_table, number);
}

/* The other table of calls of the same machine; where a kernel has none, it is a fault. */
static int old_call(void) {
#ifdef __x86_64__
    struct sigaction ours = {.sa_handler = on_fault}, theirs;
    volatile int outcome = ENOSYS;
    sigaction(SIGSEGV, &ours, &theirs);
    if (!sigsetjmp(no_table, 1)) {
        long result;
        __asm__ volatile("int $0x80" : "=a"(result) : "a"(20) : "memory", "r8", "r9", "r10", "r11");
        outcome = result < 0 ? (int)-result : 0;
    }
    sigaction(SIGSEGV, &theirs, NULL);
    return outcome;
#else
    return ENOSYS;
#endif
}

static int run_program(void) {
    char *const argv[] = {"true", NULL};
    pid_t child;
    int result = posix_spawn(&child, "/bin/true", NULL, NULL, argv, NULL);
    if (!result)
        waitpid(child, NULL, 0);
    return result;
}

static int fork_many(void) {
    for (int i = 0; i < 50; i++) {
        pid_t child = fork();
        if (child < 0)
            return errno;
        if (child == 0)
            _exit(0);
        waitpid(child, NULL, 0);
    }
    return 0;
}

static int new_namespace(void) {
    return error_of(unshare(CLONE_NEWUSER));
}

static int mount_something(void) {
    return error_of(mount("none", "/tmp", "tmpfs", 0, NULL));
}

static int read_secret(void) {
    const char *path = getenv("FACCIA_TEST_SECRET");
    return try_open(path ? path : "/", O_RDONLY);
}

static int list_home(void) {
    const char *home = getenv("HOME");
    return try_open(home ? home : "/", O_RDONLY | O_DIRECTORY);
}

static int write_file(void) {
    return try_open(in_folder("file"), O_WRONLY);
}

static int empty_file(void) {
    return try_open(in_folder("file"), O_RDONLY | O_TRUNC);
}

static int truncate_file(void) {
    return error_of(truncate(in_folder("file"), 0));
}

static int create_file(void) {
    return try_open(in_folder("new"), O_WRONLY | O_CREAT);
}

static int create_in_tmp(void) {
    return try_open("/tmp/faccia-test-escape", O_WRONLY | O_CREAT);
}

static int remove_file(void) {
    return error_of(unlink(in_folder("file")));
}

static int make_folder(void) {
    return error_of(mkdir(in_folder("folder"), 0700));
}

static int change_mode(void) {
    return error_of(chmod(in_folder("file"), 0777));
}

static int write_comm(void) { /* a file of the parent that other processes of the same user may write */
    return of_parent("comm", O_WRONLY);
}

static int read_system(void) {
    return try_open("/usr/bin/env", O_RDONLY);
}

static int write_nowhere(void) {
    return try_open("/dev/null", O_WRONLY | O_TRUNC);
}

static void *nothing(void *ctx) {
    return ctx;
}

static int start_thread(void) {
    pthread_t thread;
    int result = pthread_create(&thread, NULL, nothing, NULL);
    return result ? result : pthread_join(thread, NULL);
}

static const struct {
    const char *name;
    int (*attempt)(void);
} attempts[] = {
    {"memory", memory},
    {"read memory", read_memory},
    {"environment", read_environment},
    {"trace", trace},
    {"peek", peek},
    {"poke", poke},
    {"signal", signal_parent},
    {"signal group", signal_group},
    {"signal all", signal_all},
    {"signal thread", signal_thread},
    {"queue signal", queue_signal},
    {"open process", open_process},
    {"own descriptor", own_descriptor},
    {"priority", priority},
    {"priority of user", priority_of_user},
    {"disk priority", disk_priority},
    {"processors", processors},
    {"limits", limits},
    {"out of memory score", out_of_memory_score},
    {"datagram", datagram},
    {"datagram of a pair", datagram_of_a_pair},
    {"send with address", send_with_address},
    {"connect", connect_socket},
    {"old call", old_call},
    {"program", run_program},
    {"fork", fork_many},
    {"namespace", new_namespace},
    {"mount", mount_something},
    {"secret", read_secret},
    {"home", list_home},
    {"write", write_file},
    {"empty", empty_file},
    {"truncate", truncate_file},
    {"create", create_file},
    {"create in tmp", create_in_tmp},
    {"remove", remove_file},
    {"folder", make_folder},
    {"mode", change_mode},
    {"name", write_comm},
    {"system", read_system},
    {"nowhere", write_nowhere},
    {"thread", start_thread},
};
enum { ATTEMPTS = sizeof attempts / sizeof *attempts };

static int before[ATTEMPTS];

__attribute__((constructor)) static void initialise(void) {
    for (size_t i = 0; i < ATTEMPTS; i++)
        before[i] = attempts[i].attempt();
}

static int escape_open(const char *config, void **self, char *message, size_t cap) {
    (void)config, (void)self, (void)message, (void)cap;
    return 0;
}

static void escape_list(void *self, void (*each)(void *ctx, const struct faccia_voice_info *voice),
                        void *ctx) {
    (void)self;
    each(ctx, &(struct faccia_voice_info){.id = "plain", .lang = "it", .sample_rate = 16000});
}

static const char *word_for(int result) {
    bool refused = result == EPERM || result == EACCES || result == ENOSYS;
    return refused ? "refused" : result ? strerror(result) : "done";
}

static int escape_speak(void *self, const struct faccia_sentence *sentence, const struct faccia_sink *sink,
                        char *message, size_t cap) {
    static const int16_t samples[160];
    const char *wanted = sentence->span_count && sentence->spans[0].text ? sentence->spans[0].text : "";
    (void)self;
    for (size_t i = 0; i < ATTEMPTS; i++) {
        char text[120];
        if (strcmp(attempts[i].name, wanted) != 0)
            continue;
        snprintf(text, sizeof text, "%s, %s", word_for(before[i]), word_for(attempts[i].attempt()));
        sink->warning(sink->ctx, text);
        sink->audio(sink->ctx, samples, 160, 16000);
        return 0;
    }
    snprintf(message, cap, "there is no attempt of that name");
    return -1;
}

static void escape_close(void *self) {
    (void)self;
}

__attribute__((visibility("default"))) const struct faccia_voice faccia_voice = {
    .abi = FACCIA_VOICE_ABI,
    .size = sizeof(struct faccia_voice),
    .name = "escape",
    .version = "1",
    .licence = "GPL-3.0-or-later",
    .capabilities = CAPABILITIES,
    .open = escape_open,
    .list = escape_list,
    .speak = escape_speak,
    .close = escape_close,
};
