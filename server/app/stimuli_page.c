/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/app/stimuli_page.h"
#include <string.h>
#include <strings.h>

/* In scripts and in JSON "<" may be written as an escape wherever "</" or "<!--" can stand: inside of
 * strings. */
static void add_script(struct buf *out, const struct buf *script) {
    for (size_t i = 0; i < script->size; i++) {
        const char *at = (const char *)script->data + i;
        size_t rest = script->size - i;
        if ((rest >= 8 && !strncasecmp(at, "</script", 8)) || (rest >= 4 && !memcmp(at, "<!--", 4)) ||
            (rest >= 7 && !strncasecmp(at, "<script", 7)))
            buf_add(out, "\\u003c", 6);
        else
            buf_add(out, at, 1);
    }
}

void stimuli_page(const struct buf *template, const struct buf *data, const struct buf *bundle,
                  struct buf *out) {
    static const char data_place[] = "{{data}}", bundle_place[] = "{{bundle}}";
    for (size_t i = 0; i < template->size;) {
        const char *at = (const char *)template->data + i;
        size_t rest = template->size - i;
        if (rest >= sizeof data_place - 1 && !memcmp(at, data_place, sizeof data_place - 1)) {
            add_script(out, data);
            i += sizeof data_place - 1;
        } else if (rest >= sizeof bundle_place - 1 && !memcmp(at, bundle_place, sizeof bundle_place - 1)) {
            add_script(out, bundle);
            i += sizeof bundle_place - 1;
        } else {
            buf_add(out, at, 1);
            i++;
        }
    }
}
