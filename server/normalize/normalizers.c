/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/normalize/normalizers.h"
#include "server/base/mem.h"
#include "server/normalize/normalizers_internal.h"
#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

static bool are_strings(const json_t *array, size_t count) {
    for (size_t i = 0; i < json_array_size(array); i++)
        if (!json_is_string(json_array_get(array, i)))
            return false;
    return json_is_array(array) && (!count || json_array_size(array) == count);
}

/* Every member of the object is a string, or an array of `count` strings. */
static bool are_all(const json_t *object, size_t count) {
    const char *name;
    json_t *value;
    json_object_foreach((json_t *)object, name, value) {
        if (count ? !are_strings(value, count) : !json_is_string(value))
            return false;
    }
    return json_is_object(object);
}

/* What is wrong with the file, or NULL. */
static const char *fault(const json_t *root) {
    const json_t *ordinal = json_object_get(root, "ordinal"), *rules = json_object_get(ordinal, "rules");
    const json_t *currencies = json_object_get(root, "currencies");
    const char *name, *point = json_string_value(json_object_get(root, "decimal")),
                      *groups = json_string_value(json_object_get(root, "thousands"));
    json_t *value;
    if (!json_is_string(json_object_get(root, "tag")))
        return "tag must be a string";
    if (!point || strlen(point) != 1 || !groups || strlen(groups) != 1)
        return "decimal and thousands must be one character each";
    if (!are_strings(json_object_get(root, "months"), 12))
        return "months must be twelve strings";
    if (!are_strings(json_object_get(ordinal, "words"), 0) || !json_is_array(rules))
        return "ordinal must have words and rules";
    for (size_t i = 0; i < json_array_size(rules); i++)
        if (!are_strings(json_array_get(rules, i), 2))
            return "a rule of ordinal must be an ending and a template";
    static const char *const words[] = {"plus", "order", "fraction", "and"};
    for (size_t i = 0; i < sizeof words / sizeof *words; i++)
        if (!json_is_string(json_object_get(root, words[i])))
            return "plus, order, fraction and and must be strings";
    if (!are_all(json_object_get(root, "date"), 0) || !are_all(json_object_get(root, "time"), 0) ||
        !are_all(json_object_get(root, "net"), 0))
        return "date, time and net must hold strings";
    if (!are_all(json_object_get(root, "parts"), 2) || !are_all(json_object_get(root, "duration"), 2) ||
        !are_all(json_object_get(root, "units"), 2))
        return "parts, duration and units must hold pairs of strings";
    json_object_foreach((json_t *)currencies, name, value) {
        if (!are_strings(json_object_get(value, "signs"), 0) ||
            !are_strings(json_object_get(value, "name"), 2) ||
            !are_strings(json_object_get(value, "cent"), 2))
            return "a currency must have signs, name and cent";
    }
    return json_is_object(currencies) ? NULL : "currencies must be an object";
}

static int load(struct normalizers *normalizers, const char *path, struct error *e) {
    json_error_t why;
    json_t *root = json_load_file(path, JSON_REJECT_DUPLICATES, &why);
    const char *wrong = root ? fault(root) : why.text;
    if (wrong) {
        error_set(e, ERROR_BAD_NORMALIZATION, "%s: %s", path, wrong);
        json_decref(root);
        return -1;
    }
    normalizers->list =
        mem_grow(normalizers->list, &normalizers->cap, normalizers->count + 1, sizeof *normalizers->list);
    struct normalizer *r = normalizers->list[normalizers->count++] = mem_alloc(sizeof *r);
    r->root = root;
    r->tag = json_string_value(json_object_get(root, "tag"));
    r->decimal = *json_string_value(json_object_get(root, "decimal"));
    r->thousands = *json_string_value(json_object_get(root, "thousands"));
    return 0;
}

int normalizers_load(struct normalizers *normalizers, const char *folder, struct error *e) {
    char path[4096];
    int result = 0;
    DIR *dir = opendir(folder);
    *normalizers = (struct normalizers){0};
    if (!dir)
        return 0; /* no language says how it reads: the voices do as they like */
    for (struct dirent *entry; !result && (entry = readdir(dir)) != NULL;) {
        const char *dot = strrchr(entry->d_name, '.');
        if (!dot || strcmp(dot, ".json") != 0)
            continue;
        snprintf(path, sizeof path, "%s/%s", folder, entry->d_name);
        result = load(normalizers, path, e);
    }
    closedir(dir);
    return result;
}

void normalizers_free(struct normalizers *normalizers) {
    for (size_t i = 0; i < normalizers->count; i++) {
        json_decref(normalizers->list[i]->root);
        free(normalizers->list[i]);
    }
    free(normalizers->list);
    *normalizers = (struct normalizers){0};
}

const struct normalizer *normalizers_find(const struct normalizers *normalizers, const char *lang) {
    size_t primary = strcspn(lang, "-");
    for (size_t i = 0; i < normalizers->count; i++) {
        const char *tag = normalizers->list[i]->tag;
        if (strcspn(tag, "-") == primary && !strncasecmp(tag, lang, primary))
            return normalizers->list[i];
    }
    return NULL;
}

static bool is_space(char c) {
    return c == ' ' || c == '\t' || c == '\r' || c == '\n';
}

void normalizers_apply(const struct normalizers *normalizers, struct score *score, size_t index,
                       const char *lang) {
    struct score_item *item = &score->items[index];
    const char *way = item->style->say_as, *text = item->text ? item->text : "";
    size_t length = strlen(text), from = 0;
    if (item->kind != SCORE_TEXT || !way || !strcmp(way, "characters"))
        return;
    while (length && is_space(text[length - 1]))
        length--;
    while (from < length && is_space(text[from]))
        from++;
    if (from == length)
        return;
    const struct normalizer *normalizer = normalizers_find(normalizers, lang);
    char *trimmed = mem_strndup(text + from, length - from);
    struct buf words = {0};
    buf_add(&words, text, from);
    if (length - from < NORMALIZER_TEXT_MAX && normalizer_words(normalizer, way, trimmed, &words)) {
        buf_add(&words, text + length, strlen(text + length));
        struct score_style style = *item->style;
        style.say_as = NULL;
        item->verbatim &= words.size == strlen(text) && !memcmp(words.data, text, words.size);
        item->text = score_strndup(score, (const char *)words.data, words.size);
        item->style = score_keep_style(score, &style);
    } else if (normalizer) {
        score_warn(score, item->start, ERROR_BAD_VALUE, "\"%.60s\" cannot be read as \"%.40s\"", trimmed,
                   way);
    }
    buf_free(&words);
    free(trimmed);
}
