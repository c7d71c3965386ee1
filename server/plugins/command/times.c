/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/plugins/command/times.h"
#include "server/base/mem.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define HTK_UNIT 1e-7
#define SECONDS_MAX 36000

int cm_timing_read(struct cm_timing *timing, const json_t *setting, char *field, size_t field_cap, char *what,
                   size_t what_cap) {
    static const char *const formats[] = {"lab", "htk", "textgrid", "json"};
    const char *format = json_string_value(json_object_get(setting, "format"));
    *timing = (struct cm_timing){.given = true,
                                 .tier = json_string_value(json_object_get(setting, "tier")),
                                 .argv = json_object_get(setting, "argv"),
                                 .names = json_object_get(setting, "names")};
    size_t i = 0, k;
    const char *name;
    json_t *value;
    while (i < 4 && (!format || strcmp(format, formats[i]) != 0))
        i++;
    timing->format = (enum cm_format)i;
    snprintf(field, field_cap, "%s", "");
    snprintf(what, what_cap, "wanted is an object");
    if (!json_is_object(setting))
        return -1;
    snprintf(field, field_cap, "format");
    snprintf(what, what_cap, "wanted is \"lab\", \"htk\", \"textgrid\" or \"json\"");
    if (i == 4)
        return -1;
    snprintf(field, field_cap, "argv");
    snprintf(what, what_cap, "wanted is a list of texts, the program and its arguments");
    if (timing->argv && !json_array_size(timing->argv))
        return -1;
    json_array_foreach(timing->argv, k, value) if (!json_is_string(value)) return -1;
    snprintf(field, field_cap, "names");
    snprintf(what, what_cap, "wanted is an object with an IPA text for each of the program's names");
    if (timing->names && !json_is_object(timing->names))
        return -1;
    json_object_foreach((json_t *)timing->names, name, value) if (!json_is_string(value)) return -1;
    return 0;
}

/* The sign that stands for a pause in most programs' names. */
static bool is_pause(const char *name) {
    static const char *const names[] = {"", "_", "#", "pau", "sil", "sp", "SIL", "<p:>", NULL};
    const char *const *n = names;
    while (*n && strcmp(*n, name) != 0)
        n++;
    return *n;
}

static const char *ipa_of(struct cm_times *times, const struct cm_timing *timing, const char *name) {
    const char *ipa = json_string_value(json_object_get(timing->names, name));
    if (ipa)
        return ipa;
    if (timing->names && !is_pause(name) && !*times->unnamed)
        snprintf(times->unnamed, sizeof times->unnamed, "%s", name);
    return is_pause(name) ? "" : name;
}

static bool good(double start, double end) {
    return start >= 0 && end >= start && end < SECONDS_MAX;
}

static bool add_phone(struct cm_times *times, const struct cm_timing *timing, const char *name, double start,
                      double end, uint32_t stress) {
    if (!good(start, end))
        return false;
    times->phones = mem_grow(times->phones, &times->phone_cap, times->phone_count + 1, sizeof *times->phones);
    struct cm_phone *p = &times->phones[times->phone_count++];
    *p = (struct cm_phone){.start = start, .end = end, .stress = stress};
    snprintf(p->name, sizeof p->name, "%s", name);
    snprintf(p->ipa, sizeof p->ipa, "%s", ipa_of(times, timing, name));
    return true;
}

static int fail_line(char *message, size_t cap, size_t line, const char *what) {
    snprintf(message, cap, "the times, line %zu: %s", line, what);
    return -1;
}

static int parse_lines(struct cm_times *times, const struct cm_timing *timing, char *data, char *message,
                       size_t cap) {
    double before = 0;
    size_t number = 0;
    char *save = NULL, *header = strstr(data, "\n#");
    bool lab = timing->format == CM_LAB;
    if (lab && *data == '#')
        data++;
    else if (lab && header)
        data = header + 2;
    for (char *line = strtok_r(data, "\r\n", &save); line; line = strtok_r(NULL, "\r\n", &save)) {
        double start, end;
        char name[32] = "";
        number++;
        if (strspn(line, " \t") == strlen(line))
            continue;
        bool read = lab ? sscanf(line, "%lf %*s %31s", &end, name) >= 1
                        : sscanf(line, "%lf %lf %31s", &start, &end, name) == 3;
        start = lab ? before : start * HTK_UNIT;
        end = lab ? end : end * HTK_UNIT;
        if (!read || !add_phone(times, timing, name, start, end, 0))
            return fail_line(message, cap, number,
                             lab ? "wanted is END COLOUR NAME" : "wanted is START END NAME");
        before = end;
    }
    return 0;
}

/* The next value of a TextGrid: a number, or a text between quotes (a doubled quote is one). Names before "="
 * and what stands in brackets are passed over, so that the long form reads like the short one. */
static bool next_value(char **at, char *out, size_t cap, bool *quoted) {
    char *c = *at;
    size_t used = 0;
    while (*c && *c != '"' && !(*c >= '0' && *c <= '9') && *c != '-')
        c = *c == '[' && strchr(c, ']') ? strchr(c, ']') : c + 1;
    *quoted = *c == '"';
    if (!*c)
        return false;
    for (c += *quoted; *c && (*quoted ? (*c != '"' || c[1] == '"') : (strchr("0123456789.-+eE", *c) != NULL));
         c++) {
        c += *quoted && *c == '"';
        if (used + 1 < cap)
            out[used++] = *c;
    }
    out[used] = '\0';
    *at = *c ? c + 1 : c;
    return true;
}

/* One interval or the ends of a tier; false at the end of the file. */
static bool next_number(char **at, double *out) {
    char value[64];
    bool quoted;
    if (!next_value(at, value, sizeof value, &quoted) || quoted)
        return false;
    *out = strtod(value, NULL);
    return true;
}

static int parse_textgrid(struct cm_times *times, const struct cm_timing *timing, char *data, char *message,
                          size_t cap) {
    char value[64], name[64];
    bool quoted, wanted = false;
    double start, end, count;
    char *at = strstr(data, "IntervalTier");
    for (; at && !wanted; at = wanted ? at : strstr(at, "IntervalTier")) {
        at += strlen("IntervalTier\"");
        if (!next_value(&at, name, sizeof name, &quoted) || !quoted)
            break;
        wanted = !timing->tier || !strcmp(timing->tier, name);
        if (wanted)
            break;
    }
    if (!wanted || !next_number(&at, &start) || !next_number(&at, &end) || !next_number(&at, &count)) {
        snprintf(message, cap, "the times are no TextGrid with the tier \"%s\"",
                 timing->tier ? timing->tier : "");
        return -1;
    }
    for (size_t i = 0; i < count; i++) {
        if (!next_number(&at, &start) || !next_number(&at, &end) ||
            !next_value(&at, value, sizeof value, &quoted) || !quoted ||
            !add_phone(times, timing, value, start, end, 0)) {
            snprintf(message, cap,
                     "the times, interval %zu of the tier \"%s\": wanted are its two times and its text",
                     i + 1, name);
            return -1;
        }
    }
    return 0;
}

static int parse_json(struct cm_times *times, const struct cm_timing *timing, const char *data, size_t size,
                      char *message, size_t cap) {
    json_error_t why;
    json_t *root = json_loadb(data, size, 0, &why), *item;
    size_t i;
    bool well = root != NULL;
    json_array_foreach(json_object_get(root, "phones"), i, item) {
        const char *ipa = NULL, *name = NULL;
        double start, end;
        int stress = 0;
        well = well &&
               !json_unpack_ex(item, &why, 0, "{s?s s?s s:F s:F s?i}", "ipa", &ipa, "name", &name, "start",
                               &start, "end", &end, "stress", &stress) &&
               add_phone(times, timing,
                         name  ? name
                         : ipa ? ipa
                               : "",
                         start, end, (uint32_t)stress);
        if (well && ipa)
            snprintf(times->phones[times->phone_count - 1].ipa, sizeof times->phones->ipa, "%s", ipa);
    }
    json_array_foreach(json_object_get(root, "words"), i, item) {
        const char *text = NULL;
        struct cm_word w = {.end = 0};
        well = well &&
               !json_unpack_ex(item, &why, 0, "{s:s s:F s:F}", "text", &text, "start", &w.start, "end",
                               &w.end) &&
               good(w.start, w.end);
        if (!well)
            break;
        snprintf(w.text, sizeof w.text, "%s", text);
        times->words = mem_grow(times->words, &times->word_cap, times->word_count + 1, sizeof *times->words);
        times->words[times->word_count++] = w;
    }
    json_decref(root);
    if (well)
        return 0;
    snprintf(message, cap, "the times, phone %zu, word %zu: %.80s", times->phone_count + 1,
             times->word_count + 1, *why.text ? why.text : "its times are not in order");
    return -1;
}

int cm_times_parse(struct cm_times *times, const struct cm_timing *timing, char *data, size_t size,
                   char *message, size_t cap) {
    int result = timing->format == CM_JSON       ? parse_json(times, timing, data, size, message, cap)
                 : timing->format == CM_TEXTGRID ? parse_textgrid(times, timing, data, message, cap)
                                                 : parse_lines(times, timing, data, message, cap);
    if (result == 0 && !times->phone_count) {
        snprintf(message, cap, "the times name no phones");
        return -1;
    }
    return result;
}

void cm_times_free(struct cm_times *times) {
    free(times->phones);
    free(times->words);
    *times = (struct cm_times){0};
}
