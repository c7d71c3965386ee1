/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/lang.h"
#include <stddef.h>
#include <string.h>
#include <strings.h>

const char *lang_usual(const char *tag) {
    static const char *const tags[][2] = {{"zh-HK", "yue"}, {"zh-MO", "yue"}, {"zh", "cmn"}, {"no", "nb"},
                                          {"nn", "nb"},     {"sh", "hr"},     {"iw", "he"},  {"in", "id"}};
    for (size_t i = 0; i < sizeof tags / sizeof *tags; i++) {
        size_t length = strlen(tags[i][0]);
        if (!strncasecmp(tag, tags[i][0], length) && (!tag[length] || tag[length] == '-'))
            return tags[i][1];
    }
    return tag;
}
