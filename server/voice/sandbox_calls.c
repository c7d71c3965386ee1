/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The system calls that a worker is refused (seccomp). Always: reaching into other processes, mounts,
 * namespaces, the kernel's and the machine's settings, limits and priorities of other processes, keyrings,
 * io_uring (it goes round filters), typing into a terminal, signals to the daemon by whatever way. More
 * without the capabilities. What a filter cannot see, as it lies in memory, is refused whole. */
#include "server/voice/sandbox_internal.h"
#include <stdio.h>

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

static const int foreign[] = {
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

static const int programs[] = {
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

/* What changes files otherwise than through a descriptor: partly beyond Landlock's sight. */
static const int files[] = {
    CALL(chmod),        CALL(fchmod),       CALL(fchmodat),  CALL(chown),     CALL(fchown),
    CALL(lchown),       CALL(fchownat),     CALL(utime),     CALL(utimes),    CALL(utimensat),
    CALL(futimesat),    CALL(setxattr),     CALL(lsetxattr), CALL(fsetxattr), CALL(removexattr),
    CALL(lremovexattr), CALL(fremovexattr), CALL(truncate),  CALL(rename),    CALL(renameat),
    CALL(renameat2),    CALL(link),         CALL(linkat),    CALL(symlink),   CALL(symlinkat),
    CALL(unlink),       CALL(unlinkat),     CALL(mkdir),     CALL(mkdirat),   CALL(rmdir),
    CALL(mknod),        CALL(mknodat),      CALL(creat),
};

/* Younger than the library: fchmodat2, setxattrat, removexattrat, open_tree_attr, file_setattr. The numbers
 * are the same on all machines. */
static const int young[] = {452, 463, 466, 467, 469};

static const uint64_t namespaces[] = {CLONE_NEWUSER, CLONE_NEWNS,  CLONE_NEWPID,   CLONE_NEWNET,
                                      CLONE_NEWIPC,  CLONE_NEWUTS, CLONE_NEWCGROUP};

/* The rest of the argument is flags. */
enum { SOCK_TYPE = 0xf };

/* ioctl's ways to choose who gets a descriptor's signals, and to type. */
static const uint64_t controls[] = {TIOCSTI, TIOCLINUX, FIOSETOWN, SIOCSPGRP};

/* The kernel reads 32 bits of these arguments. */
#define LOW(bits) SCMP_CMP_MASKED_EQ, 0xffffffffu, (bits)
#define COUNT(list) (sizeof(list) / sizeof *(list))

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

/* Priorities of others, and of all that the user has. */
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

/* Signals that the kernel sends for a descriptor go to anybody who is named as its owner. */
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
    int result = refuse_all(filter, foreign, COUNT(foreign));
    if (!result && !SANDBOX_WATCHED)
        result = refuse(filter, CALL(ptrace));
    if (!result)
        result = refuse_when(filter, CALL(prlimit64), SCMP_A0(SCMP_CMP_NE, 0));
    for (size_t i = 0; i < COUNT(namespaces) && !result; i++)
        result = refuse_when(filter, CALL(clone), SCMP_A0(SCMP_CMP_MASKED_EQ, namespaces[i], namespaces[i]));
    if (!result) /* its flags lie in memory, out of the filter's sight: everybody falls back to clone */
        result = seccomp_rule_add(filter, SCMP_ACT_ERRNO(ENOSYS), CALL(clone3), 0);
    if (!result) /* likewise */
        result = seccomp_rule_add(filter, SCMP_ACT_ERRNO(ENOSYS), CALL(openat2), 0);
    if (!result)
        result = refuse_priorities(filter);
    return result ? result : refuse_owners(filter);
}

/* Of the processes in reach the daemon is the one that must live. */
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
    if (!result) /* everybody */
        result = refuse_when(filter, CALL(kill), SCMP_A0(LOW(UINT32_MAX)));
    if (!result) /* its group */
        result = refuse_when(filter, CALL(kill), SCMP_A0(LOW((uint32_t)-getpgid(daemon))));
    return result;
}

static int refuse_programs(scmp_filter_ctx filter) {
    static const int others[] = {CALL(sched_setaffinity), CALL(sched_setscheduler), CALL(sched_setparam),
                                 CALL(sched_setattr)};
    const uint64_t self = (uint64_t)getpid(), thread = CLONE_THREAD | (SANDBOX_WATCHED ? CLONE_UNTRACED : 0);
    int result = refuse_all(filter, programs, COUNT(programs));
    if (!result) /* threads may be started, and the leak detector's helper */
        result = refuse_when(filter, CALL(clone), SCMP_A0(SCMP_CMP_MASKED_EQ, thread, 0));
    if (!result)
        result = refuse_when(filter, CALL(kill), SCMP_A0(SCMP_CMP_NE, self));
    if (!result)
        result = refuse_when(filter, CALL(tgkill), SCMP_A0(SCMP_CMP_NE, self));
    for (size_t i = 0; i < COUNT(others) && !result; i++)
        result = refuse_when(filter, others[i], SCMP_A0(SCMP_CMP_NE, 0));
    if (!result && !SANDBOX_WATCHED) /* it ends with the daemon */
        result = refuse_when(filter, CALL(prctl), SCMP_A0(LOW(PR_SET_PDEATHSIG)));
    return result;
}

/* Reading that empties the file is writing. */
static int refuse_files(scmp_filter_ctx filter) {
    const struct scmp_arg_cmp of_open = SCMP_A1(SCMP_CMP_MASKED_EQ, O_TRUNC | O_ACCMODE, O_TRUNC);
    const struct scmp_arg_cmp of_openat = SCMP_A2(SCMP_CMP_MASKED_EQ, O_TRUNC | O_ACCMODE, O_TRUNC);
    int result = refuse_all(filter, files, COUNT(files));
    if (!result)
        result = refuse_when(filter, CALL(open), of_open);
    if (!result)
        result = refuse_when(filter, CALL(openat), of_openat);
    return result;
}

/* A library that looks for the desktop's sound server (libpulse, which espeak-ng brings along) complains
 * where it gets no socket, and is content where nobody answers: it gets one that leads nowhere. Sockets that
 * could send to any address, pairs of them too, are none of a plugin's. */
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

/* Programs may be of 32 bits; otherwise the other table of calls, where sockets are arguments in memory, is
 * closed. */
static int load(scmp_filter_ctx filter, uint32_t capabilities, pid_t daemon) {
    const bool runs = capabilities & FACCIA_VOICE_PROGRAMS;
    const bool writes = capabilities & FACCIA_VOICE_FILES;
    int result = seccomp_attr_set(filter, SCMP_FLTATR_ACT_BADARCH, SCMP_ACT_ERRNO(ENOSYS));
    if (!result && !writes) /* before there is a second table, for which the library would want their names */
        result = refuse_all(filter, young, COUNT(young));
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

int sandbox_calls(uint32_t capabilities, pid_t daemon, char *why, size_t cap) {
    scmp_filter_ctx filter = seccomp_init(SCMP_ACT_ALLOW);
    int result = filter ? load(filter, capabilities, daemon) : -ENOMEM;
    if (filter)
        seccomp_release(filter);
    if (!result)
        return 0;
    snprintf(why, cap, "no filter of system calls (%s)", strerror(-result));
    return -1;
}

#else

int sandbox_calls(uint32_t capabilities, pid_t daemon, char *why, size_t cap) {
    (void)capabilities, (void)daemon;
    snprintf(why, cap, "no filter of system calls (built without libseccomp)");
    return -1;
}

#endif
