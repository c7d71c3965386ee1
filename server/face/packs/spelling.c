/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/face/packs/spelling.h"
#include "server/base/mem.h"
#include "server/base/utf8.h"
#include <stdlib.h>
#include <string.h>

const struct spelling_letter *spelling_of_phone(const struct spelling *spelling,
                                                const struct speech_phone *phone) {
    const size_t *entry = shape_table_entry(&spelling->common, phone);
    return entry ? &spelling->letters[*entry] : NULL;
}

static const struct spelling_letter *find_letter(const struct spelling *spelling, uint32_t code) {
    for (size_t i = 0; i < spelling->letter_count; i++)
        if (spelling->letters[i].code == code)
            return &spelling->letters[i];
    return NULL;
}

static const char *find_fold(const struct spelling *spelling, uint32_t code) {
    for (size_t i = 0; i < spelling->fold_count; i++)
        if (spelling->folds[i].code == code)
            return spelling->folds[i].text;
    return NULL;
}

struct list {
    struct spelled *items;
    size_t count, cap;
};

/* folded: the text is itself a fold's. */
static void read(const struct spelling *spelling, const char *text, bool folded, struct list *list) {
    size_t n = strlen(text), step;
    for (size_t i = 0; i < n; i += step) {
        uint32_t code;
        step = utf8_next(text + i, n - i, &code);
        if (!step) {
            step = 1;
            continue;
        }
        const struct spelling_letter *letter = find_letter(spelling, code);
        const char *fold = letter || folded ? NULL : find_fold(spelling, code);
        if (fold)
            read(spelling, fold, true, list);
        if (!letter)
            continue;
        list->items = mem_grow(list->items, &list->cap, list->count + 1, sizeof *list->items);
        list->items[list->count++] = (struct spelled){letter, NULL, 0};
    }
}

size_t spelling_read(const struct spelling *spelling, const char *word, struct spelled **out) {
    struct list list = {0};
    read(spelling, word, false, &list);
    *out = list.items;
    return list.count;
}

void spelling_syllables(struct spelled *letters, size_t count) {
    const struct spelling_letter *vowel = NULL;
    size_t begin = 0, syllable = 0; /* of the syllable that is open */
    for (size_t i = 0; i < count; i++) {
        if (letters[i].letter->vowel) {
            if (vowel) { /* the next syllable: with the consonant before it, if there is one */
                size_t first = letters[i - 1].letter->vowel ? i : i - 1;
                for (size_t k = begin; k < first; k++) {
                    letters[k].vowel = vowel;
                    letters[k].syllable = syllable;
                }
                begin = first;
                syllable++;
            }
            vowel = letters[i].letter;
        }
    }
    for (size_t k = begin; k < count; k++) {
        letters[k].vowel = vowel;
        letters[k].syllable = syllable;
    }
}

size_t spelling_shape(const struct spelling *spelling, const struct spelled *letter) {
    const struct spelling_letter *l = letter->letter;
    if (l->vowel)
        return l->shapes[0];
    if (!letter->vowel) /* a word without vowels: the first class stands for all */
        return l->like_vowel ? spelling->common.rest : l->shapes[0];
    return l->like_vowel ? letter->vowel->shapes[0] : l->shapes[letter->vowel->class];
}
