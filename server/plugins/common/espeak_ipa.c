/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/mem.h"
#include "server/base/utf8.h"
#include "server/plugins/common/espeak_align.h"
#include "server/plugins/common/espeak_text.h"
#include <espeak-ng/speak_lib.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define PRIMARY "\u02C8"
#define SECONDARY "\u02CC"

static int by_ipa(const void *a, const void *b) {
    return strcmp(((const struct es_ipa_phone *)a)->ipa, ((const struct es_ipa_phone *)b)->ipa);
}

static const struct es_ipa_phone *find(const struct es_ipa *table, const char *ipa, size_t bytes) {
    struct es_ipa_phone key = {0};
    if (!bytes || bytes >= sizeof key.ipa || !table->count)
        return NULL;
    memcpy(key.ipa, ipa, bytes);
    return bsearch(&key, table->list, table->count, sizeof key, by_ipa);
}

/* Gets the phone that the engine speaks for "[[name]]", without stress; "" unless it is exactly one. */
static void ask(const char *name, int mode, char out[20]) {
    char text[12];
    const void *at = text;
    snprintf(text, sizeof text, "[[%s]]", name);
    const char *said = espeak_TextToPhonemes(&at, espeakCHARS_UTF8, mode | ES_SEPARATOR << 8);
    *out = '\0';
    if (!said)
        return;
    while (*said == ES_SEPARATOR || *said == ' ' || !strncmp(said, PRIMARY, 2) ||
           !strncmp(said, SECONDARY, 2))
        said += (unsigned char)*said < 0x80 ? 1 : 2;
    size_t length = strcspn(said, " \n\x1f");
    if (length < 20 && !said[length + strspn(said + length, " \n\x1f")]) {
        memcpy(out, said, length);
        out[length] = '\0';
    }
}

/* Adds the phone of that name, if any. Returns whether longer names may begin with it. */
static bool learn(struct es_ipa *table, const char *name) {
    char again[20], ipa[20];
    ask(name, 0, again);
    if (strcmp(again, name) != 0)
        return false;
    ask(name, espeakPHONEMES_IPA, ipa);
    for (size_t i = 0; i < table->count; i++)
        if (!strcmp(table->list[i].ipa, ipa))
            return true; /* the shortest name wins */
    if (!*ipa)
        return true;
    table->list = mem_grow(table->list, &table->cap, table->count + 1, sizeof *table->list);
    struct es_ipa_phone *phone = &table->list[table->count++];
    *phone = (struct es_ipa_phone){0};
    memcpy(phone->ipa, ipa, sizeof phone->ipa);
    snprintf(phone->name, sizeof phone->name, "%s", name);
    return true;
}

/* Names are printable ASCII without characters that are special between the brackets. */
static bool is_name_character(char c) {
    return c > ' ' && c < 0x7F && !strchr("[]|'%,=_\\/$(){}", c);
}

static void learn_all(struct es_ipa *table) {
    char names[2][8192][4]; /* names of the current and the next length that longer ones may extend */
    size_t counts[2] = {1, 0};
    strcpy(names[0][0], "");
    for (size_t length = 1; length <= 3; length++) {
        char(*shorter)[4] = names[(length + 1) % 2], (*longer)[4] = names[length % 2];
        counts[length % 2] = 0;
        for (size_t i = 0; i < counts[(length + 1) % 2]; i++)
            for (char c = ' '; c < 0x7F; c++) {
                char name[5];
                if (!is_name_character(c))
                    continue;
                snprintf(name, sizeof name, "%s%c", shorter[i], c);
                /* a name of two letters may be valid even if its first letter is not */
                if ((learn(table, name) || length == 1) && counts[length % 2] < 8192)
                    strcpy(longer[counts[length % 2]++], name);
            }
    }
    if (table->count)
        qsort(table->list, table->count, sizeof *table->list, by_ipa);
}

bool es_ipa_learn(struct es_ipa *table, const struct faccia_sentence *sentence, void *user_data) {
    bool needed = false;
    for (size_t i = 0; i < sentence->span_count; i++)
        needed |= sentence->spans[i].phones != NULL;
    if (!needed || table->count)
        return false;
    /* the engine accepts "[[...]]" only after a text with phonemes enabled */
    espeak_Synth(" ", 2, 0, POS_CHARACTER, 0, espeakCHARS_UTF8 | espeakPHONEMES, NULL, user_data);
    learn_all(table);
    return true;
}

void es_ipa_free(struct es_ipa *table) {
    free(table->list);
    *table = (struct es_ipa){0};
}

/* Other notations of a phone, and related phones by similarity. */
static const char *const relatives[][4] = {
    {"g", "\u0261"},
    {"\u0261", "g"},
    {"\u02A7", "t\u0283"},
    {"\u02A4", "d\u0292"},
    {"\u02A6", "ts"},
    {"\u02A3", "dz"},
    {"r", "\u027E", "\u0279", "\u0281"},
    {"\u027E", "r", "\u0279"},
    {"\u0279", "r", "\u027E"},
    {"\u0281", "\u0280", "r", "\u0279"},
    {"\u0280", "\u0281", "r"},
    {"\u0250", "a", "\u0259"},
    {"\u0251", "a"},
    {"\u0252", "\u0254", "o"},
    {"a", "\u0251", "\u00E6"},
    {"\u00E6", "a", "\u025B"},
    {"\u028C", "\u0250", "a"},
    {"\u026A", "i"},
    {"i", "\u026A"},
    {"\u028A", "u"},
    {"u", "\u028A"},
    {"\u025B", "e"},
    {"e", "\u025B"},
    {"\u0254", "o"},
    {"o", "\u0254"},
    {"\u0259", "\u0250", "\u025C", "e"},
    {"\u025C", "\u0259", "e"},
    {"\u025A", "\u0259"},
    {"\u025D", "\u025C\u02D0", "\u025C", "\u025A"},
    {"\u0268", "\u026A", "i"},
    {"\u026F", "\u0268", "u"},
    {"\u00F8", "\u0153", "e"},
    {"\u0153", "\u00F8", "\u025B"},
    {"y", "\u028F", "i"},
    {"\u026B", "l"},
    {"\u028B", "v", "w"},
    {"\u03B2", "b", "v"},
    {"\u00F0", "d", "z"},
    {"\u03B8", "t", "s"},
    {"\u0263", "\u0261", "g"},
    {"x", "h", "k"},
    {"\u00E7", "x", "\u0283"},
    {"h", "x"},
    {"c", "k"},
    {"\u025F", "\u0261", "g"},
    {"\u014B", "n"},
    {"\u0272", "n"},
    {"\u028E", "l"},
    {"w", "u"},
    {"j", "i"},
    {"\u0265", "w"},
};

static bool is_vowel(uint32_t c) {
    static const uint32_t vowels[] = {'a',   'e',   'i',   'o',   'u',   'y',    0xE6,  0xF8,  0x153,
                                      0x250, 0x251, 0x252, 0x254, 0x258, 0x259,  0x25A, 0x25B, 0x25C,
                                      0x25D, 0x25E, 0x264, 0x268, 0x26A, 0x26F,  0x275, 0x276, 0x289,
                                      0x28A, 0x28C, 0x28F, 0xE3,  0xF5,  0x1EBD, 0x129, 0x169};
    for (size_t i = 0; i < sizeof vowels / sizeof *vowels; i++)
        if (c == vowels[i])
            return true;
    return false;
}

/* Ties, syllable breaks, links, feet. */
static bool is_silent(uint32_t c) {
    return c == 0x361 || c == 0x35C || c == '.' || c == 0x203F || c == '|' || c == 0x2016 || c == '-' ||
           c == 0x200D || c == 0x200C || c == '/' || c == '[' || c == ']';
}

/* Removes silent marks and normalises the length mark. */
static void clean(const char *ipa, size_t bytes, struct buf *out) {
    for (size_t at = 0, length; at < bytes; at += length) {
        uint32_t c;
        length = utf8_next(ipa + at, bytes - at, &c);
        if (!length)
            c = length = 1;
        if (c == ':')
            buf_add(out, "\u02D0", 2);
        else if (c == '\'')
            buf_add(out, PRIMARY, 2);
        else if (!is_silent(c))
            buf_add(out, ipa + at, length);
    }
}

/* Returns the longest phone that the text begins with. */
static const struct es_ipa_phone *longest(const struct es_ipa *table, const char *s, size_t bytes,
                                          size_t *used) {
    for (size_t n = bytes < 16 ? bytes : 16; n; n--) {
        const struct es_ipa_phone *phone = find(table, s, n);
        if (phone) {
            *used = n;
            return phone;
        }
    }
    return NULL;
}

/* Marks on a phone, such as length, that the voice does not have. */
static bool is_diacritic(uint32_t c) {
    return (c >= 0x300 && c < 0x370) || (c >= 0x2B0 && c < 0x2C8) || (c >= 0x2CD && c < 0x300);
}

static const struct es_ipa_phone *relative(const struct es_ipa *table, const char *s, size_t length) {
    for (size_t i = 0; i < sizeof relatives / sizeof *relatives; i++) {
        if (strlen(relatives[i][0]) != length || memcmp(relatives[i][0], s, length) != 0)
            continue;
        for (size_t k = 1; k < 4 && relatives[i][k]; k++) {
            const struct es_ipa_phone *phone = find(table, relatives[i][k], strlen(relatives[i][k]));
            if (phone)
                return phone;
        }
    }
    return NULL;
}

int es_ipa_word(const struct es_ipa *table, const char *ipa, size_t bytes, struct buf *out, char unknown[8],
                bool *changed) {
    struct buf word = {0};
    size_t before = out->size, used;
    const char *stress = "";
    clean(ipa, bytes, &word);
    buf_add(out, "[[", 2);
    const char *s = (const char *)word.data;
    int result = 0;
    for (size_t at = 0; at < word.size && !result; at += used) {
        size_t left = word.size - at;
        uint32_t c = 0;
        size_t length = utf8_next(s + at, left, &c);
        used = length ? length : 1;
        if (left >= 2 && (!memcmp(s + at, PRIMARY, 2) || !memcmp(s + at, SECONDARY, 2))) {
            stress = memcmp(s + at, PRIMARY, 2) ? "," : "'";
            continue;
        }
        const struct es_ipa_phone *phone = longest(table, s + at, left, &used);
        if (!phone && is_diacritic(c)) {
            *changed = true;
            continue;
        }
        if (!phone) {
            used = length ? length : 1;
            phone = relative(table, s + at, used);
            *changed |= c != 'g' && c != 0x261;
        }
        if (!phone) {
            snprintf(unknown, 8, "%.*s", (int)used, s + at);
            result = -1;
            break;
        }
        /* the engine expects stress right before the vowel, not before its syllable */
        if (*stress && is_vowel(c)) {
            buf_add(out, stress, 1);
            stress = "";
        }
        buf_add(out, phone->name, strlen(phone->name));
        if (at + used < word.size)
            buf_add(out, "|", 1); /* keeps adjacent names apart */
    }
    buf_add(out, "]]", 2);
    buf_free(&word);
    if (result)
        out->size = before;
    return result;
}
