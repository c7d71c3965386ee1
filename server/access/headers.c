/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/access/headers.h"
#include <stdio.h>
#include <string.h>

/* A page loads scripts, styles, pictures and worklets from here only, and nothing inline (Content Security
 * Policy, level 3). Its Opus decoder is WebAssembly. A video may be a file that the user has chosen
 * (blob:, created by the page): it is played, and runs no code. */
static const char page_policy[] =
    "default-src 'none'; script-src 'self' 'wasm-unsafe-eval'; style-src 'self'; "
    "img-src 'self' data:; media-src 'self' blob:; connect-src 'self'; manifest-src 'self'; base-uri 'none'; "
    "form-action 'none'; "
    "require-trusted-types-for 'script'; frame-ancestors";

/* A response that is not a page loads nothing, even if a browser takes it for one. */
static const char other_policy[] = "default-src 'none'; frame-ancestors 'none'";

/* For scripts: a service worker obeys the policy of its own response (Service Workers, 4.2), and ours caches
 * files from this server. */
static const char script_policy[] = "default-src 'none'; connect-src 'self'; frame-ancestors 'none'";

static void add(struct headers *h, const char *name, const char *value) {
    h->list[h->count].name = name;
    h->list[h->count++].value = value;
}

/* Returns whether the origin contains nothing that would end a directive or a header. */
static bool is_source(const char *origin) {
    return *origin && !origin[strcspn(origin, " \t\r\n;,'\"")];
}

static bool is_page(const char *type) {
    return !strncmp(type, "text/html", 9);
}

static void add_page(struct headers *h, char *const *embed) {
    bool framed = embed && *embed;
    size_t used =
        (size_t)snprintf(h->policy, sizeof h->policy, "%s %s", page_policy, framed ? "'self'" : "'none'");
    for (; embed && *embed; embed++)
        if (is_source(*embed) && used + strlen(*embed) + 2 < sizeof h->policy)
            used += (size_t)snprintf(h->policy + used, sizeof h->policy - used, " %s", *embed);
    add(h, "content-security-policy", h->policy);
    if (!framed)
        add(h, "x-frame-options", "DENY"); /* the same for old browsers */
}

void headers_of(struct headers *h, const char *type, bool shared, char *const *embed) {
    h->count = 0;
    add(h, "x-content-type-options", "nosniff");
    add(h, "referrer-policy", "no-referrer");
    add(h, "cross-origin-resource-policy", shared ? "cross-origin" : "same-origin");
    if (is_page(type))
        add_page(h, embed);
    else if (!strncmp(type, "text/javascript", 15))
        add(h, "content-security-policy", script_policy);
    else
        add(h, "content-security-policy", other_policy);
}
