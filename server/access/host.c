/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/access/host.h"
#include <arpa/inet.h>
#include <stddef.h>
#include <string.h>
#include <strings.h>

/* The bytes of the name alone: without brackets, the port, and the dot of the root. */
struct name {
    const char *text;
    size_t size; /* 0: it is none */
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

/* As browsers write it: they turn every other form into this one (URL standard, 4.5). */
static bool is_address(struct name name) {
    char text[64];
    struct in6_addr address;
    if (!name.size || name.size >= sizeof text)
        return false;
    memcpy(text, name.text, name.size);
    text[name.size] = '\0';
    return inet_pton(name.bracketed ? AF_INET6 : AF_INET, text, &address) == 1;
}

static bool is_under_localhost(struct name name) {
    static const char suffix[] = ".localhost";
    size_t length = sizeof suffix - 1;
    return name.size > length && !strncasecmp(name.text + name.size - length, suffix, length);
}

bool host_allowed(const char *host, const char *own, char *const *names) {
    if (!host || !*host)
        return true;
    struct name name = name_of(host);
    if (is_address(name) || same(name, "localhost") || is_under_localhost(name) || (own && same(name, own)))
        return true;
    for (; names && *names; names++)
        if (!strcmp(*names, "*") || same(name, *names))
            return true;
    return false;
}
