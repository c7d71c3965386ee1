/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/lang.h"
#include <stddef.h>
#include <string.h>
#include <strings.h>

static bool is_letter(char c) {
    return (c | 32) >= 'a' && (c | 32) <= 'z';
}

bool lang_is_tag(const char *s, size_t n, size_t *bad) {
    enum { SUBTAG = 8 };
    size_t at = 0, from = 0;
    for (; at < n && at < LANG_BYTES; at++) {
        bool first = !from, single = at == from + 1 && ((s[from] | 32) == 'x' || (s[from] | 32) == 'i');
        if (s[at] == '-' && at > from && (!first || at > 1 || single) && at + 1 < n)
            from = at + 1;
        else if (!(is_letter(s[at]) || (!first && s[at] >= '0' && s[at] <= '9')) || at - from == SUBTAG)
            break;
    }
    *bad = at;
    return at == n && n > 1;
}

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
