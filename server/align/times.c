/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/align/times_internal.h"
#include "server/base/buf.h"
#include "server/base/mem.h"
#include "server/base/utf8.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define SECONDS_MAX 36000
/* Files round their times. */
#define SAME_TIME 0.001
enum { LINE_BYTES = 512 };

const char *const times_format_names[TIMES_FORMATS] = {"lab", "htk", "textgrid", "json", "offsets"};

int times_fail(const struct times_reader *r, const char *what, const char *name) {
    return error_at_line(r->e, TIMES_CODE, r->line, 1, "%s%.60s", what, name);
}

bool times_is_pause(const char *name) {
    static const char *const names[] = {"", "_", "#", "##", "pau", "sil", "sp", "SIL", "<p:>", NULL};
    const char *const *n = names;
    while (*n && strcmp(*n, name) != 0)
        n++;
    return *n;
}

static const char *ipa_of(struct times_reader *r, const char *name) {
    const json_t *names = r->options->names;
    const char *ipa = json_string_value(json_object_get(names, name));
    if (ipa)
        return ipa;
    if (names && !times_is_pause(name) && !*r->times->unnamed)
        snprintf(r->times->unnamed, sizeof r->times->unnamed, "%s", name);
    return times_is_pause(name) ? "" : name;
}

/* Takes the stress mark off an IPA name's beginning. */
static const char *stress_of(const char *ipa, uint8_t *stress) {
    static const char *const marks[] = {"\u02CC", "\u02C8"};
    for (uint8_t i = 0; i < 2; i++)
        if (!strncmp(ipa, marks[i], strlen(marks[i]))) {
            *stress = i + 1;
            return ipa + strlen(marks[i]);
        }
    return ipa;
}

static bool in_order(double *start, double end, double before) {
    if (*start<before && * start> before - SAME_TIME)
        *start = before;
    return *start >= before && end >= *start && end < SECONDS_MAX;
}

bool times_add_phone(struct times_reader *r, const char *name, double start, double end, uint32_t stress) {
    struct times *t = r->times;
    if (!in_order(&start, end, t->phone_count ? t->phones[t->phone_count - 1].end : 0))
        return false;
    t->phones = mem_grow(t->phones, &t->phone_cap, t->phone_count + 1, sizeof *t->phones);
    struct times_phone *p = &t->phones[t->phone_count++];
    *p = (struct times_phone){.start = start, .end = end, .stress = stress < 2 ? (uint8_t)stress : 2};
    snprintf(p->name, sizeof p->name, "%s", name);
    snprintf(p->ipa, sizeof p->ipa, "%s", stress_of(ipa_of(r, name), &p->stress));
    return true;
}

bool times_add_word(struct times_reader *r, const char *text, double start, double end) {
    struct times *t = r->times;
    if (!in_order(&start, end, t->word_count ? t->words[t->word_count - 1].start : 0))
        return false;
    t->words = mem_grow(t->words, &t->word_cap, t->word_count + 1, sizeof *t->words);
    t->words[t->word_count++] = (struct times_word){mem_strdup(text), start, end};
    return true;
}

bool times_next_line(struct times_reader *r, char *out, size_t cap) {
    if (r->at >= r->end)
        return false;
    size_t length = strcspn(r->at, "\r\n"), keep = length < cap ? length : cap - 1;
    memcpy(out, r->at, keep);
    out[keep] = '\0';
    r->at += length;
    r->at += *r->at == '\r' && r->at[1] == '\n' ? 2 : *r->at != '\0';
    r->line++;
    return true;
}

/* UTF-8 with a NUL behind it, from UTF-8 or UTF-16 with a byte order mark. */
static int decode(const char *data, size_t size, struct buf *out, struct error *e) {
    const uint8_t *b = (const uint8_t *)data;
    bool little = size >= 2 && b[0] == 0xFF && b[1] == 0xFE, big = size >= 2 && b[0] == 0xFE && b[1] == 0xFF;
    for (size_t i = 2; (little || big) && i + 1 < size; i += 2) {
        uint32_t cp = little ? b[i] | (uint32_t)b[i + 1] << 8 : b[i + 1] | (uint32_t)b[i] << 8;
        if (cp >= 0xD800 && cp < 0xDC00 && i + 3 < size) {
            uint32_t low = little ? b[i + 2] | (uint32_t)b[i + 3] << 8 : b[i + 3] | (uint32_t)b[i + 2] << 8;
            cp = 0x10000 + ((cp - 0xD800) << 10) + ((low - 0xDC00) & 0x3FF);
            i += 2;
        }
        char text[4];
        size_t length = utf8_put(cp, text);
        if (!length || !cp)
            return error_at_byte(e, TIMES_CODE, i, "the file is not UTF-16");
        buf_add(out, text, length);
    }
    if (!little && !big) {
        size_t skip = size >= 3 && !memcmp(b, "\xEF\xBB\xBF", 3) ? 3 : 0, bad = utf8_check(data, size);
        const char *nul = size ? memchr(data, '\0', size) : NULL;
        if (nul && (size_t)(nul - data) < bad)
            bad = (size_t)(nul - data);
        if (bad < size)
            return error_at_byte(e, TIMES_CODE, bad, "the file is neither UTF-8 nor UTF-16");
        if (size)
            buf_add(out, data + skip, size - skip);
    }
    buf_add(out, "", 1);
    return 0;
}

/* What the beginning looks like. */
static enum times_format guess(const char *text) {
    char line[LINE_BYTES], third[8];
    double a, b;
    int used = 0;
    struct times_reader r = {.at = text, .end = text + strlen(text)};
    text += strspn(text, " \t\r\n");
    if (*text == '{')
        return TIMES_JSON;
    if (!strncmp(text, "#!MLF!#", 7))
        return TIMES_HTK;
    if (!strncmp(text, "File type", 9) || !strncmp(text, "\"ooTextFile", 11))
        return TIMES_TEXTGRID;
    if (sscanf(text, "%*u : %*u%n", &used) == 0 && used)
        return TIMES_OFFSETS;
    while (times_next_line(&r, line, sizeof line))
        if (line[strspn(line, " \t")]) {
            /* 0 1200000 a, not 0.12 100 a; the header of a .lab is no such line */
            bool htk = sscanf(line, "%lf %lf %7s", &a, &b, third) == 3 && !strchr(line, '.') && b > a;
            return htk ? TIMES_HTK : TIMES_LAB;
        }
    return TIMES_LAB;
}

static int read_offsets(struct times_reader *r) {
    const struct transcription_sound *sound =
        r->options->sound.rate ? &r->options->sound : &transcription_wav;
    if (!r->options->pack)
        return error_set(r->e, TIMES_CODE, "byte offsets need a language with a table of symbols, pt-BR");
    struct sentence_audio *u =
        transcription_read(r->at, (size_t)(r->end - r->at), sound, r->options->pack, r->e);
    bool well = u != NULL;
    for (size_t i = 0; well && i < u->phone_count; i++) {
        const struct phone *p = &u->phones[i];
        double rate = u->sample_rate;
        well = times_add_phone(r, p->ipa, p->start / rate, p->end / rate, p->stress);
    }
    if (u && !well)
        error_set(r->e, TIMES_CODE, "the sound is too long");
    sentence_audio_free(u);
    return well ? 0 : -1;
}

int times_read(struct times *times, const struct times_options *options, const char *data, size_t size,
               struct error *e) {
    static int (*const readers[TIMES_FORMATS])(struct times_reader *) = {
        times_read_lab, times_read_htk, times_read_textgrid, times_read_json, read_offsets};
    struct buf text = {0};
    *times = (struct times){0};
    int result = decode(data, size, &text, e);
    if (!result) {
        const char *start = (const char *)text.data;
        struct times_reader r = {times, options, start, start + text.size - 1, 0, e};
        result = readers[options->format == TIMES_GUESS ? guess(start) : options->format](&r);
    }
    if (!result && !times->phone_count)
        result = error_set(e, TIMES_CODE, "there are no phones");
    buf_free(&text);
    return result;
}

void times_free(struct times *times) {
    for (size_t i = 0; i < times->word_count; i++)
        free(times->words[i].text);
    free(times->phones);
    free(times->words);
    *times = (struct times){0};
}
