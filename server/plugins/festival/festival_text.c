/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/mem.h"
#include "server/base/utf8.h"
#include "server/plugins/festival/festival_internal.h"
#include <ctype.h>
#include <iconv.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define STRETCH_MIN 0.25
#define STRETCH_MAX 4.0
#define FACTOR_MIN 0.25
#define FACTOR_MAX 4.0
#define RAMP_SECONDS 0.004 /* time constant */

/* Samples above KNEE are compressed to stay below LIMIT. */
#define KNEE 24000.0
#define LIMIT 32000.0

static double between(double low, double x, double high) {
    return x < low ? low : x > high ? high : x;
}

struct fe_prosody fe_prosody_of(const struct fe_voice *voice, const struct faccia_span *span) {
    /* rate, pitch, range, volume for each level: none, reduced, weak, medium, strong */
    static const double levels[][4] = {
        {1, 1, 1, 1}, {1.1, 0.95, 0.8, 0.85}, {1, 1, 1, 1}, {0.92, 1.08, 1.2, 1.15}, {0.85, 1.15, 1.4, 1.3}};
    const double *level = levels[span->emphasis < 5 ? span->emphasis : 4];
    double rate = (span->rate > 0 ? span->rate / voice->info.rate : 1) * level[0];
    struct fe_prosody p = {
        .pitch = (span->pitch > 0 ? span->pitch : 1) * level[1],
        .range = (span->range >= 0 ? span->range : 1) * level[2],
        .volume = (span->volume >= 0 ? span->volume : 1) * level[3],
    };
    p.stretch = between(STRETCH_MIN, rate > 0 ? 1 / rate : 1, STRETCH_MAX);
    p.pitch = between(FACTOR_MIN, p.pitch, FACTOR_MAX);
    p.range = between(0.01, p.range, FACTOR_MAX);
    p.volume = between(0, p.volume, FACTOR_MAX);
    return p;
}

static double bend(double x) {
    double size = fabs(x);
    return size <= KNEE ? x : copysign(KNEE + (LIMIT - KNEE) * tanh((size - KNEE) / (LIMIT - KNEE)), x);
}

void fe_amplify(int16_t *samples, size_t from, size_t to, uint32_t sample_rate, double gain, double volume,
                double *now) {
    const double step = 1 - exp(-1 / (RAMP_SECONDS * sample_rate));
    for (size_t i = from; i < to; i++) {
        *now += (volume - *now) * step;
        samples[i] = (int16_t)lrint(bend(samples[i] * gain * *now));
    }
}

static const char opening[] = "\"'`({[";

struct fe_reader {
    struct fe_tokens *out;
    const struct fe_language *language;
    uint32_t span;
    const char *text;
    bool spell;
    struct fe_token token; /* token being built; without a word yet, only what precedes it */
    size_t used;           /* bytes of its word */
    bool spaced;           /* white space since the last word */
};

static void append(char *to, size_t cap, const char *s) {
    size_t length = strlen(to);
    if (length + strlen(s) < cap)
        strcpy(to + length, s);
}

static bool is_space(uint32_t c) {
    return c <= ' ' || c == 0x7F || (c >= 0x80 && c <= 0xA0) || c == 0xAD || (c >= 0x2000 && c <= 0x200F) ||
           (c >= 0x2028 && c <= 0x202F) || c == 0x3000 || c == 0xFEFF;
}

/* Completes the token. */
static void end_word(struct fe_reader *r) {
    if (!r->used)
        return;
    struct fe_tokens *out = r->out;
    out->list = mem_grow(out->list, &out->cap, out->count + 1, sizeof *out->list);
    out->list[out->count++] = r->token;
    r->token = (struct fe_token){.span = r->span};
    r->used = 0;
}

/* Adds a character of the word, from text[at..at + bytes). */
static void add_letter(struct fe_reader *r, char c, size_t at, size_t bytes) {
    if (r->used == FE_WORD_BYTES - 1 || (r->spell && r->used))
        end_word(r);
    if (!r->used)
        r->token.offset = at;
    r->spaced = false;
    r->token.word[r->used++] = c;
    r->token.bytes = at + bytes - r->token.offset;
}

/* Belongs to the previous word, even after a space (a dash), unless it opens the next one. */
static void add_punctuation(struct fe_reader *r, char c) {
    const char s[2] = {c, '\0'};
    end_word(r);
    if (r->spaced && strchr(opening, c))
        append(r->token.before, FE_PUNCTUATION_BYTES, s);
    else if (r->out->count && strchr(r->language->punctuation, c))
        append(r->out->list[r->out->count - 1].after, FE_PUNCTUATION_BYTES, s);
}

/* A combining accent after its vowel (Unicode form D): grave 0x300, acute 0x301. */
static void add_accent(struct fe_reader *r, uint32_t accent, size_t at, size_t length) {
    static const char vowels[] = "aeiouAEIOU";
    static const unsigned char grave[] = {0xE0, 0xE8, 0xEC, 0xF2, 0xF9, 0xC0, 0xC8, 0xCC, 0xD2, 0xD9};
    char *last = r->used ? &r->token.word[r->used - 1] : NULL;
    const char *vowel = last ? strchr(vowels, *last) : NULL;
    if (!vowel || !*vowel || accent > 0x301)
        return;
    if (*r->language->letters)
        *last = (char)(grave[vowel - vowels] + (accent - 0x300));
    r->token.bytes = at + length - r->token.offset;
}

/* Adds words that replace one character of the text. */
static void add_words(struct fe_reader *r, const char *words, size_t at, size_t bytes);

static void add_unread(struct fe_tokens *out, const char *s, size_t length) {
    char c[5] = "";
    memcpy(c, s, length);
    if (!strstr(out->unread, c))
        append(out->unread, sizeof out->unread, c);
}

/* Tells whether an ASCII character is part of a word. */
static bool joins(const struct fe_reader *r, const char *at) {
    unsigned char before = at > r->text ? (unsigned char)at[-1] : ' ', after = (unsigned char)at[1];
    if (*at == '\'') /* l'amica, po' */
        return r->used || after >= 0x80 || isalpha(after);
    if (*at == '-')
        return r->used && (after >= 0x80 || isalpha(after));
    return strchr(".,:", *at) && r->used && isdigit(before) && isdigit(after) && !r->spell;
}

static void add_ascii(struct fe_reader *r, const char *at, size_t place, size_t bytes, bool whole) {
    if (isalnum((unsigned char)*at) || (whole && joins(r, at)))
        add_letter(r, *at, place, bytes);
    else if (strchr("\"'`.,:;!?(){}[]", *at))
        add_punctuation(r, *at);
    else
        end_word(r);
}

/* Replaces a character unknown to Festival by similar ASCII ones (the C library's transliteration). */
static void add_foreign(struct fe_reader *r, const char *s, size_t length, size_t place) {
    char ascii[16] = "", *in = (char *)s, *out = ascii;
    size_t in_left = length, out_left = sizeof ascii - 1;
    iconv_t converter = iconv_open("ASCII//TRANSLIT", "UTF-8");
    if (converter != (iconv_t)-1) {
        iconv(converter, &in, &in_left, &out, &out_left);
        iconv_close(converter);
    }
    *out = '\0';
    if (!*ascii || strchr(ascii, '?')) {
        add_unread(r->out, s, length);
        end_word(r);
        return;
    }
    for (const char *c = ascii; *c; c++)
        add_ascii(r, c, place, length, false);
}

static void add_character(struct fe_reader *r, size_t at, uint32_t c, size_t length) {
    const char *s = r->text + at;
    char key[5] = "";
    memcpy(key, s, length);
    const char *words = json_string_value(json_object_get(r->language->symbols, key));
    bool slash = c == '/' && r->used && isdigit((unsigned char)s[1]) && !r->spell; /* 25/12 */
    if (slash) {
        add_letter(r, '/', at, 1);
    } else if (words) {
        end_word(r);
        add_words(r, words, at, length);
    } else if (c == 0x2019 || c == 0x2018) { /* quotes, or an apostrophe */
        bool inner = r->used && s[length] && !is_space((unsigned char)s[length]);
        if (inner || (c == 0x2019 && r->used))
            add_letter(r, '\'', at, length);
        else
            add_punctuation(r, '\'');
    } else if (c == 0xAB || c == 0xBB || (c >= 0x201C && c <= 0x201F)) {
        add_punctuation(r, '"');
    } else if (c == 0x2013 || c == 0x2014) { /* a dash: a pause like a comma's */
        add_punctuation(r, ',');
    } else if (c == 0x2026) {
        add_punctuation(r, '.');
    } else if (c >= 0x300 && c < 0x370) {
        add_accent(r, c, at, length);
    } else if (c < 0x80) {
        add_ascii(r, s, at, length, true);
    } else if (c < 0x100 && strstr(r->language->letters, key)) {
        add_letter(r, (char)c, at, length);
    } else {
        add_foreign(r, s, length, at);
    }
}

static void add_words(struct fe_reader *r, const char *words, size_t at, size_t bytes) {
    uint32_t c = 0;
    for (size_t length; *words && (length = utf8_next(words, strlen(words), &c)) > 0; words += length) {
        char key[5] = "";
        memcpy(key, words, length);
        if (c == ' ')
            end_word(r);
        else if (c < 0x80 || (c < 0x100 && strstr(r->language->letters, key)))
            add_letter(r, (char)c, at, bytes);
    }
    end_word(r);
}

void fe_tokens_add(struct fe_tokens *tokens, const struct fe_language *language, uint32_t span,
                   const char *text, bool spell) {
    struct fe_reader r = {
        .out = tokens, .language = language, .span = span, .text = text, .spell = spell, .spaced = true};
    size_t size = strlen(text), length;
    r.token.span = span;
    for (size_t at = 0; at < size; at += length) {
        uint32_t c = ' ';
        length = utf8_next(text + at, size - at, &c);
        if (!length)
            length = 1;
        if (!is_space(c)) {
            add_character(&r, at, c, length);
            continue;
        }
        end_word(&r);
        r.spaced = true;
    }
    end_word(&r);
}

void fe_tokens_add_plain(struct fe_tokens *tokens, const struct fe_token *token) {
    struct fe_token part = *token;
    size_t used = 0;
    strcpy(part.after, "");
    for (const char *c = token->word; *c; c++) {
        bool digit = isdigit((unsigned char)*c),
             letter = isalpha((unsigned char)*c) || (unsigned char)*c >= 0xC0;
        if (digit || letter)
            part.word[used++] = *c;
        part.word[used] = '\0';
        if (!used || (letter && c[1] && !isdigit((unsigned char)c[1])))
            continue;
        tokens->list = mem_grow(tokens->list, &tokens->cap, tokens->count + 1, sizeof *tokens->list);
        tokens->list[tokens->count++] = part;
        strcpy(part.before, "");
        used = 0;
    }
    if (tokens->count)
        strcpy(tokens->list[tokens->count - 1].after, token->after);
}

void fe_tokens_free(struct fe_tokens *tokens) {
    free(tokens->list);
    *tokens = (struct fe_tokens){0};
}
