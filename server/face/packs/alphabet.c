/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/face/packs/alphabet.h"
#include "server/base/json_place.h"
#include "server/base/mem.h"
#include "server/base/utf8.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char *const heights[] = {"close",    "near-close", "close-mid", "mid",
                                      "open-mid", "near-open",  "open",      NULL};
static const char *const depths[] = {"front", "near-front", "central", "near-back", "back", NULL};
static const char *const lips[] = {"unrounded", "rounded", NULL};
static const char *const voices[] = {"voiceless", "voiced", NULL};
static const char *const manners[] = {"plosive",   "nasal",       "trill",   "tap",
                                      "fricative", "approximant", "lateral", NULL};

/* What an onlooker sees of a place of articulation. Places with different looks are far apart. */
enum look { LOOK_LIPS, LOOK_TEETH, LOOK_TONGUE_TIP, LOOK_PUCKER, LOOK_ROUND, LOOK_BACK };

static const char *const places[] = {
    "bilabial", "labiodental", "dental",     "alveolar", "postalveolar", "retroflex",      "palatal",
    "velar",    "uvular",      "pharyngeal", "glottal",  "labial-velar", "labial-palatal", NULL};
static const uint8_t place_looks[] = {LOOK_LIPS,   LOOK_TEETH, LOOK_TONGUE_TIP, LOOK_TONGUE_TIP, LOOK_PUCKER,
                                      LOOK_PUCKER, LOOK_BACK,  LOOK_BACK,       LOOK_BACK,       LOOK_BACK,
                                      LOOK_BACK,   LOOK_ROUND, LOOK_ROUND};

static int choose(const struct json_place *up, const char *key, const char *const *names, size_t *out) {
    struct json_place at = json_place_key(up, key);
    return json_place_choice(&at, names, out);
}

static int read_vowel(const struct json_place *at, struct letter *l) {
    static const char *const keys[] = {"height", "depth", "lips", NULL};
    size_t height, depth, rounded;
    if (json_place_keys(at, keys) || choose(at, "height", heights, &height) ||
        choose(at, "depth", depths, &depth) || choose(at, "lips", lips, &rounded))
        return -1;
    l->height = (double)height / 6;
    l->depth = (double)depth / 4;
    l->rounded = (double)rounded;
    return 0;
}

static int read_consonant(const struct json_place *at, struct letter *l) {
    static const char *const keys[] = {"place", "manner", "voice", NULL};
    size_t voiced;
    if (json_place_keys(at, keys) || choose(at, "place", places, &l->place) ||
        choose(at, "manner", manners, &l->manner) || choose(at, "voice", voices, &voiced))
        return -1;
    l->voiced = (double)voiced;
    return 0;
}

static int read_letters(struct alphabet *alphabet, const struct json_place *at, bool vowels) {
    if (json_place_object(at))
        return -1;
    const char *key;
    json_t *value;
    json_object_foreach(at->json, key, value) {
        struct json_place child = json_place_key(at, key);
        struct letter l = {.vowel = vowels};
        if (utf8_next(key, strlen(key), &l.code) != strlen(key))
            return json_place_fail(&child, "must be named by one letter");
        if (vowels ? read_vowel(&child, &l) : read_consonant(&child, &l))
            return -1;
        alphabet->letters[alphabet->count++] = l;
    }
    return 0;
}

static int by_code(const void *a, const void *b) {
    uint32_t x = ((const struct letter *)a)->code, y = ((const struct letter *)b)->code;
    return (x > y) - (x < y);
}

struct alphabet *alphabet_load(const char *path, struct error *e) {
    static const char *const keys[] = {"name", "vowels", "consonants", NULL};
    struct json_place root;
    if (json_place_load(path, ERROR_BAD_ALPHABET, &root, e))
        return NULL;
    struct json_place name = json_place_key(&root, "name"), vowels = json_place_key(&root, "vowels"),
                      consonants = json_place_key(&root, "consonants");
    struct alphabet *alphabet = mem_alloc(sizeof *alphabet);
    alphabet->letters = mem_alloc((json_object_size(vowels.json) + json_object_size(consonants.json) + 1) *
                                  sizeof(struct letter));
    const char *text;
    if (json_place_keys(&root, keys) || json_place_text(&name, &text) ||
        read_letters(alphabet, &vowels, true) || read_letters(alphabet, &consonants, false)) {
        alphabet_free(alphabet);
        alphabet = NULL;
    } else {
        qsort(alphabet->letters, alphabet->count, sizeof(struct letter), by_code);
    }
    json_decref(root.json);
    return alphabet;
}

void alphabet_free(struct alphabet *alphabet) {
    if (!alphabet)
        return;
    free(alphabet->letters);
    free(alphabet);
}

const struct letter *alphabet_find(const struct alphabet *alphabet, uint32_t code) {
    struct letter key = {.code = code};
    return bsearch(&key, alphabet->letters, alphabet->count, sizeof key, by_code);
}

double letter_distance(const struct letter *a, const struct letter *b) {
    if (a->vowel != b->vowel)
        return 100;
    if (a->vowel)
        return 3 * fabs(a->rounded - b->rounded) + 3 * fabs(a->height - b->height) +
               fabs(a->depth - b->depth);
    double places = fabs((double)a->place - (double)b->place);
    return (place_looks[a->place] != place_looks[b->place] ? 10 : 0) + 0.5 * places +
           (a->manner != b->manner ? 1 : 0) + 0.3 * fabs(a->voiced - b->voiced);
}

bool alphabet_is_modifier(uint32_t code) {
    return (code >= 0x2B0 && code <= 0x36F) || (code >= 0x1D2C && code <= 0x1D6A) ||
           (code >= 0x1DC0 && code <= 0x1DFF) || (code >= 0x2070 && code <= 0x209F);
}
