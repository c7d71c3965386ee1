/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Dates, times of day and durations. */
#include "server/normalize/normalizers_internal.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

enum { FIELDS = 3 };

/* Parses one to three numbers of up to four digits, separated by the given characters. Returns their
 * count; 0 if anything else is found. *rest is the remaining text; rest = NULL allows none. */
static size_t numbers(const char *text, const char *separators, unsigned out[FIELDS], size_t digits[FIELDS],
                      const char **rest) {
    size_t count = 0;
    const char *s = text;
    for (;;) {
        digits[count] = strspn(s, "0123456789");
        if (!digits[count] || digits[count] > 4)
            return 0;
        out[count] = (unsigned)strtoul(s, NULL, 10);
        s += digits[count++];
        size_t between = strspn(s, separators);
        if (count == FIELDS || !between || s[between] < '0' || s[between] > '9')
            break;
        s += between;
    }
    if (rest)
        *rest = s + strspn(s, " ");
    return *s && !rest ? 0 : count;
}

/* Parses "20240312" in the given field order: four digits for the year, two for other fields. */
static size_t run_together(const char *text, const char *order, unsigned out[FIELDS], size_t digits[FIELDS]) {
    size_t at = 0, count = 0;
    if (strspn(text, "0123456789") != strlen(text))
        return 0;
    for (; order[count] && count < FIELDS; count++) {
        char field[5] = "";
        digits[count] = order[count] == 'y' ? 4 : 2;
        if (strlen(text) < at + digits[count])
            return 0;
        memcpy(field, text + at, digits[count]);
        out[count] = (unsigned)atoi(field);
        at += digits[count];
    }
    return text[at] ? 0 : count;
}

/* Field order when the author gives none: a field of four digits is the year. */
static const char *usual_order(const struct normalizer *normalizer, size_t count,
                               const size_t digits[FIELDS]) {
    const char *order = normalizer_string(normalizer, "order", NULL);
    if (count == 3)
        return digits[0] == 4 ? "ymd" : order;
    if (count == 2)
        return digits[0] == 4 ? "ym" : digits[1] == 4 ? "my" : *order == 'm' ? "md" : "dm";
    return digits[0] == 4 ? "y" : "";
}

bool normalize_date(const struct normalizer *normalizer, const char *format, const char *text,
                    struct buf *out) {
    unsigned values[FIELDS];
    size_t digits[FIELDS] = {0}, count = numbers(text, "/.- ", values, digits, NULL);
    if (!count && *format)
        count = run_together(text, format, values, digits);
    if (!count)
        count = run_together(text, "ymd", values, digits), format = count ? "ymd" : format;
    const char *order = *format ? format : usual_order(normalizer, count, digits);
    if (!count || strlen(order) != count)
        return false;
    unsigned d = 0, m = 0, y = 0;
    bool has_year = false;
    size_t fields = 0;
    char sorted[FIELDS + 1] = "", day[8], year[8];
    for (const char *c = "dmy"; *c; c++) {
        const char *at = strchr(order, *c);
        if (!at)
            continue;
        sorted[fields++] = *c;
        *(*c == 'd' ? &d : *c == 'm' ? &m : &y) = values[at - order];
        has_year |= *c == 'y';
    }
    if ((strchr(sorted, 'd') && (d < 1 || d > 31)) || (strchr(sorted, 'm') && (m < 1 || m > 12)))
        return false;
    snprintf(day, sizeof day, "%u", d);
    snprintf(year, sizeof year, "%u", y);
    const char *month =
        m ? json_string_value(json_array_get(json_object_get(normalizer->root, "months"), m - 1)) : "";
    struct buf nth = {0};
    const char *first = d == 1 ? normalizer_string(normalizer, "date", "first") : NULL;
    if (first)
        buf_printf(&nth, "%s", first);
    else if (!normalize_ordinal(normalizer, day, &nth))
        buf_printf(&nth, "%s", day);
    buf_add(&nth, "", 1);
    const char *template = normalizer_string(normalizer, "date", sorted);
    const char *const words[] = {"d", first ? first : day,  "nth", (const char *)nth.data, "m", month,
                                 "y", has_year ? year : "", NULL};
    if (template)
        template_fill(out, template, words);
    buf_free(&nth);
    return template != NULL;
}

bool normalize_time(const struct normalizer *normalizer, const char *format, const char *text,
                    struct buf *out) {
    unsigned values[FIELDS] = {0};
    size_t digits[FIELDS];
    const char *rest, *half = NULL;
    size_t count = numbers(text, ":.h", values, digits, &rest);
    if (!count)
        return false;
    if (!strncasecmp(rest, "h", 1) && count == 1)
        rest++;
    if (!strncasecmp(rest, "a", 1))
        half = "am";
    else if (!strncasecmp(rest, "p", 1))
        half = "pm";
    if (half)
        rest += strcspn(rest, " ");
    if (*rest || values[0] > 24 || values[1] > 59 || values[2] > 59 || (half && values[0] > 12) ||
        (*format && strncmp("hms", format, count) != 0))
        return false;
    char h[4], m[4], s[4];
    snprintf(h, sizeof h, "%u", values[0] % 100);
    snprintf(m, sizeof m, "%u", values[1] % 100);
    snprintf(s, sizeof s, "%u", values[2] % 100);
    const char *name = count == 3 ? "hms" : !values[1] ? "h" : values[1] < 10 ? "h0m" : "hm";
    const char *words = half ? normalizer_string(normalizer, "time", half) : "";
    const char *const fields[] = {"h", h, "m", m, "s", s, NULL};
    const char *template = normalizer_string(normalizer, "time", name);
    if (!template || !words)
        return false;
    template_fill(out, template, fields);
    buf_printf(out, "%s%s", half ? " " : "", words);
    return true;
}

/* "1:20" is minutes and seconds; "1:20:00" starts with hours. */
bool normalize_duration(const struct normalizer *normalizer, const char *text, struct buf *out) {
    static const char *const units[] = {"h", "m", "s"};
    unsigned values[FIELDS];
    size_t digits[FIELDS], count = numbers(text, ":", values, digits, NULL), left = 0;
    if (count < 2)
        return false;
    for (size_t i = 0; i < count; i++)
        left += values[i] != 0;
    size_t before = out->size;
    for (size_t i = 0; i < count; i++) {
        const char *name = units[FIELDS - count + i];
        const char *form = normalizer_form(
            json_object_get(json_object_get(normalizer->root, "duration"), name), values[i] == 1);
        if (!form || (i && values[i] > 59)) {
            out->size = before;
            return false;
        }
        if (!values[i] && (left || i + 1 < count))
            continue;
        const char *link = out->size == before ? "" : left > 1 ? ", " : " ";
        buf_printf(out, "%s%s%s%u %s", link, *link == ' ' ? normalizer_string(normalizer, "and", NULL) : "",
                   *link == ' ' ? " " : "", values[i], form);
        left -= left > 0;
    }
    return true;
}
