/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/normalize/normalizers.h"
#include "server/base/mem.h"
#include "server/normalize/normalizers_internal.h"
#include "server/normalize/text_rules.h"
#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

static int load(struct normalizers *normalizers, const char *path, struct error *e) {
    struct error inner = {0};
    json_t *root = normalizer_read(path, &inner);
    if (!root) {
        char text[320];
        return error_set(e, inner.code, "%s: %s", path, error_text(&inner, text, sizeof text));
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

struct language_rules {
    char tag[32];
    struct text_rules *rules;
};

static int load_rules_of(struct normalizers *normalizers, const char *path, const char *region,
                         struct error *e) {
    struct error inner = {0};
    struct text_rules *rules = text_rules_load(path, region, &inner);
    if (!rules) {
        char text[320];
        return error_set(e, inner.code, "%s: %s", path, error_text(&inner, text, sizeof text));
    }
    normalizers->rules = mem_grow(normalizers->rules, &normalizers->rule_cap, normalizers->rule_count + 1,
                                  sizeof *normalizers->rules);
    struct language_rules *r = &normalizers->rules[normalizers->rule_count++];
    snprintf(r->tag, sizeof r->tag, "%s", *region ? region : text_rules_tag(rules));
    r->rules = rules;
    return 0;
}

/* Loads a file, once for the language and once for each of its regions. */
static int load_rules(struct normalizers *normalizers, const char *path, struct error *e) {
    if (load_rules_of(normalizers, path, "", e))
        return -1;
    const char *region;
    json_t *value, *regions = text_rules_regions(normalizers->rules[normalizers->rule_count - 1].rules);
    json_object_foreach(regions, region, value) {
        if (load_rules_of(normalizers, path, region, e))
            return -1;
    }
    return 0;
}

struct text_rules *normalizers_rules(const struct normalizers *normalizers, const char *lang) {
    size_t primary = strcspn(lang, "-_");
    struct text_rules *found = NULL;
    for (size_t i = 0; i < normalizers->rule_count; i++) {
        const struct language_rules *r = &normalizers->rules[i];
        if (!strcasecmp(r->tag, lang))
            return r->rules;
        if (!found && strcspn(r->tag, "-") == primary && !strncasecmp(r->tag, lang, primary))
            found = r->rules; /* the language precedes its regions */
    }
    return found;
}

const char *const *normalizers_abbreviations(const struct normalizers *normalizers, const char *lang) {
    const struct text_rules *rules = normalizers_rules(normalizers, lang);
    return rules ? text_rules_abbreviations(rules) : NULL;
}

const char *const *normalizers_line_words(const struct normalizers *normalizers, const char *lang) {
    const struct text_rules *rules = normalizers_rules(normalizers, lang);
    return rules ? text_rules_line_words(rules) : NULL;
}

static int load_folder(struct normalizers *normalizers, const char *folder,
                       int (*one)(struct normalizers *normalizers, const char *path, struct error *e),
                       struct error *e) {
    char path[4096];
    int result = 0;
    DIR *dir = opendir(folder);
    if (!dir)
        return 0; /* no files: texts are left to the voices */
    for (struct dirent *entry; !result && (entry = readdir(dir)) != NULL;) {
        const char *dot = strrchr(entry->d_name, '.');
        if (!dot || strcmp(dot, ".json") != 0)
            continue;
        snprintf(path, sizeof path, "%s/%s", folder, entry->d_name);
        result = one(normalizers, path, e);
    }
    closedir(dir);
    return result;
}

int normalizers_load(struct normalizers *normalizers, const char *folder, struct error *e) {
    char text[4096];
    snprintf(text, sizeof text, "%s/text", folder);
    *normalizers = (struct normalizers){0};
    return load_folder(normalizers, folder, load, e) || load_folder(normalizers, text, load_rules, e) ? -1
                                                                                                      : 0;
}

void normalizers_free(struct normalizers *normalizers) {
    for (size_t i = 0; i < normalizers->count; i++) {
        json_decref(normalizers->list[i]->root);
        free(normalizers->list[i]);
    }
    free(normalizers->list);
    for (size_t i = 0; i < normalizers->rule_count; i++)
        text_rules_free(normalizers->rules[i].rules);
    free(normalizers->rules);
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
