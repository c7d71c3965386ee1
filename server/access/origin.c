/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/access/origin.h"
#include <arpa/inet.h>
#include <netinet/in.h>
#include <stddef.h>
#include <string.h>
#include <strings.h>

/* Returns what follows "://", or NULL. */
static const char *authority(const char *origin) {
    const char *at = strstr(origin, "://");
    return at ? at + 3 : NULL;
}

static bool is_local(const char *authority) {
    static const char *const names[] = {"localhost", "127.0.0.1", "[::1]"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        size_t n = strlen(names[i]);
        if (!strncasecmp(authority, names[i], n) && (!authority[n] || authority[n] == ':'))
            return true;
    }
    return false;
}

static bool matches(const char *origin, const char *pattern) {
    const char *star = strchr(pattern, '*');
    if (!star)
        return !strcasecmp(origin, pattern);
    if (!strcmp(pattern, "*"))
        return true;
    size_t before = (size_t)(star - pattern), after = strlen(star + 1), length = strlen(origin);
    if (length <= before + after || strncasecmp(origin, pattern, before) ||
        strcasecmp(origin + length - after, star + 1))
        return false;
    /* a star matches host names, not a port or a path */
    size_t starred = length - before - after;
    return !memchr(origin + before, ':', starred) && !memchr(origin + before, '/', starred);
}

bool origin_allowed(const char *origin, const char *host, char *const *list) {
    if (!origin || !*origin)
        return true;
    const char *from = authority(origin);
    if (from && host && !strcasecmp(from, host))
        return true;
    if (from && is_local(from))
        return true;
    for (; list && *list; list++)
        if (matches(origin, *list))
            return true;
    return false;
}

bool origin_unsaid_allowed(const char *site, const char *mode, const char *user, const char *dest) {
    bool followed =
        mode && !strcmp(mode, "navigate") && user && !strcmp(user, "?1") && dest && !strcmp(dest, "document");
    return !site || strcmp(site, "cross-site") || followed;
}

/* The host name alone: without brackets, port, and trailing dot. */
struct name {
    const char *text;
    size_t size; /* 0: not a valid name */
    bool bracketed;
};

static struct name name_of(const char *host) {
    struct name name = {.text = host, .bracketed = *host == '['};
    name.text += name.bracketed;
    name.size = strcspn(name.text, name.bracketed ? "]" : ":");
    const char *rest = name.text + name.size;
    if (name.bracketed && *rest == ']')
        rest++;
    else if (name.bracketed)
        name.size = 0;
    if (*rest && (*rest != ':' || rest[1 + strspn(rest + 1, "0123456789")]))
        name.size = 0;
    if (!name.bracketed && name.size && name.text[name.size - 1] == '.')
        name.size--;
    return name;
}

static bool same(struct name a, const char *other) {
    struct name b = name_of(other);
    return a.size == b.size && a.size && !strncasecmp(a.text, b.text, a.size);
}

enum address { ADDRESS_NONE, ADDRESS_LOOPBACK, ADDRESS_OTHER };

/* Accepts only the canonical form of an address; browsers convert all other forms to it (URL standard, 4.5).
 */
static enum address address_of(struct name name) {
    char text[64];
    struct in6_addr six;
    struct in_addr four;
    if (!name.size || name.size >= sizeof text)
        return ADDRESS_NONE;
    memcpy(text, name.text, name.size);
    text[name.size] = '\0';
    if (name.bracketed)
        return inet_pton(AF_INET6, text, &six) != 1 ? ADDRESS_NONE
               : IN6_IS_ADDR_LOOPBACK(&six)         ? ADDRESS_LOOPBACK
                                                    : ADDRESS_OTHER;
    if (inet_pton(AF_INET, text, &four) != 1)
        return ADDRESS_NONE;
    return ntohl(four.s_addr) >> 24 == IN_LOOPBACKNET ? ADDRESS_LOOPBACK : ADDRESS_OTHER;
}

static bool is_under_localhost(struct name name) {
    static const char suffix[] = ".localhost";
    size_t length = sizeof suffix - 1;
    return name.size > length && !strncasecmp(name.text + name.size - length, suffix, length);
}

bool host_allowed(const char *host, const char *own, char *const *names, bool local) {
    if (!host || !*host)
        return true;
    struct name name = name_of(host);
    enum address address = address_of(name);
    if (address == ADDRESS_LOOPBACK || same(name, "localhost") || is_under_localhost(name))
        return true;
    if (!local && (address == ADDRESS_OTHER || (own && same(name, own))))
        return true;
    for (; names && *names; names++)
        if (!strcmp(*names, "*") || same(name, *names))
            return true;
    return false;
}
