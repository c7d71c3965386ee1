/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/face/packs/spelling.h"
#include "server/base/mem.h"
#include "server/base/utf8.h"
#include <stdlib.h>
#include <string.h>

static int read_code(const struct json_place *at, const char *key, uint32_t *code) {
    return *key && utf8_next(key, strlen(key), code) == strlen(key)
               ? 0
               : json_place_fail(at, "must be named by one letter");
}

static int read_consonant(const struct spelling *s, const struct json_place *at, struct spelling_letter *l) {
    const char *text;
    if (json_is_string(at->json)) {
        l->like_vowel = true;
        if (json_place_text(at, &text))
            return -1;
        return strcmp(text, "vowel") ? json_place_fail(at, "must be \"vowel\" or one shape for each class")
                                     : 0;
    }
    if (json_place_keys(at, (const char *const *)s->common.classes))
        return -1;
    for (size_t i = 0; i < s->common.class_count; i++) {
        struct json_place child = json_place_key(at, s->common.classes[i]);
        if (shapes_choose(&child, &s->common.shapes, &l->shapes[i]))
            return -1;
    }
    return 0;
}

static int read_vowel(const struct spelling *s, const struct json_place *at, struct spelling_letter *l) {
    struct json_place class = json_place_key(at, "class"), shape = json_place_key(at, "shape");
    l->vowel = true;
    return shape_table_class(&s->common, &class, &l->class) ||
                   shapes_choose(&shape, &s->common.shapes, &l->shapes[0])
               ? -1
               : 0;
}

/* The first phone of a letter is the one it represents. */
static int read_own_phone(const struct json_place *at, const struct speech_pack *pack,
                          struct spelling_letter *l) {
    struct json_place first = json_place_item(at, 0);
    const char *name;
    if (json_place_array(at) || json_place_text(&first, &name))
        return -1;
    l->phone = speech_pack_phone(pack, name, strlen(name));
    return l->phone && l->phone->group ? 0 : json_place_fail(&first, "there is no phone \"%s\"", name);
}

static int read_letters(struct spelling *s, const struct json_place *at, const struct speech_pack *pack) {
    static const char *const vowel_keys[] = {"class", "shape", "ms", "shows", NULL};
    static const char *const consonant_keys[] = {"shapes", "ms", "shows", NULL};
    if (json_place_object(at))
        return -1;
    s->letters = mem_alloc((json_object_size(at->json) + 1) * sizeof *s->letters);
    const char *key;
    json_t *value;
    json_object_foreach(at->json, key, value) {
        struct json_place child = json_place_key(at, key), shapes = json_place_key(&child, "shapes"),
                          ms = json_place_key(&child, "ms"), shows = json_place_key(&child, "shows");
        struct spelling_letter *l = &s->letters[s->letter_count++];
        double duration;
        if (json_place_keys(&child, shapes.json ? consonant_keys : vowel_keys) ||
            read_code(&child, key, &l->code) || json_place_real(&ms, 1, 1000, &duration) ||
            read_own_phone(&shows, pack, l) ||
            (shapes.json ? read_consonant(s, &shapes, l) : read_vowel(s, &child, l)))
            return -1;
        l->seconds = duration / 1000;
    }
    return 0;
}

static int read_folds(struct spelling *s, const struct json_place *at) {
    if (json_place_object(at))
        return -1;
    s->folds = mem_alloc((json_object_size(at->json) + 1) * sizeof *s->folds);
    const char *key;
    json_t *value;
    json_object_foreach(at->json, key, value) {
        struct json_place child = json_place_key(at, key);
        struct spelling_fold *fold = &s->folds[s->fold_count];
        const char *text;
        if (read_code(&child, key, &fold->code) || json_place_text(&child, &text))
            return -1;
        fold->text = mem_strdup(text);
        s->fold_count++;
        struct spelled *letters;
        size_t count = spelling_read(s, text, &letters), characters = 0;
        free(letters);
        for (const char *c = text; *c; c++)
            characters += ((unsigned char)*c & 0xC0) != 0x80;
        if (count != characters)
            return json_place_fail(&child, "must be made of the letters");
    }
    return 0;
}

static int read_spelling(void *self, const struct json_place *root, const struct speech_pack *pack) {
    struct json_place fold = json_place_key(root, "fold"), letters = json_place_key(root, "letters");
    return read_letters(self, &letters, pack) || read_folds(self, &fold) ? -1 : 0;
}

static void free_table(void *spelling) {
    spelling_free(spelling);
}

struct spelling *spelling_load(const char *path, const struct speech_pack *pack, struct error *e) {
    static const char *const keys[] = {"name", "sources", "classes", "neutral",
                                       "fold", "letters", "shapes",  NULL};
    static const struct shape_table_kind kind = {sizeof(struct spelling),
                                                 SPELLING_MAX_CLASSES,
                                                 keys,
                                                 "shapes",
                                                 "neutral",
                                                 "letters",
                                                 read_spelling,
                                                 free_table};
    return shape_table_load(&kind, path, pack, e);
}

void spelling_free(struct spelling *spelling) {
    if (!spelling)
        return;
    for (size_t i = 0; i < spelling->fold_count; i++)
        free(spelling->folds[i].text);
    shape_table_free(&spelling->common);
    free(spelling->letters);
    free(spelling->folds);
    free(spelling);
}

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

/* folded: the text is the result of a fold. */
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
    size_t begin = 0, syllable = 0; /* of the open syllable */
    for (size_t i = 0; i < count; i++) {
        if (letters[i].letter->vowel) {
            if (vowel) { /* starts the next syllable, with the consonant before the vowel */
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
    if (!letter->vowel) /* a word without vowels uses the first class */
        return l->like_vowel ? spelling->common.rest : l->shapes[0];
    return l->like_vowel ? letter->vowel->shapes[0] : l->shapes[letter->vowel->class];
}
