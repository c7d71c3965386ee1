/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/face/packs/phone_match.h"
#include "server/base/utf8.h"
#include <string.h>

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

/* Nasal vowels may come as one character: their letter, which a tilde follows. */
static uint32_t without_tilde(uint32_t code) {
    static const uint32_t letters[][2] = {{0xE3, 'a'},  {0xF5, 'o'},   {0x129, 'i'},
                                          {0x169, 'u'}, {0x1EBD, 'e'}, {0x1EF9, 'y'}};
    for (size_t i = 0; i < sizeof letters / sizeof *letters; i++)
        if (letters[i][0] == code)
            return letters[i][1];
    return 0;
}

/* Copies without ties and stress marks, which keys do not have, and with tildes set apart. */
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
