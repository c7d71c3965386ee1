/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The formats with a phone in each line, and JSON. */
#include "server/align/times_internal.h"
#include <stdio.h>
#include <string.h>

#define HTK_UNIT 1e-7
enum { LINE_BYTES = 512, WORD_BYTES = 128 };

int times_read_lab(struct times_reader *r) {
    char line[LINE_BYTES], name[32];
    double before = 0, end;
    const char *start = r->at;
    bool header = false;
    while (!header && times_next_line(r, line, sizeof line))
        header = line[0] == '#' && !line[1 + strspn(line + 1, " \t")];
    if (!header) {
        r->at = start;
        r->line = 0;
    }
    while (times_next_line(r, line, sizeof line)) {
        if (!line[strspn(line, " \t")])
            continue;
        *name = '\0';
        if (sscanf(line, "%lf %*s %31s", &end, name) < 1)
            return times_fail(r, "wanted is END COLOUR NAME", "");
        if (!times_add_phone(r, name, before, end, 0))
            return times_fail(r, "the phone ends before it begins", "");
        before = end;
    }
    return 0;
}

/* A master label file has entries, each after its name in quotes, ended by a line ".". */
static int find_entry(struct times_reader *r) {
    char line[LINE_BYTES];
    const char *entry = r->options->entry;
    while (times_next_line(r, line, sizeof line)) {
        size_t length = strlen(line);
        if (*line != '"' || line[length - 1] != '"')
            continue;
        line[length - 1] = '\0';
        char *slash = strrchr(line, '/'), *name = slash ? slash + 1 : line + 1, *dot = strrchr(name, '.');
        if (dot)
            *dot = '\0';
        if (!entry || !strcmp(name, entry) || !strcmp(name, "*"))
            return 0;
    }
    return times_fail(r, "the file has no entry ", entry ? entry : "");
}

static bool is_number(const char *text) {
    double value;
    int used = 0;
    return sscanf(text, "%lf%n", &value, &used) == 1 && !text[used];
}

/* The word that a line may name, behind the phone or its score. */
static const char *word_of(const char *fourth, const char *fifth) {
    const char *word = *fifth ? fifth : is_number(fourth) ? "" : fourth;
    return times_is_pause(word) ? "" : word;
}

int times_read_htk(struct times_reader *r) {
    char line[LINE_BYTES], name[32], word[WORD_BYTES] = "", fourth[WORD_BYTES], fifth[WORD_BYTES];
    double start, end, word_start = 0, before = 0;
    bool entries = !strncmp(r->at, "#!MLF!#", 7);
    if (entries && find_entry(r))
        return -1;
    while (times_next_line(r, line, sizeof line) && !(entries && !strcmp(line, "."))) {
        if (!line[strspn(line, " \t")])
            continue;
        *fourth = *fifth = '\0';
        if (sscanf(line, "%lf %lf %31s %127s %127s", &start, &end, name, fourth, fifth) < 3)
            return times_fail(r, "wanted is START END NAME", "");
        const char *next = word_of(fourth, fifth);
        bool pause = times_is_pause(name);
        if (*word && (*next || pause)) {
            times_add_word(r, word, word_start, before);
            *word = '\0';
        }
        if (*next) {
            snprintf(word, sizeof word, "%s", next);
            word_start = start * HTK_UNIT;
        }
        before = end * HTK_UNIT;
        if (!times_add_phone(r, name, start * HTK_UNIT, before, 0))
            return times_fail(r, "the phone begins before the last one's end, or ends before it begins", "");
    }
    if (*word)
        times_add_word(r, word, word_start, before);
    return 0;
}

static int fail_item(const struct times_reader *r, const char *list, size_t i, const char *what) {
    char field[40];
    snprintf(field, sizeof field, "%s[%zu]", list, i);
    return error_in_field(r->e, TIMES_CODE, field, "%s", what);
}

int times_read_json(struct times_reader *r) {
    static const char order[] = "begins before the last one's end, or ends before it begins";
    json_error_t why;
    json_t *root = json_loads(r->at, 0, &why), *item;
    size_t i;
    int result = 0;
    if (!root) {
        r->line = why.line > 0 ? (size_t)why.line : 1;
        return times_fail(r, why.text, "");
    }
    json_t *words = json_object_get(root, "words");
    if (!json_is_array(json_object_get(root, "phones")))
        result = error_in_field(r->e, TIMES_CODE, "phones", "must be a list");
    else if (words && !json_is_array(words))
        result = error_in_field(r->e, TIMES_CODE, "words", "must be a list");
    json_array_foreach(result ? NULL : json_object_get(root, "phones"), i, item) {
        const char *ipa = NULL, *name = NULL;
        double start, end;
        int stress = 0;
        if (json_unpack_ex(item, &why, 0, "{s?s s?s s:F s:F s?i}", "ipa", &ipa, "name", &name, "start",
                           &start, "end", &end, "stress", &stress)) {
            result = fail_item(r, "phones", i, why.text);
            break;
        }
        if (stress < 0 || stress > 2) {
            result = fail_item(r, "phones", i, "stress must be 0, 1 or 2");
            break;
        }
        if (!times_add_phone(r, name ? name : ipa ? ipa : "", start, end, (uint32_t)stress)) {
            result = fail_item(r, "phones", i, order);
            break;
        }
        struct times_phone *p = &r->times->phones[r->times->phone_count - 1];
        if (ipa)
            snprintf(p->ipa, sizeof p->ipa, "%s", ipa);
    }
    json_array_foreach(words, i, item) {
        const char *text;
        double start, end;
        if (result)
            break;
        if (json_unpack_ex(item, &why, 0, "{s:s s:F s:F}", "text", &text, "start", &start, "end", &end))
            result = fail_item(r, "words", i, why.text);
        else if (!times_add_word(r, text, start, end))
            result = fail_item(r, "words", i, order);
    }
    json_decref(root);
    return result;
}
