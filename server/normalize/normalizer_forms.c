/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Shared by all ways of reading: strings and forms of a language file, its templates and ordinals. */
#include "server/normalize/normalizers_internal.h"
#include <stdlib.h>
#include <string.h>

const char *normalizer_string(const struct normalizer *normalizer, const char *member, const char *name) {
    const json_t *object = normalizer ? json_object_get(normalizer->root, member) : NULL;
    return json_string_value(name ? json_object_get(object, name) : object);
}

const char *normalizer_form(const json_t *forms, bool one) {
    return json_string_value(json_array_get(forms, !one));
}

void template_fill(struct buf *out, const char *template, const char *const *values) {
    for (const char *s = template; *s;) {
        size_t length = *s == '{' ? strcspn(s, "}") : 0;
        const char *const *v = values;
        while (length && *v && (strlen(*v) != length - 1 || strncmp(*v, s + 1, length - 1) != 0))
            v += 2;
        if (length && *v) {
            buf_add(out, v[1], strlen(v[1]));
            s += length + (s[length] == '}');
        } else {
            buf_add(out, s++, 1);
        }
    }
}

bool normalize_ordinal(const struct normalizer *normalizer, const char *text, struct buf *out) {
    struct number n;
    size_t used = number_read(normalizer, text, &n);
    const char *rest = text + used;
    if (used ? *n.decimals || strlen(rest) > 4 || strpbrk(rest, "0123456789") : !number_roman(text, &n))
        return false;
    const json_t *ordinal = json_object_get(normalizer->root, "ordinal");
    const char *word =
        json_string_value(json_array_get(json_object_get(ordinal, "words"), strtoul(n.whole, NULL, 10) - 1));
    if (word && strlen(n.whole) < 4) {
        buf_printf(out, "%s", word);
        return true;
    }
    const json_t *rules = json_object_get(ordinal, "rules");
    size_t length = strlen(n.whole);
    for (size_t i = 0; i < json_array_size(rules); i++) {
        const json_t *rule = json_array_get(rules, i);
        const char *ending = json_string_value(json_array_get(rule, 0));
        if (strlen(ending) > length || strcmp(n.whole + length - strlen(ending), ending) != 0)
            continue;
        const char *const values[] = {"n", n.whole, NULL};
        template_fill(out, json_string_value(json_array_get(rule, 1)), values);
        return true;
    }
    return false;
}
