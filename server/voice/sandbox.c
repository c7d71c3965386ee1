/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/voice/sandbox.h"
#include "server/base/mem.h"
#include "server/voice/faccia-voice.h"
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <linux/capability.h>
#include <sched.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/utsname.h>
#include <sys/wait.h>
#include <unistd.h>

/* The leak detector stops the process from a helper process, with ptrace. */
#if defined __SANITIZE_ADDRESS__ || defined __SANITIZE_THREAD__
enum { SANDBOX_WATCHED = 1 };
#else
enum { SANDBOX_WATCHED = 0 };
#endif

void memory_limit(uint32_t megabytes) {
    const struct rlimit none = {0, 0};
    setrlimit(RLIMIT_CORE, &none);
#if !defined __SANITIZE_ADDRESS__ && !defined __SANITIZE_THREAD__
    const rlim_t bytes = (rlim_t)megabytes << 20;
    const struct rlimit space = {bytes, bytes};
    setrlimit(RLIMIT_AS, &space);
#else
    (void)megabytes;
#endif
}

/* System calls refused with seccomp. Always: access to other processes, mounts, namespaces, settings of
 * the kernel and the machine, limits and priorities of other processes, keyrings, io_uring (which bypasses
 * filters), typing into a terminal, and signals to the daemon. Further calls depend on the capabilities.
 * Where a filter cannot see an argument, because it is in memory, the whole call is refused. */

#define COUNT(list) (sizeof(list) / sizeof *(list))

#ifdef HAVE_SECCOMP
#include <errno.h>
#include <fcntl.h>
#include <sched.h>
#include <seccomp.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <unistd.h>

#define CALL(name) SCMP_SYS(name)

static const int refused_calls[] = {
    CALL(process_vm_readv),
    CALL(process_vm_writev),
    CALL(process_madvise),
    CALL(process_mrelease),
    CALL(pidfd_getfd),
    CALL(kcmp),
    CALL(mount),
    CALL(umount2),
    CALL(mount_setattr),
    CALL(open_tree),
    CALL(move_mount),
    CALL(fsopen),
    CALL(fsconfig),
    CALL(fsmount),
    CALL(fspick),
    CALL(pivot_root),
    CALL(chroot),
    CALL(unshare),
    CALL(setns),
    CALL(open_by_handle_at),
    CALL(bpf),
    CALL(perf_event_open),
    CALL(userfaultfd),
    CALL(io_uring_setup),
    CALL(io_uring_enter),
    CALL(io_uring_register),
    CALL(add_key),
    CALL(request_key),
    CALL(keyctl),
    CALL(init_module),
    CALL(finit_module),
    CALL(delete_module),
    CALL(kexec_load),
    CALL(kexec_file_load),
    CALL(reboot),
    CALL(swapon),
    CALL(swapoff),
    CALL(settimeofday),
    CALL(clock_settime),
    CALL(clock_adjtime),
    CALL(adjtimex),
    CALL(stime),
    CALL(sethostname),
    CALL(setdomainname),
    CALL(acct),
    CALL(quotactl),
    CALL(syslog),
    CALL(iopl),
    CALL(ioperm),
    CALL(vhangup),
    CALL(fanotify_init),
    CALL(lookup_dcookie),
    CALL(migrate_pages),
    CALL(move_pages),
    CALL(nfsservctl),
};

static const int program_calls[] = {
    CALL(execve),
    CALL(execveat),
    CALL(fork),
    CALL(vfork),
    CALL(tkill),
    CALL(rt_sigqueueinfo),
    CALL(rt_tgsigqueueinfo),
    CALL(pidfd_open),
    CALL(pidfd_send_signal),
    CALL(shmget),
    CALL(msgget),
    CALL(semget),
    CALL(mq_open),
    CALL(mq_unlink),
};

/* Calls that change files other than through a descriptor; Landlock does not cover all of them. */
static const int file_calls[] = {
    CALL(chmod),        CALL(fchmod),       CALL(fchmodat),  CALL(chown),     CALL(fchown),
    CALL(lchown),       CALL(fchownat),     CALL(utime),     CALL(utimes),    CALL(utimensat),
    CALL(futimesat),    CALL(setxattr),     CALL(lsetxattr), CALL(fsetxattr), CALL(removexattr),
    CALL(lremovexattr), CALL(fremovexattr), CALL(truncate),  CALL(rename),    CALL(renameat),
    CALL(renameat2),    CALL(link),         CALL(linkat),    CALL(symlink),   CALL(symlinkat),
    CALL(unlink),       CALL(unlinkat),     CALL(mkdir),     CALL(mkdirat),   CALL(rmdir),
    CALL(mknod),        CALL(mknodat),      CALL(creat),
};

/* Calls unknown to the library: fchmodat2, setxattrat, removexattrat, open_tree_attr, file_setattr. Their
 * numbers are the same on all architectures. */
static const int unnamed_calls[] = {452, 463, 466, 467, 469};

static const uint64_t namespaces[] = {CLONE_NEWUSER, CLONE_NEWNS,  CLONE_NEWPID,   CLONE_NEWNET,
                                      CLONE_NEWIPC,  CLONE_NEWUTS, CLONE_NEWCGROUP};

/* The other bits of the argument are flags. */
enum { SOCK_TYPE = 0xf };

/* ioctl requests that set the receiver of a descriptor's signals, or type into a terminal. */
static const uint64_t controls[] = {TIOCSTI, TIOCLINUX, FIOSETOWN, SIOCSPGRP};

/* The kernel reads 32 bits of these arguments. */
#define LOW(bits) SCMP_CMP_MASKED_EQ, 0xffffffffu, (bits)

static int refuse(scmp_filter_ctx filter, int call) {
    return seccomp_rule_add(filter, SCMP_ACT_ERRNO(EPERM), call, 0);
}

static int refuse_when(scmp_filter_ctx filter, int call, struct scmp_arg_cmp condition) {
    return seccomp_rule_add_array(filter, SCMP_ACT_ERRNO(EPERM), call, 1, &condition);
}

static int refuse_all(scmp_filter_ctx filter, const int *calls, size_t count) {
    int result = 0;
    for (size_t i = 0; i < count && !result; i++)
        result = refuse(filter, calls[i]);
    return result;
}

/* Refuses to change priorities of other processes or of the whole user. */
static int refuse_priorities(scmp_filter_ctx filter) {
    enum { IO_USER = 3 };
    int result = refuse_when(filter, CALL(setpriority), SCMP_A0(LOW(PRIO_USER)));
    if (!result)
        result = refuse_when(filter, CALL(setpriority), SCMP_A1(SCMP_CMP_NE, 0));
    if (!result)
        result = refuse_when(filter, CALL(ioprio_set), SCMP_A0(LOW(IO_USER)));
    if (!result)
        result = refuse_when(filter, CALL(ioprio_set), SCMP_A1(SCMP_CMP_NE, 0));
    return result;
}

/* Refuses to set the owner of a descriptor, because the kernel sends its signals there. */
static int refuse_owners(scmp_filter_ctx filter) {
    static const int ways[] = {F_SETOWN, F_SETOWN_EX, F_SETSIG};
    int result = 0;
    for (size_t i = 0; i < COUNT(ways) && !result; i++)
        result = refuse_when(filter, CALL(fcntl), SCMP_A1(LOW((uint64_t)ways[i])));
    for (size_t i = 0; i < COUNT(controls) && !result; i++)
        result = refuse_when(filter, CALL(ioctl), SCMP_A1(LOW(controls[i])));
    return result;
}

static int refuse_foreign(scmp_filter_ctx filter) {
    int result = refuse_all(filter, refused_calls, COUNT(refused_calls));
    if (!result && !SANDBOX_WATCHED)
        result = refuse(filter, CALL(ptrace));
    if (!result)
        result = refuse_when(filter, CALL(prlimit64), SCMP_A0(SCMP_CMP_NE, 0));
    for (size_t i = 0; i < COUNT(namespaces) && !result; i++)
        result = refuse_when(filter, CALL(clone), SCMP_A0(SCMP_CMP_MASKED_EQ, namespaces[i], namespaces[i]));
    if (!result) /* its flags are in memory, invisible to the filter: libraries fall back to clone */
        result = seccomp_rule_add(filter, SCMP_ACT_ERRNO(ENOSYS), CALL(clone3), 0);
    if (!result) /* likewise */
        result = seccomp_rule_add(filter, SCMP_ACT_ERRNO(ENOSYS), CALL(openat2), 0);
    if (!result)
        result = refuse_priorities(filter);
    return result ? result : refuse_owners(filter);
}

/* Protects the daemon, where signals to other processes are allowed. */
static int refuse_daemon(scmp_filter_ctx filter, pid_t daemon) {
    static const int calls[] = {CALL(kill),
                                CALL(tkill),
                                CALL(tgkill),
                                CALL(rt_sigqueueinfo),
                                CALL(rt_tgsigqueueinfo),
                                CALL(pidfd_open),
                                CALL(sched_setaffinity),
                                CALL(sched_setscheduler),
                                CALL(sched_setparam),
                                CALL(sched_setattr)};
    int result = 0;
    for (size_t i = 0; i < COUNT(calls) && !result; i++)
        result = refuse_when(filter, calls[i], SCMP_A0(LOW((uint32_t)daemon)));
    if (!result) /* all processes */
        result = refuse_when(filter, CALL(kill), SCMP_A0(LOW(UINT32_MAX)));
    if (!result) /* its process group */
        result = refuse_when(filter, CALL(kill), SCMP_A0(LOW((uint32_t)-getpgid(daemon))));
    return result;
}

static int refuse_programs(scmp_filter_ctx filter) {
    static const int others[] = {CALL(sched_setaffinity), CALL(sched_setscheduler), CALL(sched_setparam),
                                 CALL(sched_setattr)};
    const uint64_t self = (uint64_t)getpid(), thread = CLONE_THREAD | (SANDBOX_WATCHED ? CLONE_UNTRACED : 0);
    int result = refuse_all(filter, program_calls, COUNT(program_calls));
    if (!result) /* allow threads, and the leak detector's helper */
        result = refuse_when(filter, CALL(clone), SCMP_A0(SCMP_CMP_MASKED_EQ, thread, 0));
    if (!result)
        result = refuse_when(filter, CALL(kill), SCMP_A0(SCMP_CMP_NE, self));
    if (!result)
        result = refuse_when(filter, CALL(tgkill), SCMP_A0(SCMP_CMP_NE, self));
    for (size_t i = 0; i < COUNT(others) && !result; i++)
        result = refuse_when(filter, others[i], SCMP_A0(SCMP_CMP_NE, 0));
    if (!result && !SANDBOX_WATCHED) /* so that it always ends with the daemon */
        result = refuse_when(filter, CALL(prctl), SCMP_A0(LOW(PR_SET_PDEATHSIG)));
    return result;
}

/* Opening with O_TRUNC writes, even read-only. */
static int refuse_files(scmp_filter_ctx filter) {
    const struct scmp_arg_cmp of_open = SCMP_A1(SCMP_CMP_MASKED_EQ, O_TRUNC | O_ACCMODE, O_TRUNC);
    const struct scmp_arg_cmp of_openat = SCMP_A2(SCMP_CMP_MASKED_EQ, O_TRUNC | O_ACCMODE, O_TRUNC);
    int result = refuse_all(filter, file_calls, COUNT(file_calls));
    if (!result)
        result = refuse_when(filter, CALL(open), of_open);
    if (!result)
        result = refuse_when(filter, CALL(openat), of_openat);
    return result;
}

/* Allows only UNIX stream sockets, and no connections: libpulse, which espeak-ng loads, complains if it
 * cannot create a socket but accepts that no server answers. Datagram sockets and pairs could send to any
 * address. */
static int refuse_network(scmp_filter_ctx filter) {
    static const int uses[] = {CALL(connect), CALL(bind),    CALL(listen),
                               CALL(accept),  CALL(accept4), CALL(socketcall)};
    static const int makers[] = {CALL(socket), CALL(socketpair)};
    int result = 0;
    for (size_t i = 0; i < COUNT(makers) && !result; i++) {
        result = refuse_when(filter, makers[i], SCMP_A0(SCMP_CMP_NE, AF_UNIX));
        for (uint64_t type = 0; type <= SOCK_TYPE && !result; type++)
            if (type != SOCK_STREAM)
                result = refuse_when(filter, makers[i], SCMP_A1(SCMP_CMP_MASKED_EQ, SOCK_TYPE, type));
    }
    if (!result)
        result = refuse_when(filter, CALL(sendto), SCMP_A4(SCMP_CMP_NE, 0));
    return result ? result : refuse_all(filter, uses, COUNT(uses));
}

/* Started programs may be 32-bit; otherwise that call table, where socket arguments are in memory, is
 * closed. */
static int load(scmp_filter_ctx filter, uint32_t capabilities, pid_t daemon) {
    const bool runs = capabilities & FACCIA_VOICE_PROGRAMS;
    const bool writes = capabilities & FACCIA_VOICE_FILES;
    int result = seccomp_attr_set(filter, SCMP_FLTATR_ACT_BADARCH, SCMP_ACT_ERRNO(ENOSYS));
    if (!result && !writes) /* before a second architecture is added, for which libseccomp would need names */
        result = refuse_all(filter, unnamed_calls, COUNT(unnamed_calls));
    if (!result && runs && seccomp_arch_native() == SCMP_ARCH_X86_64)
        result = seccomp_arch_add(filter, SCMP_ARCH_X86);
    if (!result)
        result = refuse_foreign(filter);
    if (!result && !(capabilities & FACCIA_VOICE_NETWORK))
        result = refuse_network(filter);
    if (!result && !writes)
        result = refuse_files(filter);
    if (!result)
        result = runs ? refuse_daemon(filter, daemon) : refuse_programs(filter);
    return result ? result : seccomp_load(filter);
}

static int sandbox_calls(uint32_t capabilities, pid_t daemon, char *why, size_t cap) {
    scmp_filter_ctx filter = seccomp_init(SCMP_ACT_ALLOW);
    int result = filter ? load(filter, capabilities, daemon) : -ENOMEM;
    if (filter)
        seccomp_release(filter);
    if (!result)
        return 0;
    snprintf(why, cap, "no system call filter (%s)", strerror(-result));
    return -1;
}

#else

int sandbox_calls(uint32_t capabilities, pid_t daemon, char *why, size_t cap) {
    (void)capabilities, (void)daemon;
    snprintf(why, cap, "no system call filter (built without libseccomp)");
    return -1;
}

#endif

/* File access with Landlock, as far as the kernel supports it; also blocks signals to processes outside
 * and, without FACCIA_VOICE_NETWORK, connections. */

/* The kernel's interface, because system headers may know only a part of it. */
#define CALL_CREATE 444
#define CALL_ADD 445
#define CALL_RESTRICT 446
enum { VERSION_ASKED = 1, RULE_BENEATH = 1 };

enum {
    EXECUTE = 1 << 0,
    WRITE_FILE = 1 << 1,
    READ_FILE = 1 << 2,
    READ_FOLDER = 1 << 3,
    REMOVE_FOLDER = 1 << 4,
    REMOVE_FILE = 1 << 5,
    MAKE_DEVICES = 1 << 6 | 1 << 11,
    MAKE_FOLDER = 1 << 7,
    MAKE_FILE = 1 << 8,
    MAKE_SOCKET = 1 << 9,
    MAKE_PIPE = 1 << 10,
    MAKE_LINK = 1 << 12,
    MOVE = 1 << 13,     /* between folders; since version 2 */
    TRUNCATE = 1 << 14, /* since version 3 */
    CONTROL = 1 << 15,  /* ioctl of devices; since version 5 */
};

enum {
    READ = READ_FILE | READ_FOLDER,
    WRITE = WRITE_FILE | REMOVE_FOLDER | REMOVE_FILE | MAKE_FOLDER | MAKE_FILE | MAKE_SOCKET | MAKE_PIPE |
            MAKE_LINK | MOVE | TRUNCATE,
    EVERYTHING = READ | WRITE | EXECUTE | MAKE_DEVICES | CONTROL,
    OF_FILES = EXECUTE | WRITE_FILE | READ_FILE | TRUNCATE | CONTROL,
};

enum { NETWORK_TCP = 3, SCOPE_SOCKETS = 1, SCOPE_SIGNALS = 2 };

struct ruleset {
    uint64_t files, network, scope;
};

struct beneath {
    uint64_t allowed;
    int32_t folder;
} __attribute__((packed));

/* Programs and libraries of the system with their data, and what a C library reads. */
static const char *const common_paths[] = {"/usr",
                                           "/lib",
                                           "/lib32",
                                           "/lib64",
                                           "/libx32",
                                           "/bin",
                                           "/sbin",
                                           "/etc/ld.so.cache",
                                           "/etc/ld.so.conf",
                                           "/etc/ld.so.conf.d",
                                           "/etc/ld.so.preload",
                                           "/etc/alternatives",
                                           "/etc/localtime",
                                           "/etc/timezone",
                                           "/etc/locale.alias",
                                           "/etc/default/locale",
                                           "/dev/zero",
                                           "/dev/random",
                                           "/dev/urandom",
                                           "/proc/self",
                                           "/proc/cpuinfo",
                                           "/proc/meminfo",
                                           "/proc/stat",
                                           "/proc/filesystems",
                                           "/proc/sys/vm",
                                           "/proc/sys/kernel/random",
                                           "/sys/devices/system/cpu",
                                           "/sys/devices/system/node",
                                           "/sys/kernel/mm/transparent_hugepage"};

/* Further files that programs and interpreters read. */
static const char *const program_paths[] = {
    "/etc/passwd",     "/etc/group",      "/etc/nsswitch.conf",   "/etc/festival.scm", "/etc/festival",
    "/etc/mime.types", "/etc/os-release", "/etc/ssl/openssl.cnf", "/etc/java",         "/etc/perl",
    "/etc/python3",    "/etc/python3.9",  "/etc/python3.10",      "/etc/python3.11",   "/etc/python3.12",
    "/etc/python3.13", "/etc/inputrc",    "/etc/ImageMagick",     "/proc/version",     "/proc/sys/kernel"};

static const char *const network_paths[] = {
    "/etc/hosts",           "/etc/ssl/openssl.cnf", "/etc/host.conf",       "/etc/gai.conf",
    "/etc/hostname",        "/etc/resolv.conf",     "/etc/services",        "/etc/protocols",
    "/etc/passwd",          "/etc/nsswitch.conf",   "/etc/ssl/certs",       "/etc/ca-certificates",
    "/etc/pki/tls",         "/etc/pki/ca-trust",    "/etc/crypto-policies", "/etc/gnutls",
    "/run/systemd/resolve", "/run/resolvconf",      "/run/NetworkManager"};

struct rules {
    int fd;
    uint64_t handled, read;
};

/* A missing path needs no rule. */
static void allow(const struct rules *rules, const char *path, uint64_t rights) {
    struct stat file;
    int fd = *path == '/' ? open(path, O_PATH | O_CLOEXEC) : -1;
    if (fd < 0)
        return;
    if (!fstat(fd, &file) && !S_ISDIR(file.st_mode))
        rights &= OF_FILES;
    const struct beneath rule = {rights & rules->handled, fd};
    syscall(CALL_ADD, rules->fd, RULE_BENEATH, &rule, 0);
    close(fd);
}

static void allow_all(const struct rules *rules, const char *const *paths, size_t count) {
    for (size_t i = 0; i < count; i++)
        allow(rules, paths[i], rules->read);
}

static void allow_folder_of(const struct rules *rules, const char *path) {
    char folder[PATH_MAX];
    const char *end = strrchr(path, '/');
    if (!end || end == path || (size_t)snprintf(folder, sizeof folder, "%s", path) >= sizeof folder)
        return;
    folder[end - path] = '\0';
    allow(rules, folder, rules->read);
}

/* Folders in PATH. */
static void allow_search_path(const struct rules *rules) {
    char folder[PATH_MAX];
    for (const char *at = getenv("PATH"); at && *at; at += strcspn(at, ":"), at += *at == ':') {
        int length = (int)strcspn(at, ":");
        if ((size_t)snprintf(folder, sizeof folder, "%.*s", length, at) < sizeof folder)
            allow(rules, folder, rules->read);
    }
}

static void allow_what_it_needs(const struct rules *rules, const struct sandbox *s) {
    const struct plugin_needs *needs = s->needs;
    char real[PATH_MAX];
    allow_all(rules, common_paths, COUNT(common_paths));
    allow(rules, "/dev/null", READ_FILE | WRITE_FILE | TRUNCATE | CONTROL);
    allow(rules, "/dev/full", READ_FILE | WRITE_FILE | TRUNCATE);
    allow_folder_of(rules, s->plugin);
    if (realpath(s->plugin, real))
        allow_folder_of(rules, real);
    for (const char *at = needs->reads; needs->reads_size && at < needs->reads + needs->reads_size;
         at += strlen(at) + 1)
        allow(rules, at, rules->read);
    if (needs->capabilities & FACCIA_VOICE_NETWORK)
        allow_all(rules, network_paths, COUNT(network_paths));
    if (needs->capabilities & FACCIA_VOICE_PROGRAMS) {
        allow_all(rules, program_paths, COUNT(program_paths));
        allow_search_path(rules);
    }
    bool writes = needs->capabilities & FACCIA_VOICE_FILES;
    if (writes)
        allow(rules, "/tmp", rules->read | WRITE);
    for (size_t i = 0; i < s->path_count; i++)
        allow(rules, s->paths[i].path, rules->read | (writes && s->paths[i].write ? WRITE : 0));
}

/* The rights that a version of the interface supports. */
static struct ruleset ruleset_of(int version, uint32_t capabilities) {
    static const uint64_t unknown[] = {MOVE | TRUNCATE | CONTROL, TRUNCATE | CONTROL, CONTROL, CONTROL};
    struct ruleset set = {.files = EVERYTHING};
    if ((size_t)version <= COUNT(unknown))
        set.files &= ~unknown[version - 1];
    if (version >= 4 && !(capabilities & FACCIA_VOICE_NETWORK))
        set.network = NETWORK_TCP;
    if (version >= 6)
        set.scope = SCOPE_SIGNALS | (capabilities & FACCIA_VOICE_NETWORK ? 0 : SCOPE_SOCKETS);
    return set;
}

static int sandbox_files(const struct sandbox *s, char *why, size_t cap) {
    const uint32_t capabilities = s->needs->capabilities;
    long version = syscall(CALL_CREATE, NULL, 0, VERSION_ASKED);
    if (version < 1) {
        snprintf(why, cap, "no file restrictions (%s)", strerror(errno));
        return -1;
    }
    const struct ruleset set = ruleset_of((int)version, capabilities);
    struct rules rules = {.fd = (int)syscall(CALL_CREATE, &set, sizeof set, 0),
                          .handled = set.files,
                          .read = READ | (capabilities & FACCIA_VOICE_PROGRAMS ? EXECUTE : 0)};
    if (rules.fd >= 0)
        allow_what_it_needs(&rules, s);
    long result = rules.fd < 0 ? -1 : syscall(CALL_RESTRICT, rules.fd, 0);
    if (result)
        snprintf(why, cap, "no file restrictions (%s)", strerror(errno));
    if (rules.fd >= 0)
        close(rules.fd);
    return result ? -1 : 0;
}

/* Namespaces and the administrator's rights, and the sandbox as a whole. */

/* Maximum of processes and threads of a worker and its children. */
enum { TASKS_MAX = 512 };

static int write_file(const char *path, const char *text) {
    int fd = open(path, O_WRONLY | O_CLOEXEC);
    ssize_t n = fd < 0 ? -1 : write(fd, text, strlen(text));
    if (fd >= 0)
        close(fd);
    return n < 0 ? -1 : 0;
}

/* Before Linux 5.14 the limit counted all processes of the user, also outside the namespace. */
static void limit_tasks(void) {
    const struct rlimit tasks = {TASKS_MAX, TASKS_MAX};
    struct utsname system;
    unsigned major = 0, minor = 0;
    if (!uname(&system) && sscanf(system.release, "%u.%u", &major, &minor) == 2 &&
        (major > 5 || (major == 5 && minor >= 14)))
        setrlimit(RLIMIT_NPROC, &tasks);
}

/* Maps the user to itself, so that files keep their owner. */
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

/* Tries the namespaces in a child first: a process that could not keep its identity cannot leave them.
 * Returns an errno value, or 0. */
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
        snprintf(why, cap, "no namespaces (%s)", strerror(error));
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

/* Keeps libpulse, which espeak-ng loads, from looking for a sound server and logging each refusal. */
static void keep_quiet(void) {
    setenv("PULSE_SERVER", "unix:/dev/null", 1);
    setenv("PULSE_CLIENTCONFIG", "/dev/null", 1);
}

/* The order matters: entering namespaces writes to /proc/self, which is closed afterwards; Landlock opens
 * files for its rules; seccomp then refuses all of that. */
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
