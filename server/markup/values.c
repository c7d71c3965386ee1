/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Parses attribute values: words from a list, numbers with units. */
#include "server/markup/markup_reader.h"
#include "server/markup/white.h"
#include <string.h>
#include <strings.h>

const struct choice *choice_find(const struct choice *choices, size_t count, const char *name) {
    while (is_white(*name))
        name++;
    size_t length = strlen(name);
    while (length && is_white(name[length - 1]))
        length--;
    for (size_t i = 0; i < count; i++)
        if (strlen(choices[i].name) == length && !strncasecmp(choices[i].name, name, length))
            return &choices[i];
    return NULL;
}

static bool is_digit(char c) {
    return c >= '0' && c <= '9';
}

bool quantity_read(const char *s, struct quantity *q) {
    *q = (struct quantity){0};
    double sign = 1, place = 1;
    while (is_white(*s))
        s++;
    if (*s == '+' || *s == '-') {
        q->relative = true;
        sign = *s++ == '-' ? -1 : 1;
    }
    if (!is_digit(*s) && !(*s == '.' && is_digit(s[1])))
        return false;
    for (; is_digit(*s); s++)
        q->number = q->number < 1e12 ? q->number * 10 + (*s - '0') : q->number;
    if (*s == '.')
        for (s++; is_digit(*s); s++)
            q->number += (*s - '0') * (place /= 10);
    q->number *= sign;
    while (is_white(*s))
        s++;
    size_t n = 0;
    for (; *s && !is_white(*s) && n < sizeof q->unit - 1; s++)
        q->unit[n++] = *s >= 'A' && *s <= 'Z' ? (char)(*s | 32) : *s;
    while (is_white(*s))
        s++;
    return !*s;
}

bool quantity_seconds(const char *text, double unit, double *seconds) {
    static const struct choice units[] = {
        {"s", 1}, {"sec", 1}, {"ms", 0.001}, {"msec", 0.001}, {"msecs", 0.001}};
    struct quantity q;
    if (!quantity_read(text, &q))
        return false;
    if (*q.unit) {
        const struct choice *known = choice_find(units, sizeof units / sizeof *units, q.unit);
        if (!known)
            return false;
        unit = known->value;
    }
    *seconds = q.number * unit;
    return true;
}

bool quantity_plain(const char *text, double min, double max, double *number) {
    struct quantity q;
    if (!quantity_read(text, &q) || *q.unit || q.number < min || q.number > max)
        return false;
    *number = q.number;
    return true;
}
