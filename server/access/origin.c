/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/access/origin.h"
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
