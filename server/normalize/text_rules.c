/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Loads a language's rules and prepares them for matching. */
#include "server/base/json/json_place.h"
#include "server/base/mem.h"
#include "server/normalize/text_rules_internal.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unicode/ustring.h>

static UChar *to_utf16(const char *text, int32_t *size) {
    size_t cap = strlen(text) + 1;
    UErrorCode e = U_ZERO_ERROR;
    UChar *units = mem_alloc(cap * sizeof *units);
    u_strFromUTF8(units, (int32_t)cap, size, text, -1, &e);
    return units;
}

static int longer_first(const void *a, const void *b) {
    const char *x = *(const char *const *)a, *y = *(const char *const *)b;
    size_t n = strlen(x), m = strlen(y);
    return n != m ? (n < m ? 1 : -1) : strcmp(x, y);
}

static size_t first_length(const char *key) {
    size_t length = *key != '\0';
    while (length && ((unsigned char)key[length] & 0xC0) == 0x80)
        length++;
    return length;
}

static void add_escaped(struct buf *out, const char *text, size_t length) {
    for (size_t i = 0; i < length; i++)
        buf_printf(out, "%s%c", strchr("\\^$.|?*+()[]{}/-", text[i]) ? "\\" : "", text[i]);
}

/* Writes the keys of a table as a regular expression, longest first. They are grouped by first character,
 * so that most texts fail early. */
static void add_keys(struct buf *out, const json_t *table) {
    size_t count = 0;
    const char **keys = mem_alloc((json_object_size(table) + 1) * sizeof *keys), *key;
    json_t *value;
    json_object_foreach((json_t *)table, key, value) {
        keys[count++] = key;
    }
    qsort(keys, count, sizeof *keys, longer_first);
    buf_printf(out, "(?:");
    bool any = false;
    for (size_t i = 0; i < count; i++) {
        if (!keys[i])
            continue;
        size_t first = first_length(keys[i]);
        const char *begins = keys[i];
        buf_printf(out, "%s", any ? "|" : "");
        add_escaped(out, begins, first);
        buf_printf(out, "(?:");
        for (size_t j = i; j < count; j++) {
            if (!keys[j] || strncmp(keys[j], begins, first) != 0)
                continue;
            buf_printf(out, "%s", j > i ? "|" : "");
            add_escaped(out, keys[j] + first, strlen(keys[j]) - first);
            keys[j] = NULL;
        }
        buf_printf(out, ")");
        any = true;
    }
    buf_printf(out, ")");
    free(keys);
}

/* Replaces %name% by the macro of that name, or else by the keys of the table of that name. */
static int expand(const json_t *root, const char *pattern, int depth, struct buf *out) {
    for (const char *s = pattern; *s; s++) {
        const char *end = *s == '%' ? strchr(s + 1, '%') : NULL;
        char name[64];
        size_t length = end ? (size_t)(end - s - 1) : 0;
        if (!length || length >= sizeof name ||
            strspn(s + 1, "abcdefghijklmnopqrstuvwxyz_0123456789") != length) {
            buf_add(out, s, 1);
            continue;
        }
        snprintf(name, sizeof name, "%.*s", (int)length, s + 1);
        const json_t *macro = json_object_get(json_object_get(root, "macros"), name);
        const json_t *table = json_object_get(json_object_get(root, "tables"), name);
        if (macro && depth < 8) {
            if (expand(root, json_string_value(macro), depth + 1, out))
                return -1;
        } else if (table) {
            add_keys(out, table);
        } else {
            return -1;
        }
        s = end;
    }
    return 0;
}

/* Adds the first characters of a table's keys. */
static void add_first(USet *set, const json_t *table, bool any_case) {
    const char *key;
    json_t *value;
    json_object_foreach((json_t *)table, key, value) {
        int32_t size = 0;
        UChar *units = to_utf16(key, &size);
        UChar32 cp = 0;
        if (size) {
            U16_GET(units, 0, 0, size, cp);
            uset_add(set, cp);
        }
        free(units);
    }
    if (any_case)
        uset_closeOver(set, USET_CASE_INSENSITIVE);
}

static bool flag(const struct json_place *at, const char *name) {
    return json_is_true(json_object_get(at->json, name));
}

static int read_rule(struct text_rules *rules, const struct json_place *at, struct text_rule *rule) {
    static const char *const keys[] = {"match",  "say",   "at",   "keys", "case", "joined",
                                       "inside", "guess", "note", "in",   "then", NULL};
    struct json_place match = json_place_key(at, "match"), say = json_place_key(at, "say"),
                      begins = json_place_key(at, "at"), table = json_place_key(at, "keys");
    const char *pattern, *set, *name;
    struct buf expanded = {0};
    UErrorCode e = U_ZERO_ERROR;
    int32_t size = 0;
    bool any_case = json_is_false(json_object_get(at->json, "case"));
    if (json_place_keys(at, keys) || json_place_text(&match, &pattern))
        return -1;
    rule->say = json_string_value(say.json);
    if (!rule->say)
        return json_place_fail(&say, "must be a string");
    rule->joined = flag(at, "joined");
    rule->inside = flag(at, "inside");
    rule->guess = flag(at, "guess");
    int failed = expand(rules->root, pattern, 0, &expanded);
    buf_add(&expanded, "", 1);
    if (failed) {
        buf_free(&expanded);
        return json_place_fail(&match, "names a macro or table that is not there");
    }
    rule->pattern = to_utf16((const char *)expanded.data, &rule->pattern_size);
    rule->any_case = any_case;
    buf_free(&expanded);
    UChar *units;
    struct json_place then = json_place_key(at, "then");
    if (then.json) {
        if (json_place_text(&then, &set))
            return -1;
        units = to_utf16(set, &size);
        rule->then = uset_openPattern(units, size, &e);
        free(units);
        if (U_FAILURE(e))
            return json_place_fail(&then, "is no set of characters: %s", u_errorName(e));
    }
    if (table.json) {
        if (json_place_text(&table, &name))
            return -1;
        rule->at = uset_openEmpty();
        add_first(rule->at, json_object_get(rules->tables, name), any_case);
        return 0;
    }
    if (json_place_text(&begins, &set))
        return -1;
    units = to_utf16(set, &size);
    rule->at = uset_openPattern(units, size, &e);
    free(units);
    if (any_case && U_SUCCESS(e))
        uset_closeOver(rule->at, USET_CASE_INSENSITIVE);
    return U_SUCCESS(e) ? 0 : json_place_fail(&begins, "is no set of characters: %s", u_errorName(e));
}

bool rule_compile(struct text_rule *rule, char *message, size_t cap) {
    UErrorCode e = U_ZERO_ERROR;
    UParseError place = {0};
    rule->match = uregex_open(rule->pattern, rule->pattern_size, rule->any_case ? UREGEX_CASE_INSENSITIVE : 0,
                              &place, &e);
    if (U_FAILURE(e)) {
        snprintf(message, cap, "%s at character %d of its expansion", u_errorName(e), place.offset);
        rule->match = NULL;
    } else {
        uregex_useTransparentBounds(rule->match, true, &e);
        uregex_useAnchoringBounds(rule->match, false, &e);
        uregex_setTimeLimit(rule->match, RULE_TIME_LIMIT, &e);
    }
    free(rule->pattern);
    rule->pattern = NULL;
    return rule->match != NULL;
}

int text_rules_check(struct text_rules *rules, struct error *e) {
    char message[160];
    uv_mutex_lock(&rules->lock);
    int failed = 0;
    for (size_t i = 0; i < rules->rule_count && !failed; i++)
        if (rules->rules[i].pattern && !rule_compile(&rules->rules[i], message, sizeof message))
            failed = error_set(e, ERROR_BAD_NORMALIZATION, "rules[%zu].match: %s", i, message);
    uv_mutex_unlock(&rules->lock);
    return failed;
}

/* Lists the rules to try at each character. */
void rules_make_lists(struct text_rules *rules) {
    uint16_t list[RULES_MAX + 1];
    for (UChar32 cp = 0; cp <= RULE_FIRST; cp++) {
        size_t count = 0;
        for (size_t i = 0; i < rules->rule_count; i++)
            if (cp == RULE_FIRST || uset_contains(rules->rules[i].at, cp))
                list[count++] = (uint16_t)i;
        list[count++] = UINT16_MAX;
        uint16_t *kept = mem_alloc(count * sizeof *kept);
        memcpy(kept, list, count * sizeof *kept);
        if (cp < RULE_FIRST)
            rules->first[cp] = kept;
        else
            rules->others = kept;
    }
}

static int read_rules(struct text_rules *rules, const struct json_place *root) {
    struct json_place list = json_place_key(root, "rules");
    if (json_place_array(&list))
        return -1;
    size_t count = json_array_size(list.json);
    if (count > RULES_MAX)
        return json_place_fail(&list, "has more than %d items", RULES_MAX);
    rules->rules = mem_alloc((count + 1) * sizeof *rules->rules);
    for (size_t i = 0; i < count; i++) {
        struct json_place item = json_place_item(&list, i);
        rules->rule_count++;
        if (read_rule(rules, &item, &rules->rules[i]))
            return -1;
    }
    return 0;
}

static int read_file(struct text_rules *rules, const char *path, const char *region, struct error *e) {
    static const char *const keys[] = {"$comment", "tag",           "spellout",   "decimal",
                                       "number",   "abbreviations", "line_words", "tables",
                                       "macros",   "rules",         "regions",    NULL};
    struct json_place root;
    char message[160] = "";
    if (json_place_load(path, ERROR_BAD_NORMALIZATION, &root, e))
        return -1;
    rules->root = root.json;
    if (json_place_keys(&root, keys))
        return -1;
    json_t *own = json_object_get(json_object_get(root.json, "regions"), region);
    if (own)
        json_object_update_recursive(root.json, own);
    size_t i;
    json_t *rule;
    json_array_foreach(json_object_get(root.json, "rules"), i, rule) {
        json_t *there = json_object_get(json_object_get(rule, "in"), region);
        if (there)
            json_object_update(rule, there);
    }
    rules->tables = json_object_get(root.json, "tables");
    struct json_place spellout = json_place_key(&root, "spellout"), number = json_place_key(&root, "number");
    struct json_place locale = json_place_key(&spellout, "locale");
    struct json_place tag = json_place_key(&root, "tag");
    const char *name;
    if (json_place_tag(&tag, &name) || json_place_object(&spellout) || json_place_object(&number) ||
        json_place_text(&locale, &rules->locale))
        return -1;
    struct json_place abbreviations = json_place_key(&root, "abbreviations");
    if (json_place_texts(&abbreviations, &rules->abbreviations))
        return -1;
    struct json_place line_words = json_place_key(&root, "line_words");
    if (line_words.json && json_place_texts(&line_words, &rules->line_words))
        return -1;
    rules->spellout = spellout_new(spellout.json, message, sizeof message);
    if (!rules->spellout)
        return json_place_fail(&spellout, "%s", message);
    return read_rules(rules, &root);
}

struct text_rules *text_rules_load(const char *path, const char *region, struct error *e) {
    struct text_rules *rules = mem_alloc(sizeof *rules);
    uv_mutex_init(&rules->lock);
    if (!read_file(rules, path, region, e))
        return rules;
    text_rules_free(rules);
    return NULL;
}

void text_rules_free(struct text_rules *rules) {
    if (!rules)
        return;
    for (size_t i = 0; i < rules->rule_count; i++) {
        if (rules->rules[i].match)
            uregex_close(rules->rules[i].match);
        free(rules->rules[i].pattern);
        if (rules->rules[i].at)
            uset_close(rules->rules[i].at);
        if (rules->rules[i].then)
            uset_close(rules->rules[i].then);
    }
    for (size_t i = 0; i < RULE_FIRST; i++)
        free(rules->first[i]);
    free(rules->others);
    free(rules->rules);
    json_texts_free(rules->abbreviations);
    json_texts_free(rules->line_words);
    spellout_free(rules->spellout);
    json_decref(rules->root);
    uv_mutex_destroy(&rules->lock);
    free(rules);
}

const char *text_rules_tag(const struct text_rules *rules) {
    return json_string_value(json_object_get(rules->root, "tag"));
}

json_t *text_rules_regions(const struct text_rules *rules) {
    return json_object_get(rules->root, "regions");
}

const char *const *text_rules_abbreviations(const struct text_rules *rules) {
    return (const char *const *)rules->abbreviations;
}

const char *const *text_rules_line_words(const struct text_rules *rules) {
    return (const char *const *)rules->line_words;
}

char *rules_lower(const struct text_rules *rules, const char *text) {
    int32_t size = 0, lower = 0, bytes = 0;
    UErrorCode e = U_ZERO_ERROR;
    UChar *units = to_utf16(text, &size);
    int32_t cap = 2 * size + 8;
    UChar *out = mem_alloc((size_t)cap * sizeof *out);
    lower = u_strToLower(out, cap, units, size, rules->locale, &e);
    char *result = mem_alloc((size_t)cap * 3 + 1);
    u_strToUTF8(result, cap * 3, &bytes, out, U_SUCCESS(e) ? lower : 0, &e);
    free(units);
    free(out);
    return result;
}

static const json_t *follow(const json_t *table, const char *key) {
    const json_t *value = json_object_get(table, key);
    const json_t *other = json_is_string(value) ? json_object_get(table, json_string_value(value)) : NULL;
    return other && json_is_array(other) ? other : value;
}

const json_t *rules_look_up(const struct text_rules *rules, const char *name, const char *key) {
    const json_t *table = json_object_get(rules->tables, name), *found = follow(table, key);
    if (found || !table)
        return found;
    char *lower = rules_lower(rules, key);
    size_t length = strlen(lower);
    found = follow(table, lower);
    if (!found && length && lower[length - 1] == '.') {
        lower[length - 1] = '\0';
        found = follow(table, lower);
    }
    free(lower);
    return found;
}

void said_free(struct said *said) {
    buf_free(&said->words);
    free(said->parts);
    *said = (struct said){0};
}
