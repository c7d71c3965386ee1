/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/face/packs/phone_match.h"
#include "server/base/json/json_place.h"
#include "server/base/mem.h"
#include "server/base/utf8.h"
#include "server/face/packs/speech_pack_internal.h"
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char *const heights[] = {"close",    "near-close", "close-mid", "mid",
                                      "open-mid", "near-open",  "open",      NULL};
static const char *const depths[] = {"front", "near-front", "central", "near-back", "back", NULL};
static const char *const lips[] = {"unrounded", "rounded", NULL};
static const char *const voices[] = {"voiceless", "voiced", NULL};
static const char *const manners[] = {"plosive",   "nasal",       "trill",   "tap",
                                      "fricative", "approximant", "lateral", NULL};

/* Visible appearance of places of articulation. Places that look different are far apart. */
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

/* Visual and, less, acoustic distance of two letters; 0 for equal ones. Differences on the lips weigh
 * most. */
static double letter_distance(const struct letter *a, const struct letter *b) {
    if (a->vowel != b->vowel)
        return 100;
    if (a->vowel)
        return 3 * fabs(a->rounded - b->rounded) + 3 * fabs(a->height - b->height) +
               fabs(a->depth - b->depth);
    double places = fabs((double)a->place - (double)b->place);
    return (place_looks[a->place] != place_looks[b->place] ? 10 : 0) + 0.5 * places +
           (a->manner != b->manner ? 1 : 0) + 0.3 * fabs(a->voiced - b->voiced);
}

/* Marks that modify or join letters: combining diacritics (U+0300..U+036F, including ties,
 * U+1DC0..U+1DFF), spacing modifier letters (U+02B0..U+02FF: length, aspiration, stress, tones...) and
 * raised ones (U+1D2C..U+1D6A, U+2070..U+209F: prenasalised and the like). */
static bool alphabet_is_modifier(uint32_t code) {
    return (code >= 0x2B0 && code <= 0x36F) || (code >= 0x1D2C && code <= 0x1D6A) ||
           (code >= 0x1DC0 && code <= 0x1DFF) || (code >= 0x2070 && code <= 0x209F);
}

enum { NAME_BYTES = 64 };

static int compare(const char *key, const char *s, size_t n) {
    int order = strncmp(key, s, n);
    return order ? order : key[n] != '\0';
}

static const struct speech_phone *find_ipa(const struct speech_pack *pack, const char *s, size_t n) {
    for (; pack; pack = pack->base) {
        size_t low = 0, high = pack->phone_count;
        while (low < high) {
            size_t mid = (low + high) / 2;
            int order = compare(pack->phones[mid]->ipa, s, n);
            if (!order)
                return pack->phones[mid];
            if (order < 0)
                low = mid + 1;
            else
                high = mid;
        }
    }
    return NULL;
}

static const struct speech_phone *find_sampa(const struct speech_pack *pack, const char *s, size_t n) {
    for (; pack; pack = pack->base)
        for (size_t i = 0; i < pack->phone_count; i++)
            if (!compare(pack->phones[i]->sampa, s, n))
                return pack->phones[i];
    return NULL;
}

const struct speech_phone *speech_pack_phone(const struct speech_pack *pack, const char *key, size_t bytes) {
    const struct speech_phone *phone = find_ipa(pack, key, bytes);
    return phone ? phone : find_sampa(pack, key, bytes);
}

/* Splits precomposed nasal vowels: returns the letter before the tilde. */
static uint32_t without_tilde(uint32_t code) {
    static const uint32_t letters[][2] = {{0xE3, 'a'},  {0xF5, 'o'},   {0x129, 'i'},
                                          {0x169, 'u'}, {0x1EBD, 'e'}, {0x1EF9, 'y'}};
    for (size_t i = 0; i < sizeof letters / sizeof *letters; i++)
        if (letters[i][0] == code)
            return letters[i][1];
    return 0;
}

/* Copies without ties and stress marks, which keys do not contain, and with tildes separate. */
static size_t clean(const char *ipa, char out[NAME_BYTES]) {
    size_t n = strlen(ipa), used = 0, step;
    for (size_t i = 0; i < n; i += step) {
        uint32_t code;
        step = utf8_next(ipa + i, n - i, &code);
        if (!step) {
            step = 1;
            continue;
        }
        bool is_tie = code == 0x361 || code == 0x35C, is_stress = code == 0x2C8 || code == 0x2CC;
        if (is_tie || is_stress || used + step >= NAME_BYTES)
            continue;
        uint32_t letter = without_tilde(code);
        if (letter && used + 3 < NAME_BYTES) {
            out[used++] = (char)letter;
            used += utf8_put(0x303, out + used);
            continue;
        }
        memcpy(out + used, ipa + i, step);
        used += step;
    }
    out[used] = '\0';
    return used;
}

static const struct speech_phone *longest(const struct speech_pack *pack, const char *s, size_t n,
                                          size_t *used) {
    size_t most = n < pack->longest ? n : pack->longest;
    for (*used = most; *used; --*used) {
        const struct speech_phone *phone = find_ipa(pack, s, *used);
        if (phone)
            return phone;
    }
    for (*used = most; *used; --*used) {
        const struct speech_phone *phone = find_sampa(pack, s, *used);
        if (phone)
            return phone;
    }
    return NULL;
}

static const struct speech_phone *nearest(const struct speech_pack *pack, uint32_t code) {
    const struct letter *wanted = alphabet_find(pack->alphabet, code), *letters = pack->alphabet->letters;
    const struct speech_phone *best = NULL;
    double least = 0;
    for (; wanted && pack; pack = pack->base) {
        for (size_t i = 0; i < pack->phone_count; i++) {
            const struct speech_phone *phone = pack->phones[i];
            if (!phone->feature_letter || !phone->group)
                continue;
            double distance = letter_distance(wanted, &letters[phone->feature_letter - 1]);
            if (!best || distance < least) {
                best = phone;
                least = distance;
            }
        }
    }
    return best;
}

static void add(struct phone_matches *out, const struct speech_phone *phone, double share) {
    if (out->count && out->match[out->count - 1].phone == phone)
        out->match[out->count - 1].share += share;
    else if (out->count < PHONE_MATCHES_MAX)
        out->match[out->count++] = (struct phone_match){phone, share};
}

static void add_whole(struct phone_matches *out, const struct speech_phone *phone) {
    if (!phone->part_count)
        add(out, phone, 1);
    for (size_t i = 0; i < phone->part_count; i++)
        add(out, phone->parts[i].phone, phone->parts[i].share);
}

void phone_match_find(const struct speech_pack *pack, const char *ipa, struct phone_matches *out) {
    char name[NAME_BYTES];
    size_t n = clean(ipa, name), used;
    out->count = 0;
    out->unknown = 0;
    out->stand_in = NULL;
    for (size_t i = 0; i < n; i += used) {
        const struct speech_phone *phone = longest(pack, name + i, n - i, &used);
        if (phone) {
            add_whole(out, phone);
            continue;
        }
        uint32_t code;
        used = utf8_next(name + i, n - i, &code);
        if (alphabet_is_modifier(code))
            continue;
        phone = nearest(pack, code);
        if (phone)
            add_whole(out, phone);
        if (!out->unknown) {
            out->unknown = code;
            out->stand_in = phone;
        }
    }
    double sum = 0;
    for (size_t i = 0; i < out->count; i++)
        sum += out->match[i].share;
    for (size_t i = 0; i < out->count; i++)
        out->match[i].share /= sum;
}
