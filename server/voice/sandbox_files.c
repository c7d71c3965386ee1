/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which files a worker may read and write: Landlock, as much of it as the kernel has. Also no signals to
 * processes outside and, without FACCIA_VOICE_NETWORK, no connections. */
#include "server/voice/sandbox_internal.h"
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

/* The kernel's interface, of which a system's header may know a part only. */
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
    MOVE = 1 << 13,     /* between folders; version 2 */
    TRUNCATE = 1 << 14, /* version 3 */
    CONTROL = 1 << 15,  /* ioctl of devices; version 5 */
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

/* The system's programs and libraries with their data, and what a C library asks for. */
static const char *const everybody[] = {"/usr",
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

/* What programs and their interpreters look for besides. */
static const char *const programs[] = {
    "/etc/passwd",     "/etc/group",      "/etc/nsswitch.conf",   "/etc/festival.scm", "/etc/festival",
    "/etc/mime.types", "/etc/os-release", "/etc/ssl/openssl.cnf", "/etc/java",         "/etc/perl",
    "/etc/python3",    "/etc/python3.9",  "/etc/python3.10",      "/etc/python3.11",   "/etc/python3.12",
    "/etc/python3.13", "/etc/inputrc",    "/etc/ImageMagick",     "/proc/version",     "/proc/sys/kernel"};

static const char *const network[] = {
    "/etc/hosts",           "/etc/ssl/openssl.cnf", "/etc/host.conf",       "/etc/gai.conf",
    "/etc/hostname",        "/etc/resolv.conf",     "/etc/services",        "/etc/protocols",
    "/etc/passwd",          "/etc/nsswitch.conf",   "/etc/ssl/certs",       "/etc/ca-certificates",
    "/etc/pki/tls",         "/etc/pki/ca-trust",    "/etc/crypto-policies", "/etc/gnutls",
    "/run/systemd/resolve", "/run/resolvconf",      "/run/NetworkManager"};

#define COUNT(list) (sizeof(list) / sizeof *(list))

struct rules {
    int fd;
    uint64_t handled, read;
};

/* What is not there needs no rule. */
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

/* Where programs are looked for. */
static void allow_search_path(const struct rules *rules) {
    char folder[PATH_MAX];
    for (const char *at = getenv("PATH"); at && *at; at += strcspn(at, ":"), at += *at == ':') {
        int length = (int)strcspn(at, ":");
        if ((size_t)snprintf(folder, sizeof folder, "%.*s", length, at) < sizeof folder)
            allow(rules, folder, rules->read);
    }
}

static void allow_what_it_needs(const struct rules *rules, const struct sandbox *s) {
    const struct needs *needs = s->needs;
    char real[PATH_MAX];
    allow_all(rules, everybody, COUNT(everybody));
    allow(rules, "/dev/null", READ_FILE | WRITE_FILE | TRUNCATE | CONTROL);
    allow(rules, "/dev/full", READ_FILE | WRITE_FILE | TRUNCATE);
    allow_folder_of(rules, s->plugin);
    if (realpath(s->plugin, real))
        allow_folder_of(rules, real);
    for (const char *at = needs->reads; needs->reads_size && at < needs->reads + needs->reads_size;
         at += strlen(at) + 1)
        allow(rules, at, rules->read);
    if (needs->capabilities & FACCIA_VOICE_NETWORK)
        allow_all(rules, network, COUNT(network));
    if (needs->capabilities & FACCIA_VOICE_PROGRAMS) {
        allow_all(rules, programs, COUNT(programs));
        allow_search_path(rules);
    }
    bool writes = needs->capabilities & FACCIA_VOICE_FILES;
    if (writes)
        allow(rules, "/tmp", rules->read | WRITE);
    for (size_t i = 0; i < s->path_count; i++)
        allow(rules, s->paths[i].path, rules->read | (writes && s->paths[i].write ? WRITE : 0));
}

/* The rights that versions 1, 2... of the interface know. */
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

int sandbox_files(const struct sandbox *s, char *why, size_t cap) {
    const uint32_t capabilities = s->needs->capabilities;
    long version = syscall(CALL_CREATE, NULL, 0, VERSION_ASKED);
    if (version < 1) {
        snprintf(why, cap, "no rules for files (%s)", strerror(errno));
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
        snprintf(why, cap, "no rules for files (%s)", strerror(errno));
    if (rules.fd >= 0)
        close(rules.fd);
    return result ? -1 : 0;
}
