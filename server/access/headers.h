/* SPDX-License-Identifier: GPL-3.0-or-later */
/* HTTP response headers that restrict what browsers do with a response. */
#ifndef FACCIA_ACCESS_HEADERS_H
#define FACCIA_ACCESS_HEADERS_H

#include <stdbool.h>
#include <stddef.h>

enum { HEADERS_MOST = 8, HEADERS_POLICY = 2048 };

struct headers {
    struct {
        const char *name, *value;
    } list[HEADERS_MOST];
    size_t count;
    char policy[HEADERS_POLICY]; /* backing store of one value */
};

/* Sets the headers for a response of the given type. shared: any page may load it (a script, a model).
 * embed: origins whose pages may frame ours, NULL-terminated or NULL; "*" allows all. Entries that are not
 * origins are skipped. */
void headers_of(struct headers *headers, const char *type, bool shared, char *const *embed);

#endif
