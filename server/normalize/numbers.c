/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/normalize/normalizers_internal.h"
#include <ctype.h>
#include <stdio.h>
#include <string.h>

static bool is_digit(char c) {
    return c >= '0' && c <= '9';
}

/* True for exactly three digits, as after a grouping separator. */
static bool is_group(const char *s) {
    return is_digit(s[0]) && is_digit(s[1]) && is_digit(s[2]) && !is_digit(s[3]);
}

size_t number_read(const struct normalizer *normalizer, const char *text, struct number *number) {
    size_t at = 0, whole = 0, decimals = 0;
    *number = (struct number){0};
    for (;; at++) {
        bool group = at && (text[at] == normalizer->thousands || text[at] == '\'') && is_group(text + at + 1);
        if (group)
            continue;
        if (!is_digit(text[at]))
            break;
        if (whole + 1 == sizeof number->whole)
            return 0;
        number->whole[whole++] = text[at];
    }
    if (!whole)
        return 0;
    bool point = text[at] == normalizer->decimal || (text[at] == '.' && !is_group(text + at + 1));
    if (!point || !is_digit(text[at + 1]))
        return at;
    for (at++; is_digit(text[at]); at++) {
        if (decimals + 1 == sizeof number->decimals)
            return 0;
        number->decimals[decimals++] = text[at];
    }
    return at;
}

bool number_roman(const char *text, struct number *number) {
    static const struct {
        const char *digits;
        unsigned value;
    } steps[] = {{"M", 1000}, {"CM", 900}, {"D", 500}, {"CD", 400}, {"C", 100}, {"XC", 90}, {"L", 50},
                 {"XL", 40},  {"X", 10},   {"IX", 9},  {"V", 5},    {"IV", 4},  {"I", 1}};
    unsigned value = 0;
    const char *s = text;
    for (size_t i = 0; i < sizeof steps / sizeof *steps; i++) {
        size_t length = strlen(steps[i].digits),
               most = length == 1 && strchr("MCXI", *steps[i].digits) ? 3 : 1;
        for (; most && !strncmp(s, steps[i].digits, length); most--, s += length)
            value += steps[i].value;
    }
    *number = (struct number){0};
    snprintf(number->whole, sizeof number->whole, "%u", value);
    return value && !*s;
}

void number_write(const struct normalizer *normalizer, const struct number *number, struct buf *out) {
    buf_printf(out, "%s", number->whole);
    if (*number->decimals)
        buf_printf(out, "%c%s", normalizer->decimal, number->decimals);
}

bool number_is_one(const struct number *number) {
    return !*number->decimals && !strcmp(number->whole + strspn(number->whole, "0"), "1");
}
