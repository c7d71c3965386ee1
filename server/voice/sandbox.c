/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The sandbox as a whole, and its outer layers: namespaces, and the administrator's rights. */
#include "server/base/mem.h"
#include "server/voice/sandbox_internal.h"
#include <errno.h>
#include <fcntl.h>
#include <linux/capability.h>
#include <sched.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <sys/utsname.h>
#include <sys/wait.h>
#include <unistd.h>

/* Processes and threads of a worker with all that it starts. */
enum { TASKS_MAX = 512 };

static int write_file(const char *path, const char *text) {
    int fd = open(path, O_WRONLY | O_CLOEXEC);
    ssize_t n = fd < 0 ? -1 : write(fd, text, strlen(text));
    if (fd >= 0)
        close(fd);
    return n < 0 ? -1 : 0;
}

/* Until Linux 5.14 those of the user outside of the namespace were counted, too. */
static void limit_tasks(void) {
    const struct rlimit tasks = {TASKS_MAX, TASKS_MAX};
    struct utsname system;
    unsigned major = 0, minor = 0;
    if (!uname(&system) && sscanf(system.release, "%u.%u", &major, &minor) == 2 &&
        (major > 5 || (major == 5 && minor >= 14)))
        setrlimit(RLIMIT_NPROC, &tasks);
}

/* Its user is the same inside as outside: what it owns stays its own. */
static int keep_identity(unsigned user, unsigned group) {
    char users[40], groups[40];
    snprintf(users, sizeof users, "%u %u 1", user, user);
    snprintf(groups, sizeof groups, "%u %u 1", group, group);
    return write_file("/proc/self/uid_map", users) || write_file("/proc/self/setgroups", "deny") ||
           write_file("/proc/self/gid_map", groups);
}

static int enter(int network) {
    const unsigned user = geteuid(), group = getegid();
    return unshare(CLONE_NEWUSER) || keep_identity(user, group) || unshare(CLONE_NEWIPC | network) ? -1 : 0;
}

/* There is no way back from a namespace in which it could not keep its identity, so a child tries first.
 * Gives an error, or 0. */
static int try_in_child(int network) {
    int status = 0;
    pid_t child = fork();
    if (child == 0)
        _exit(enter(network) ? errno : 0);
    if (child < 0 || waitpid(child, &status, 0) < 0)
        return errno;
    return WIFEXITED(status) ? WEXITSTATUS(status) : EPERM;
}

static int sandbox_spaces(uint32_t capabilities, char *why, size_t cap) {
    const int network = capabilities & FACCIA_VOICE_NETWORK ? 0 : CLONE_NEWNET;
    int error = try_in_child(network);
    if (!error && enter(network))
        error = errno;
    if (error)
        snprintf(why, cap, "no namespaces of their own (%s)", strerror(error));
    else
        limit_tasks();
    return error ? -1 : 0;
}

static void sandbox_drop_rights(void) {
    struct __user_cap_header_struct header = {.version = _LINUX_CAPABILITY_VERSION_3};
    const struct __user_cap_data_struct none[_LINUX_CAPABILITY_U32S_3] = {{0}};
    prctl(PR_CAP_AMBIENT, PR_CAP_AMBIENT_CLEAR_ALL, 0, 0, 0);
    for (unsigned right = 0; prctl(PR_CAPBSET_READ, right, 0, 0, 0) >= 0; right++)
        prctl(PR_CAPBSET_DROP, right, 0, 0, 0);
    syscall(SYS_capset, &header, none);
}

/* libpulse, which espeak-ng brings along, looks for the desktop's sound server, and would complain of all
 * that it is refused meanwhile. */
static void keep_quiet(void) {
    setenv("PULSE_SERVER", "unix:/dev/null", 1);
    setenv("PULSE_CLIENTCONFIG", "/dev/null", 1);
}

/* The order matters: the identity in a new namespace is written to /proc/self, which is closed afterwards;
 * files are opened for the rules; the filter of calls refuses all of that. */
void sandbox_enter(const struct sandbox *s, struct sandbox_gaps *gaps) {
    const uint32_t capabilities = s->needs->capabilities;
    *gaps = (struct sandbox_gaps){0};
    keep_quiet();
    sandbox_spaces(capabilities, gaps->spaces, sizeof gaps->spaces);
    sandbox_drop_rights();
    private_memory();
    prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0);
    sandbox_files(s, gaps->files, sizeof gaps->files);
    sandbox_calls(capabilities, s->daemon, gaps->calls, sizeof gaps->calls);
}
