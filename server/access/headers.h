/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What browsers are told to do with an answer. */
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
    char policy[HEADERS_POLICY]; /* behind one of the values */
};

/* For an answer of that type. shared: any page may have it (a script, a model). embed: origins whose pages
 * may frame ours, NULL-terminated or NULL; "*" stands for all. What is not an origin in that list is left
 * out. */
void headers_of(struct headers *headers, const char *type, bool shared, char *const *embed);

#endif
