/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/voice/sandbox.h"
#include "server/voice/faccia-voice.h"
#include <stdio.h>
#include <sys/prctl.h>

#ifdef HAVE_SECCOMP
#include <errno.h>
#include <sched.h>
#include <seccomp.h>
#include <stdbool.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

/* The leak detector stops the process from a helper process, with ptrace. */
#if defined __SANITIZE_ADDRESS__ || defined __SANITIZE_THREAD__
static const bool watched = true;
#else
static const bool watched = false;
#endif

#define CALL(name) SCMP_SYS(name)

static const int foreign[] = {
    CALL(process_vm_readv),
    CALL(process_vm_writev),
    CALL(process_madvise),
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
    CALL(pidfd_send_signal),
};

static const uint64_t namespaces[] = {CLONE_NEWUSER, CLONE_NEWNS,  CLONE_NEWPID,   CLONE_NEWNET,
                                      CLONE_NEWIPC,  CLONE_NEWUTS, CLONE_NEWCGROUP};

/* The rest of the argument is flags. */
enum { SOCK_TYPE = 0xf };

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

static int refuse_foreign(scmp_filter_ctx filter) {
    int result = refuse_all(filter, foreign, sizeof foreign / sizeof *foreign);
    if (!result && !watched)
        result = refuse(filter, CALL(ptrace));
    if (!result)
        result = refuse_when(filter, CALL(ioctl), SCMP_A1(LOW(TIOCSTI)));
    if (!result)
        result = refuse_when(filter, CALL(prlimit64), SCMP_A0(SCMP_CMP_NE, 0));
    for (size_t i = 0; i < sizeof namespaces / sizeof *namespaces && !result; i++)
        result = refuse_when(filter, CALL(clone), SCMP_A0(SCMP_CMP_MASKED_EQ, namespaces[i], namespaces[i]));
    if (!result) /* its flags lie in memory, out of the filter's sight: everybody falls back to clone */
        result = seccomp_rule_add(filter, SCMP_ACT_ERRNO(ENOSYS), CALL(clone3), 0);
    return result;
}

static int refuse_programs(scmp_filter_ctx filter) {
    const uint64_t self = (uint64_t)getpid();
    int result = refuse_all(filter, programs, sizeof programs / sizeof *programs);
    if (!result && !watched) /* threads may be started */
        result = refuse_when(filter, CALL(clone), SCMP_A0(SCMP_CMP_MASKED_EQ, CLONE_THREAD, 0));
    if (!result)
        result = refuse_when(filter, CALL(kill), SCMP_A0(SCMP_CMP_NE, self));
    if (!result)
        result = refuse_when(filter, CALL(tgkill), SCMP_A0(SCMP_CMP_NE, self));
    return result;
}

/* A library that looks for the desktop's sound server (libpulse, which espeak-ng brings along) complains
 * where it gets no socket, and is content where nobody answers: it gets one that leads nowhere. */
static int refuse_network(scmp_filter_ctx filter) {
    static const int uses[] = {CALL(connect), CALL(bind), CALL(listen), CALL(accept), CALL(accept4)};
    static const int unconnected[] = {SOCK_DGRAM, SOCK_RAW, SOCK_SEQPACKET};
    int result = refuse_when(filter, CALL(socket), SCMP_A0(SCMP_CMP_NE, AF_UNIX));
    for (size_t i = 0; i < sizeof unconnected / sizeof *unconnected && !result; i++)
        result = refuse_when(filter, CALL(socket), SCMP_A1(SCMP_CMP_MASKED_EQ, SOCK_TYPE, unconnected[i]));
    return result ? result : refuse_all(filter, uses, sizeof uses / sizeof *uses);
}

static int load(scmp_filter_ctx filter, uint32_t capabilities) {
    /* A way round by another table of calls would be none: the x86's has the same rules. */
    int result = seccomp_attr_set(filter, SCMP_FLTATR_ACT_BADARCH, SCMP_ACT_ERRNO(ENOSYS));
    if (!result && seccomp_arch_native() == SCMP_ARCH_X86_64)
        result = seccomp_arch_add(filter, SCMP_ARCH_X86);
    if (!result) /* for the threads that run already, too */
        result = seccomp_attr_set(filter, SCMP_FLTATR_CTL_TSYNC, 1);
    if (!result)
        result = refuse_foreign(filter);
    if (!result && !(capabilities & FACCIA_VOICE_NETWORK))
        result = refuse_network(filter);
    if (!result && !(capabilities & FACCIA_VOICE_PROGRAMS))
        result = refuse_programs(filter);
    return result ? result : seccomp_load(filter);
}

int sandbox_enter(uint32_t capabilities, char *why, size_t cap) {
    scmp_filter_ctx filter = seccomp_init(SCMP_ACT_ALLOW);
    int result = filter ? load(filter, capabilities) : -ENOMEM;
    if (filter)
        seccomp_release(filter);
    if (!result)
        return 0;
    prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0);
    snprintf(why, cap, "the system refuses the filter: %s", strerror(-result));
    return -1;
}

#else

int sandbox_enter(uint32_t capabilities, char *why, size_t cap) {
    (void)capabilities;
    prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0);
    snprintf(why, cap, "this program was built without libseccomp");
    return -1;
}

#endif
