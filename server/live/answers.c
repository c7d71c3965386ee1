/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/live/answers.h"
#include "server/base/buf.h"
#include "server/base/mem.h"
#include <stdlib.h>
#include <string.h>
#include <unicode/uchar.h>
#include <unicode/unorm2.h>
#include <unicode/ustring.h>
#include <unicode/utf8.h>

enum {
    CHOICES = 8,
    TEXT_MOST = 1024,  /* bytes of a text that is compared */
    PART_LETTERS = 4,  /* a shorter answer must be said alone: "no" is a part of much */
    DOTLESS_I = 0x131, /* Turkish speech is compared with what is typed without it */
};

struct answers {
    json_t *languages;
};

/* ---- folding: words in lower case without accents, one space between them ---- */

static void put(struct buf *out, UChar32 c) {
    char bytes[U8_MAX_LENGTH];
    int32_t size = 0;
    UBool wrong = false;
    U8_APPEND((uint8_t *)bytes, size, U8_MAX_LENGTH, c, wrong);
    if (!wrong)
        buf_add(out, bytes, (size_t)size);
}

static bool ends_with_space(const struct buf *out) {
    return !out->size || ((const char *)out->data)[out->size - 1] == ' ';
}

/* The caller frees the result. */
static char *fold(const char *text) {
    UErrorCode status = U_ZERO_ERROR;
    const UNormalizer2 *nfkd = unorm2_getNFKDInstance(&status);
    UChar units[TEXT_MOST], apart[4 * TEXT_MOST];
    int32_t count = 0, size = 0;
    struct buf out = {0};
    u_strFromUTF8(units, TEXT_MOST, &count, text, -1, &status);
    size = unorm2_normalize(nfkd, units, count, apart, 4 * TEXT_MOST, &status);
    for (int32_t at = 0; U_SUCCESS(status) && at < size;) {
        UChar32 c;
        U16_NEXT(apart, at, size, c);
        c = u_foldCase(c, U_FOLD_CASE_DEFAULT);
        if (c == DOTLESS_I)
            c = 'i';
        if (u_isalnum(c))
            put(&out, c);
        else if (u_charType(c) != U_NON_SPACING_MARK && !ends_with_space(&out))
            put(&out, ' ');
    }
    if (out.size && ends_with_space(&out))
        out.size--;
    buf_add(&out, "", 1);
    return (char *)out.data;
}

/* ---- the table ---- */

/* Folds all strings of a part of the table, in place. -1 if it holds anything else. */
static int fold_all(json_t *part) {
    const char *key;
    json_t *one;
    size_t i;
    int failed = 0;
    if (json_is_string(part)) {
        char *folded = fold(json_string_value(part));
        failed = !*folded || json_string_set(part, folded);
        free(folded);
        return failed ? -1 : 0;
    }
    if (!json_is_array(part) && !json_is_object(part))
        return -1;
    json_array_foreach(part, i, one) failed |= fold_all(one);
    json_object_foreach(part, key, one) failed |= fold_all(one);
    return failed;
}

struct answers *answers_load(const char *path, struct error *e) {
    json_error_t why;
    struct answers *a = mem_alloc(sizeof *a);
    a->languages = json_load_file(path, JSON_REJECT_DUPLICATES, &why);
    if (a->languages && json_is_object(a->languages) && !fold_all(a->languages))
        return a;
    error_set(e, ERROR_BAD_NORMALIZATION, "%s",
              a->languages ? "must be lists of words by language" : why.text);
    answers_free(a);
    return NULL;
}

void answers_free(struct answers *a) {
    if (a)
        json_decref(a->languages);
    free(a);
}

static const json_t *words_of(const struct answers *a, const char *lang) {
    char primary[16];
    size_t length = strcspn(lang, "-_");
    if (!a || length >= sizeof primary)
        return NULL;
    memcpy(primary, lang, length);
    primary[length] = '\0';
    return json_object_get(a->languages, primary);
}

static bool has(const json_t *list, const char *word, size_t length) {
    const json_t *one;
    size_t i;
    json_array_foreach((json_t *)list, i, one) if (json_string_length(one) == length &&
                                                   !memcmp(json_string_value(one), word, length)) return true;
    return false;
}

/* ---- comparing ---- */

struct offered {
    const json_t *words; /* of the language; NULL: none */
    char *choices[CHOICES];
    size_t count;
};

/* Returns whether the choice is one of these words, or begins with one. */
static bool begins(const json_t *list, const char *choice) {
    for (size_t length = strlen(choice); length; length--)
        if ((!choice[length] || choice[length] == ' ') && has(list, choice, length))
            return true;
    return false;
}

static int only_that_begins(const struct offered *o, const json_t *list) {
    int found = -1;
    for (size_t i = 0; i < o->count; i++)
        if (begins(list, o->choices[i])) {
            if (found >= 0)
                return -1;
            found = (int)i;
        }
    return found;
}

static int choice_that_is(const struct offered *o, const char *said, size_t length) {
    for (size_t i = 0; i < o->count; i++)
        if (strlen(o->choices[i]) == length && !memcmp(o->choices[i], said, length))
            return (int)i;
    return -1;
}

/* What these words alone mean. */
static int meaning(const struct offered *o, const char *said, size_t length) {
    const json_t *ordinals = json_object_get(o->words, "ordinals");
    int found = choice_that_is(o, said, length);
    for (size_t i = 0; found < 0 && i < o->count; i++)
        if (has(json_array_get(ordinals, i), said, length))
            found = (int)i;
    if (found < 0 && has(json_object_get(o->words, "last"), said, length))
        found = (int)o->count - 1;
    for (int yes = 1; found < 0 && yes >= 0; yes--) {
        const json_t *list = json_object_get(o->words, yes ? "yes" : "no");
        if (has(list, said, length))
            found = only_that_begins(o, list);
    }
    return found;
}

/* Takes words that say nothing from both ends, and looks at what is left each time. */
static int meaning_within(const struct offered *o, const char *said) {
    const json_t *before = json_object_get(o->words, "before"), *after = json_object_get(o->words, "after");
    size_t length = strlen(said);
    for (;;) {
        int found = meaning(o, said, length);
        const char *first = memchr(said, ' ', length), *last = memrchr(said, ' ', length);
        if (found >= 0 || !first)
            return found;
        if (has(before, said, (size_t)(first - said))) {
            length -= (size_t)(first + 1 - said);
            said = first + 1;
        } else if (has(after, last + 1, length - (size_t)(last + 1 - said))) {
            length = (size_t)(last - said);
        } else {
            return -1;
        }
    }
}

/* The only choice that is a part of a longer answer, as whole words. */
static int part_of(const struct offered *o, const char *said) {
    int found = -1;
    for (size_t i = 0; i < o->count; i++) {
        const size_t length = strlen(o->choices[i]);
        const char *at = length >= PART_LETTERS ? strstr(said, o->choices[i]) : NULL;
        while (at && ((at > said && at[-1] != ' ') || (at[length] && at[length] != ' ')))
            at = strstr(at + 1, o->choices[i]);
        if (at && found >= 0)
            return -1;
        found = at ? (int)i : found;
    }
    return found;
}

int answers_choose(const struct answers *a, const char *lang, const json_t *choices, const char *said) {
    struct offered o = {.words = words_of(a, lang)};
    const json_t *one;
    size_t i;
    char *text = fold(said);
    json_array_foreach((json_t *)choices, i, one) if (o.count < CHOICES) o.choices[o.count++] =
        fold(json_string_value(one));
    int found = *text ? meaning_within(&o, text) : -1;
    if (found < 0 && *text)
        found = part_of(&o, text);
    while (o.count)
        free(o.choices[--o.count]);
    free(text);
    return found;
}

/* Takes polite words from both ends, and looks at what is left each time. */
static bool asks_again(const json_t *words, const char *said) {
    const json_t *before = json_object_get(words, "before"), *after = json_object_get(words, "after");
    size_t length = strlen(said);
    for (;;) {
        const char *first = memchr(said, ' ', length), *last = memrchr(said, ' ', length);
        if (has(json_object_get(words, "again"), said, length))
            return true;
        if (first && has(before, said, (size_t)(first - said))) {
            length -= (size_t)(first + 1 - said);
            said = first + 1;
        } else if (last && has(after, last + 1, length - (size_t)(last + 1 - said))) {
            length = (size_t)(last - said);
        } else {
            return false;
        }
    }
}

bool answers_asks_again(const struct answers *a, const char *lang, const char *said) {
    const json_t *words = words_of(a, lang);
    char *text = fold(said);
    bool again = words && *text && asks_again(words, text);
    free(text);
    return again;
}
