/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/library/align/times.h"
#include "server/base/buf.h"
#include "server/base/mem.h"
#include "server/base/utf8.h"
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

/* Reader of a file, shared by the formats. */

#define TIMES_CODE ERROR_BAD_TIMES

struct times_reader {
    struct times *times;
    const struct times_options *options;
    const char *at, *end; /* UTF-8 without NUL characters, NUL-terminated */
    size_t line;          /* current line, from 1 */
    struct error *e;
};

#define SECONDS_MAX 36000
/* Tolerance for rounded times. */
#define SAME_TIME 0.001

const char *const times_format_names[TIMES_FORMATS] = {"lab", "htk", "textgrid", "json", "offsets"};

/* Reports an error at the current line. Returns -1. */
static int times_fail(const struct times_reader *r, const char *what, const char *name) {
    return error_at_line(r->e, TIMES_CODE, r->line, 1, "%s%.60s", what, name);
}

/* True for a name that means a pause. */
static bool times_is_pause(const char *name) {
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

/* Strips a leading stress mark from an IPA name. */
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

/* Appends a phone that starts no earlier than the previous one ends (within rounding), does not end before
 * it starts, and lies within ten hours; otherwise false. Translates the name with options->names. */
static bool times_add_phone(struct times_reader *r, const char *name, double start, double end,
                            uint32_t stress) {
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

static bool times_add_word(struct times_reader *r, const char *text, double start, double end) {
    struct times *t = r->times;
    if (!in_order(&start, end, t->word_count ? t->words[t->word_count - 1].start : 0))
        return false;
    t->words = mem_grow(t->words, &t->word_cap, t->word_count + 1, sizeof *t->words);
    t->words[t->word_count++] = (struct times_word){mem_strdup(text), start, end};
    return true;
}

/* Copies the next line without its line ending, NUL-terminated; false at the end. Updates `line`. */
static bool times_next_line(struct times_reader *r, char *out, size_t cap) {
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

/* ---- formats with one phone per line, and JSON ---- */

#define HTK_UNIT 1e-7
enum { LINE_BYTES = 512, WORD_BYTES = 128 };

static int times_read_lab(struct times_reader *r) {
    char line[LINE_BYTES], name[32];
    double before = 0, end;
    const char *start = r->at;
    bool header = false;
    while (!header && times_next_line(r, line, sizeof line))
        header = line[0] == '#' && !line[1 + strspn(line + 1, " \t")];
    if (!header) {
        r->at = start;
        r->line = 0;
    }
    while (times_next_line(r, line, sizeof line)) {
        if (!line[strspn(line, " \t")])
            continue;
        *name = '\0';
        if (sscanf(line, "%lf %*s %31s", &end, name) < 1)
            return times_fail(r, "expected END COLOUR NAME", "");
        if (!times_add_phone(r, name, before, end, 0))
            return times_fail(r, "the phone ends before it begins", "");
        before = end;
    }
    return 0;
}

/* Finds the entry in a master label file: its quoted name, its lines, and a line ".". */
static int find_entry(struct times_reader *r) {
    char line[LINE_BYTES];
    const char *entry = r->options->entry;
    while (times_next_line(r, line, sizeof line)) {
        size_t length = strlen(line);
        if (*line != '"' || line[length - 1] != '"')
            continue;
        line[length - 1] = '\0';
        char *slash = strrchr(line, '/'), *name = slash ? slash + 1 : line + 1, *dot = strrchr(name, '.');
        if (dot)
            *dot = '\0';
        if (!entry || !strcmp(name, entry) || !strcmp(name, "*"))
            return 0;
    }
    return times_fail(r, "the file has no entry ", entry ? entry : "");
}

static bool is_number(const char *text) {
    double value;
    int used = 0;
    return sscanf(text, "%lf%n", &value, &used) == 1 && !text[used];
}

/* Word that a line may name after the phone or its score. */
static const char *word_of(const char *fourth, const char *fifth) {
    const char *word = *fifth ? fifth : is_number(fourth) ? "" : fourth;
    return times_is_pause(word) ? "" : word;
}

static int times_read_htk(struct times_reader *r) {
    char line[LINE_BYTES], name[32], word[WORD_BYTES] = "", fourth[WORD_BYTES], fifth[WORD_BYTES];
    double start, end, word_start = 0, before = 0;
    bool entries = !strncmp(r->at, "#!MLF!#", 7);
    if (entries && find_entry(r))
        return -1;
    while (times_next_line(r, line, sizeof line) && !(entries && !strcmp(line, "."))) {
        if (!line[strspn(line, " \t")])
            continue;
        *fourth = *fifth = '\0';
        if (sscanf(line, "%lf %lf %31s %127s %127s", &start, &end, name, fourth, fifth) < 3)
            return times_fail(r, "expected START END NAME", "");
        const char *next = word_of(fourth, fifth);
        bool pause = times_is_pause(name);
        if (*word && (*next || pause)) {
            times_add_word(r, word, word_start, before);
            *word = '\0';
        }
        if (*next) {
            snprintf(word, sizeof word, "%s", next);
            word_start = start * HTK_UNIT;
        }
        before = end * HTK_UNIT;
        if (!times_add_phone(r, name, start * HTK_UNIT, before, 0))
            return times_fail(r, "the phone begins before the last one's end, or ends before it begins", "");
    }
    if (*word)
        times_add_word(r, word, word_start, before);
    return 0;
}

static int fail_item(const struct times_reader *r, const char *list, size_t i, const char *what) {
    char field[40];
    snprintf(field, sizeof field, "%s[%zu]", list, i);
    return error_in_field(r->e, TIMES_CODE, field, "%s", what);
}

static int times_read_json(struct times_reader *r) {
    static const char order[] = "begins before the last one's end, or ends before it begins";
    json_error_t why;
    json_t *root = json_loads(r->at, 0, &why), *item;
    size_t i;
    int result = 0;
    if (!root) {
        r->line = why.line > 0 ? (size_t)why.line : 1;
        return times_fail(r, why.text, "");
    }
    json_t *words = json_object_get(root, "words");
    if (!json_is_array(json_object_get(root, "phones")))
        result = error_in_field(r->e, TIMES_CODE, "phones", "must be a list");
    else if (words && !json_is_array(words))
        result = error_in_field(r->e, TIMES_CODE, "words", "must be a list");
    json_array_foreach(result ? NULL : json_object_get(root, "phones"), i, item) {
        const char *ipa = NULL, *name = NULL;
        double start, end;
        int stress = 0;
        if (json_unpack_ex(item, &why, 0, "{s?s s?s s:F s:F s?i}", "ipa", &ipa, "name", &name, "start",
                           &start, "end", &end, "stress", &stress)) {
            result = fail_item(r, "phones", i, why.text);
            break;
        }
        if (stress < 0 || stress > 2) {
            result = fail_item(r, "phones", i, "stress must be 0, 1 or 2");
            break;
        }
        if (!times_add_phone(r, name ? name : ipa ? ipa : "", start, end, (uint32_t)stress)) {
            result = fail_item(r, "phones", i, order);
            break;
        }
        struct times_phone *p = &r->times->phones[r->times->phone_count - 1];
        if (ipa)
            snprintf(p->ipa, sizeof p->ipa, "%s", ipa);
    }
    json_array_foreach(words, i, item) {
        const char *text;
        double start, end;
        if (result)
            break;
        if (json_unpack_ex(item, &why, 0, "{s:s s:F s:F}", "text", &text, "start", &start, "end", &end))
            result = fail_item(r, "words", i, why.text);
        else if (!times_add_word(r, text, start, end))
            result = fail_item(r, "words", i, order);
    }
    json_decref(root);
    return result;
}

/* ---- Praat's TextGrid: a sequence of numbers and quoted strings; other words of the long form ("xmin =",
 * "intervals [1]:") are ignored ---- */

enum { VALUE_BYTES = 256, TIERS_MAX = 100, NAMES = 6, KINDS = 8 };

struct tier {
    char name[VALUE_BYTES];
    double count;
    const char *at;
    size_t line;
};

struct tiers {
    struct tier list[TIERS_MAX];
    size_t count;
};

/* Usual names of tiers: exact names in order of preference, and words within a name, as in "anna - phones"
 * of the Montreal Forced Aligner. */
struct usual {
    const char *names[NAMES];
    const char *const *kinds, *const *others; /* words in their names; words in those of other tiers */
    const char *what, *option;
};

static const char *const phone_kinds[KINDS] = {"phones",   "phone",   "phonemes", "phoneme",
                                               "segments", "segment", "phon",     "phons"};
static const char *const word_kinds[KINDS] = {"words",    "word",    "parole",    "parola",
                                              "palavras", "palavra", "kelimeler", "kelime"};
static const struct usual phone_tiers = {
    {"phones", "phone", "MAU", "phonemes", "segments", "phon"}, phone_kinds, word_kinds, "phones", "--tier"};
static const struct usual word_tiers = {{"words", "word", "ORT-MAU", "ORT", "parole", "palavras"},
                                        word_kinds,
                                        phone_kinds,
                                        "words",
                                        "--word-tier"};

static void step(struct times_reader *r) {
    r->line += *r->at == '\n';
    r->at++;
}

/* Reads the next value; a doubled quote stands for one. */
static bool next_value(struct times_reader *r, char *out, bool *quoted) {
    static const char number[] = "0123456789.-+eE";
    size_t used = 0;
    while (r->at < r->end && *r->at != '"' && !(*r->at >= '0' && *r->at <= '9') && *r->at != '-') {
        char closing = *r->at == '[' ? ']' : *r->at == '<' ? '>' : '\0';
        const char *to = closing ? strchr(r->at, closing) : NULL;
        while (to && r->at < to)
            step(r);
        step(r);
    }
    if (r->at >= r->end)
        return false;
    *quoted = *r->at == '"';
    if (*quoted)
        step(r);
    while (r->at < r->end && (*quoted ? *r->at != '"' || r->at[1] == '"' : strchr(number, *r->at) != NULL)) {
        if (*quoted && *r->at == '"')
            step(r);
        if (used + 1 < VALUE_BYTES)
            out[used++] = *r->at;
        step(r);
    }
    out[used] = '\0';
    if (*quoted && r->at >= r->end)
        return false; /* unterminated */
    if (*quoted)
        step(r);
    return true;
}

static bool next_text(struct times_reader *r, char out[VALUE_BYTES]) {
    bool quoted;
    return next_value(r, out, &quoted) && quoted;
}

static bool next_number(struct times_reader *r, double *out) {
    char value[VALUE_BYTES];
    bool quoted;
    if (!next_value(r, value, &quoted) || quoted)
        return false;
    *out = strtod(value, NULL);
    return true;
}

/* Lists the tiers with intervals. */
static int read_tiers(struct times_reader *r, struct tier *tiers, size_t *count) {
    char value[VALUE_BYTES];
    double a, b, size;
    *count = 0;
    if (!next_text(r, value) || strcmp(value, "ooTextFile") != 0 || !next_text(r, value) ||
        strcmp(value, "TextGrid") != 0 || !next_number(r, &a) || !next_number(r, &b) ||
        !next_number(r, &size))
        return times_fail(r, "expected a TextGrid: its kind, its two times and the number of its tiers", "");
    for (; size >= 1; size--) {
        struct tier t = {.count = 0};
        if (!next_text(r, value))
            return times_fail(r, "expected a tier's kind", "");
        bool intervals = !strcmp(value, "IntervalTier");
        if (!next_text(r, value) || !next_number(r, &a) || !next_number(r, &b) || !next_number(r, &t.count))
            return times_fail(r, "expected a tier's name, its two times and its size", "");
        snprintf(t.name, sizeof t.name, "%s", value);
        t.at = r->at;
        t.line = r->line;
        if (intervals && *count < TIERS_MAX)
            tiers[(*count)++] = t;
        for (double i = 0; i < t.count; i++)
            if (!next_number(r, &a) || (intervals && !next_number(r, &b)) || !next_text(r, value))
                return times_fail(r, "expected the next interval or point of the tier ", t.name);
    }
    return 0;
}

static bool is_letter(char c) {
    return (c & 0x80) || (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}

/* True when a word of a tier's name is in the list; *rest is the name without it, such as the speaker in
 * "anna - phones". */
static bool names_kind(const char *name, const char *const kinds[KINDS], char rest[VALUE_BYTES]) {
    size_t used = 0;
    bool found = false;
    while (*name) {
        size_t length = 0;
        while (is_letter(name[length]))
            length++;
        bool kind = false;
        for (size_t k = 0; length && k < KINDS; k++)
            kind = kind || (strlen(kinds[k]) == length && !strncasecmp(name, kinds[k], length));
        if (!kind)
            for (size_t i = 0; i < length; i++)
                rest[used++] = name[i];
        found = found || kind;
        name += length ? length : 1;
    }
    rest[used] = '\0';
    return found;
}

/* Finds a tier by usual names: an exact name, else the only one with such a word; of several, that of the
 * same speaker as `like` (may be NULL). -1 with an error if ambiguous; *found = NULL if none. */
static int find_tier(const struct times_reader *r, const struct tiers *tiers, const struct usual *usual,
                     const struct tier *like, const struct tier **found) {
    char rest[VALUE_BYTES], speaker[VALUE_BYTES] = "", other[VALUE_BYTES];
    const struct tier *second = NULL;
    bool same = false;
    *found = NULL;
    if (like && !names_kind(like->name, phone_tiers.kinds, speaker))
        *speaker = '\0';
    for (size_t k = 0; k < NAMES && !(like && *speaker); k++)
        for (size_t i = 0; i < tiers->count; i++)
            if (!strcasecmp(tiers->list[i].name, usual->names[k])) {
                *found = &tiers->list[i];
                return 0;
            }
    for (size_t i = 0; i < tiers->count; i++) {
        const struct tier *t = &tiers->list[i];
        if (t == like || !names_kind(t->name, usual->kinds, rest) ||
            names_kind(t->name, usual->others, other))
            continue;
        bool fits = like && !strcmp(rest, speaker);
        if (fits > same || !*found) {
            *found = t;
            second = NULL;
        } else if (fits == same) {
            second = t;
        }
        same = same || fits;
    }
    if (second)
        return error_set(r->e, TIMES_CODE,
                         "\"%.60s\" and \"%.60s\" may both be the tier of %s: choose one (%s)",
                         (*found)->name, second->name, usual->what, usual->option);
    return 0;
}

/* Finds a tier by name, or NULL. */
static const struct tier *tier_named(const struct tiers *tiers, const char *name) {
    for (size_t i = 0; i < tiers->count; i++)
        if (!strcmp(tiers->list[i].name, name))
            return &tiers->list[i];
    return NULL;
}

/* Finds the only tier other than the words', if no name identifies the phones. */
static int only_tier(const struct times_reader *r, const struct tiers *tiers, const struct tier *words,
                     const struct tier **found) {
    char names[200] = "";
    size_t count = 0;
    for (size_t i = 0; i < tiers->count; i++)
        if (&tiers->list[i] != words) {
            size_t used = strlen(names);
            *found = &tiers->list[i];
            snprintf(names + used, sizeof names - used, "%s\"%.60s\"", count++ ? ", " : "",
                     tiers->list[i].name);
        }
    if (count < 2)
        return 0;
    names[utf8_check(names, strlen(names))] = '\0';
    return error_set(r->e, TIMES_CODE, "no tier is named \"phones\": choose one of %s (%s)", names,
                     phone_tiers.option);
}

/* A tier assumed to hold phones must not contain spaces, as sentences would. */
static int read_intervals(struct times_reader *r, const struct tier *tier, bool words, bool guessed) {
    char value[VALUE_BYTES];
    double start = 0, end = 0;
    r->at = tier->at;
    r->line = tier->line;
    for (double i = 0; i < tier->count; i++) {
        bool read = next_number(r, &start) && next_number(r, &end) && next_text(r, value);
        bool skip = words && times_is_pause(value);
        if (read && guessed && strchr(value, ' '))
            return times_fail(r, "this is not a phone, and no tier is named \"phones\": ", value);
        if (!read || !(skip || (words ? times_add_word(r, value, start, end)
                                      : times_add_phone(r, value, start, end, 0))))
            return times_fail(r, "the interval is not in order, in the tier ", tier->name);
    }
    return 0;
}

static int times_read_textgrid(struct times_reader *r) {
    struct tiers tiers;
    const struct tier *phones = NULL, *words = NULL;
    const char *phones_name = r->options->tier, *words_name = r->options->word_tier;
    r->line = 1;
    if (read_tiers(r, tiers.list, &tiers.count))
        return -1;
    if (phones_name)
        phones = tier_named(&tiers, phones_name);
    else if (find_tier(r, &tiers, &phone_tiers, NULL, &phones))
        return -1;
    if (phones_name && !phones)
        return times_fail(r, "there is no tier with intervals ", phones_name);
    if (words_name)
        words = tier_named(&tiers, words_name);
    else if (find_tier(r, &tiers, &word_tiers, phones, &words))
        return -1;
    if (words_name && !words)
        return times_fail(r, "there is no tier with intervals ", words_name);
    bool guessed = !phones;
    if (guessed && only_tier(r, &tiers, words, &phones))
        return -1;
    if (!phones)
        return times_fail(r, "there is no tier with intervals ", "");
    words = words == phones ? NULL : words;
    return read_intervals(r, phones, false, guessed) || (words && read_intervals(r, words, true, false)) ? -1
                                                                                                         : 0;
}

/* Converts UTF-8, or UTF-16 with a byte order mark, to NUL-terminated UTF-8. */
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

/* Detects the format from the beginning of the file. */
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
            /* "0 1200000 a", unlike "0.12 100 a"; the header of a .lab does not match */
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
