/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Converts a text to words in a given way of reading. */
#include "server/normalize/normalizers_internal.h"
#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static bool is_digit(char c) {
    return c >= '0' && c <= '9';
}

/* Reads digit by digit, with a short pause between groups of digits. */
static bool read_digits(const struct normalizer *normalizer, const char *text, size_t longest,
                        struct buf *out) {
    size_t run = 0, before = out->size;
    const char *plus = normalizer_string(normalizer, "plus", NULL);
    if (*text == '+' && plus)
        buf_printf(out, "%s ", plus);
    for (const char *s = text; *s; s++) {
        if ((unsigned char)*s >= 0x80 || isalpha((unsigned char)*s)) {
            out->size = before;
            return false;
        }
        if (!is_digit(*s)) {
            run = run ? longest : 0; /* a pause, if more digits follow */
            continue;
        }
        if (run)
            buf_add(out, ", ", run >= longest ? 2 : 0);
        if (run && run < longest)
            buf_add(out, " ", 1);
        run = run >= longest ? 1 : run + 1;
        buf_add(out, s, 1);
    }
    if (run)
        return true;
    out->size = before;
    return false;
}

/* Reads only plain numbers and Roman numerals. */
static bool read_cardinal(const struct normalizer *normalizer, const char *text, struct buf *out) {
    struct number n;
    size_t sign = *text == '-' || *text == '+',
           used = normalizer ? number_read(normalizer, text + sign, &n) : 0;
    if (!used || text[sign + used]) {
        if (!number_roman(text, &n))
            return false;
        sign = 0;
    }
    buf_add(out, text, sign);
    if (normalizer)
        number_write(normalizer, &n, out);
    else
        buf_printf(out, "%s", n.whole);
    return true;
}

bool normalize_fraction(const struct normalizer *normalizer, const char *text, struct buf *out) {
    struct number top, bottom;
    size_t used = number_read(normalizer, text, &top);
    const char *s = text + used + strspn(text + used, " ");
    size_t slash = *s == '/' ? 1 : !strncmp(s, "\u2044", 3) ? 3 : 0;
    s += slash + strspn(s + slash, " ");
    size_t end = used && slash ? number_read(normalizer, s, &bottom) : 0;
    if (!end || s[end] || *top.decimals || *bottom.decimals)
        return false;
    const json_t *part = json_object_get(json_object_get(normalizer->root, "parts"), bottom.whole);
    const char *form = normalizer_form(part, number_is_one(&top));
    const char *const values[] = {"n", top.whole, "d", form ? form : bottom.whole, NULL};
    template_fill(out, form ? "{n} {d}" : normalizer_string(normalizer, "fraction", NULL), values);
    return true;
}

static bool fits(const struct normalizer *normalizer, const json_t *signs, const char *code, const char *s,
                 size_t length) {
    (void)normalizer;
    for (size_t i = 0; i < json_array_size(signs); i++) {
        const char *sign = json_string_value(json_array_get(signs, i));
        if (strlen(sign) == length && !memcmp(sign, s, length))
            return true;
    }
    return strlen(code) == length && !memcmp(code, s, length);
}

/* Reads "€ 12,50" or "12.50 EUR": the hundredths become a second amount with its own unit. */
bool normalize_currency(const struct normalizer *normalizer, const char *text, struct buf *out) {
    struct number n;
    size_t before = strcspn(text, "0123456789"), length = before;
    size_t used = number_read(normalizer, text + before, &n), at = before + used;
    at += strspn(text + at, " ");
    while (length && text[length - 1] == ' ')
        length--;
    if (!used || (length && text[at]) || (!length && !text[at]) || strlen(n.decimals) > 2)
        return false;
    const char *sign = length ? text : text + at, *code;
    json_t *currency;
    json_object_foreach(json_object_get(normalizer->root, "currencies"), code, currency) {
        if (!fits(normalizer, json_object_get(currency, "signs"), code, sign, length ? length : strlen(sign)))
            continue;
        struct number cents = {0};
        snprintf(cents.whole, sizeof cents.whole, "%d",
                 atoi(n.decimals) * (strlen(n.decimals) == 1 ? 10 : 1));
        bool small = strcmp(cents.whole, "0") != 0, large = n.whole[strspn(n.whole, "0")] || !small;
        if (large)
            buf_printf(out, "%s %s", n.whole,
                       normalizer_form(json_object_get(currency, "name"),
                                       strspn(n.whole, "0") + 1 == strlen(n.whole) &&
                                           n.whole[strlen(n.whole) - 1] == '1'));
        if (small)
            buf_printf(out, "%s%s%s%s %s", large ? " " : "",
                       large ? normalizer_string(normalizer, "and", NULL) : "", large ? " " : "", cents.whole,
                       normalizer_form(json_object_get(currency, "cent"), number_is_one(&cents)));
        return true;
    }
    return false;
}

bool normalize_measure(const struct normalizer *normalizer, const char *text, struct buf *out) {
    struct number n;
    size_t sign = *text == '-', used = number_read(normalizer, text + sign, &n), at = sign + used;
    at += strspn(text + at, " ");
    const json_t *unit = used ? json_object_get(json_object_get(normalizer->root, "units"), text + at) : NULL;
    if (!unit)
        return false;
    buf_add(out, text, sign);
    number_write(normalizer, &n, out);
    buf_printf(out, " %s", normalizer_form(unit, number_is_one(&n)));
    return true;
}

/* Replaces signs by their names; the rest are words. */
static bool read_net(const struct normalizer *normalizer, const char *text, struct buf *out) {
    for (const char *s = text; *s; s++) {
        const char one[2] = {*s, '\0'}, *name = normalizer_string(normalizer, "net", one);
        if (name)
            buf_printf(out, "%s%s%s", s > text ? " " : "", name, s[1] ? " " : "");
        else
            buf_add(out, s, 1);
    }
    return true;
}

bool normalizer_words(const struct normalizer *normalizer, const char *way, const char *text,
                      struct buf *out) {
    const char *format = strchr(way, ':');
    size_t length = format ? (size_t)(format - way) : strlen(way);
    format = format ? format + 1 : "";
    char kind[16];
    snprintf(kind, sizeof kind, "%.*s", (int)length, way);
    if (!strcmp(kind, "digits"))
        return read_digits(normalizer, text, SIZE_MAX, out);
    if (!strcmp(kind, "telephone"))
        return read_digits(normalizer, text, 3, out);
    if (!strcmp(kind, "cardinal"))
        return read_cardinal(normalizer, text, out);
    if (!strcmp(kind, "name") || !strcmp(kind, "address")) {
        buf_add(out, text, strlen(text));
        return true;
    }
    if (!normalizer)
        return false;
    if (!strcmp(kind, "ordinal"))
        return normalize_ordinal(normalizer, text, out);
    if (!strcmp(kind, "fraction"))
        return normalize_fraction(normalizer, text, out);
    if (!strcmp(kind, "date"))
        return normalize_date(normalizer, format, text, out);
    if (!strcmp(kind, "time"))
        return normalize_time(normalizer, format, text, out);
    if (!strcmp(kind, "duration"))
        return normalize_duration(normalizer, text, out);
    if (!strcmp(kind, "currency"))
        return normalize_currency(normalizer, text, out);
    if (!strcmp(kind, "measure"))
        return normalize_measure(normalizer, text, out);
    return !strcmp(kind, "net") && read_net(normalizer, text, out);
}
