/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/mem.h"
#include "server/normalize/text_rules_internal.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unicode/unum.h>
#include <unicode/ustring.h>

enum { DIGITS_MAX = 18, WORDS_UNITS = 1024 };

struct spellout {
    const json_t *forms; /* names of rule sets; CLDR's begin with "cldr:" */
    UNumberFormat *own, *cldr;
    char *digits[10];
};

static const char cldr_prefix[] = "cldr:";

static UNumberFormat *open_rules(const char *locale, const char *rules, UErrorCode *e, int *line) {
    UParseError place = {0};
    if (!rules)
        return unum_open(UNUM_SPELLOUT, NULL, 0, locale, &place, e);
    size_t cap = strlen(rules) + 1;
    UChar *pattern = mem_alloc(cap * sizeof *pattern);
    u_strFromUTF8(pattern, (int32_t)cap, NULL, rules, -1, e);
    UNumberFormat *format = unum_open(UNUM_PATTERN_RULEBASED, pattern, -1, locale, &place, e);
    *line = place.offset;
    free(pattern);
    return format;
}

/* Joins the rules in a file, a list of lines. */
static char *joined(const json_t *lines) {
    struct buf b = {0};
    for (size_t i = 0; i < json_array_size(lines); i++)
        buf_printf(&b, "%s\n", json_string_value(json_array_get(lines, i)));
    buf_add(&b, "", 1);
    return (char *)b.data;
}

struct spellout *spellout_new(const json_t *json, char *message, size_t cap) {
    UErrorCode e = U_ZERO_ERROR;
    int offset = 0;
    struct spellout *s = mem_alloc(sizeof *s);
    const char *locale = json_string_value(json_object_get(json, "locale"));
    s->forms = json_object_get(json, "forms");
    s->cldr = open_rules(locale, NULL, &e, &offset);
    if (json_object_get(json, "rules") && U_SUCCESS(e)) {
        char *rules = joined(json_object_get(json, "rules"));
        s->own = open_rules(locale, rules, &e, &offset);
        free(rules);
    }
    const char *name;
    json_t *form;
    bool known = U_SUCCESS(e);
    json_object_foreach((json_t *)s->forms, name, form) {
        struct buf out = {0};
        if (known && !spellout_whole(s, name, "1", &out)) {
            snprintf(message, cap, "no rule set \"%.60s\"", json_string_value(form));
            known = false;
        }
        buf_free(&out);
    }
    if (U_FAILURE(e))
        snprintf(message, cap, "%s at %d", u_errorName(e), offset);
    for (int i = 0; i < 10 && known; i++) {
        struct buf out = {0};
        const char digit[2] = {(char)('0' + i), '\0'};
        spellout_whole(s, "cardinal", digit, &out);
        s->digits[i] = mem_strndup((const char *)out.data, out.size);
        buf_free(&out);
    }
    if (known)
        return s;
    spellout_free(s);
    return NULL;
}

void spellout_free(struct spellout *s) {
    if (!s)
        return;
    if (s->own)
        unum_close(s->own);
    if (s->cldr)
        unum_close(s->cldr);
    for (int i = 0; i < 10; i++)
        free(s->digits[i]);
    free(s);
}

/* Removes the soft hyphens that CLDR puts into long words. */
static void add_words(struct buf *out, UChar *words, int32_t size) {
    int32_t kept = 0, bytes = 0;
    UErrorCode e = U_ZERO_ERROR;
    for (int32_t i = 0; i < size; i++)
        if (words[i] != 0xAD)
            words[kept++] = words[i];
    u_strToUTF8(buf_reserve(out, (size_t)kept * 3), kept * 3, &bytes, words, kept, &e);
    if (U_SUCCESS(e) || e == U_STRING_NOT_TERMINATED_WARNING)
        out->size += (size_t)bytes;
}

bool spellout_whole(struct spellout *s, const char *form, const char *digits, struct buf *out) {
    const char *rules = json_string_value(json_object_get(s->forms, form));
    char year[] = "20..";
    if (!strcmp(form, "year") && digits[0] == '0' && strlen(digits) == 2) { /* 4/14/05, '05 */
        memcpy(year + 2, digits, 2);
        digits = year;
    }
    digits += strspn(digits, "0");
    if (!rules || strlen(digits) > DIGITS_MAX)
        return false;
    bool cldr = !strncmp(rules, cldr_prefix, sizeof cldr_prefix - 1);
    UNumberFormat *format = cldr ? s->cldr : s->own;
    UChar name[128], words[WORDS_UNITS];
    UErrorCode e = U_ZERO_ERROR;
    u_uastrncpy(name, rules + (cldr ? sizeof cldr_prefix - 1 : 0), 127);
    if (!format)
        return false;
    unum_setTextAttribute(format, UNUM_DEFAULT_RULESET, name, -1, &e);
    int32_t size = unum_formatInt64(format, strtoll(digits, NULL, 10), words, WORDS_UNITS, NULL, &e);
    if (U_FAILURE(e) || size > WORDS_UNITS)
        return false;
    add_words(out, words, size);
    return true;
}

void spellout_digits(struct spellout *s, const char *digits, struct buf *out) {
    bool first = true;
    for (; *digits; digits++) {
        if (*digits < '0' || *digits > '9')
            continue;
        buf_printf(out, "%s%s", first ? "" : " ", s->digits[*digits - '0']);
        first = false;
    }
}
