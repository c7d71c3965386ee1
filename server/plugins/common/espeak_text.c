/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/plugins/common/espeak_text.h"
#include "server/base/mem.h"
#include "server/base/utf8.h"
#include <ctype.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

static bool is_space(uint32_t c) {
    return c <= ' ' || c == 0xA0 || (c >= 0x2000 && c <= 0x200B) || c == 0x2028 || c == 0x2029 ||
           c == 0x202F || c == 0x3000;
}

/* Punctuation around words. */
static bool is_mark(uint32_t c) {
    if (c < 0x80)
        return strchr("!\"'(),-./:;<>?[]_`{}", (int)c) != NULL;
    return c == 0xA1 || c == 0xAB || c == 0xB7 || c == 0xBB || c == 0xBF || (c >= 0x2010 && c <= 0x2027) ||
           (c >= 0x2039 && c <= 0x203A) || (c >= 0x3001 && c <= 0x3011) || c == 0xFF01 || c == 0xFF0C ||
           c == 0xFF1F;
}

/* Letters and digits of scripts that separate words by spaces. */
static bool is_letter(uint32_t c) {
    if (c < 0x80)
        return (c >= '0' && c <= '9') || ((c | 0x20) >= 'a' && (c | 0x20) <= 'z') || c == '\'';
    return c >= 0xC0 && c < 0x2E80 && !(c >= 0x2000 && c < 0x2C00) && c != 0xD7 && c != 0xF7;
}

static uint32_t at(const char *s, size_t offset, size_t *length) {
    uint32_t c = 0;
    *length = s[offset] ? utf8_next(s + offset, strnlen(s + offset, 4), &c) : 0;
    if (s[offset] && !*length)
        *length = 1;
    return c;
}

static uint32_t before(const char *s, size_t offset) {
    size_t length;
    if (!offset)
        return ' ';
    for (offset--; offset && ((unsigned char)s[offset] & 0xC0) == 0x80;)
        offset--;
    return at(s, offset, &length);
}

/* Is the offset inside a word? An apostrophe in front of a word opens a quotation. */
static bool is_inside(const char *s, size_t offset) {
    size_t length;
    return is_letter(before(s, offset)) && is_letter(at(s, offset, &length)) &&
           (s[offset - 1] != '\'' || is_letter(before(s, offset - 1)));
}

/* Finds the end of the word at offset: white space, or where the next word was reported. Strips
 * punctuation from both ends, unless there is nothing else. */
static void measure(struct es_word *w, const char *s, size_t limit) {
    size_t end = w->offset, start = w->offset, length, last = 0;
    for (uint32_t c; s[end] && end < limit && !is_space(c = at(s, end, &length)); end += length) {
        if (!is_mark(c))
            last = end + length;
        else if (!last)
            start = end + length;
    }
    w->bytes = w->empty ? 0 : end - w->offset;
    if (last) {
        w->bytes = last - start;
        w->offset = start;
    }
}

static size_t es_text_words(const char *s);

/* Tells whether the span has as many words in its phones as in its text. */
static bool speaks_word_by_word(const struct faccia_span *span) {
    return es_text_words(span->phones) == es_text_words(span->text);
}

/* espeak-ng reports "- Who" at the dash, which is not spoken: moves the word behind it, unless another
 * word is reported there. */
static void pass_marks(struct es_words *words, size_t i, const struct es_text *text,
                       const struct faccia_sentence *sentence) {
    struct es_word *w = &words->list[i];
    bool apart = false;
    size_t p = w->position, length;
    for (; p < text->place_count; p++) {
        const struct faccia_span *span =
            text->places[p].span < sentence->span_count ? &sentence->spans[text->places[p].span] : NULL;
        uint32_t c = span && span->text ? at(span->text, text->places[p].offset, &length) : ' ';
        if (span && span->phones)
            break;
        if (is_space(c))
            apart = true;
        else if (!is_mark(c))
            break;
    }
    if (!apart || p == text->place_count)
        return;
    for (size_t k = 0; k < words->count; k++)
        if (words->list[k].position > w->position && words->list[k].position <= p)
            return;
    w->position = p;
}

void es_words_locate(struct es_words *words, const struct es_text *text,
                     const struct faccia_sentence *sentence) {
    for (size_t i = 0; i < words->count; i++) {
        struct es_word *w = &words->list[i];
        pass_marks(words, i, text, sentence);
        w->span = UINT32_MAX;
        for (size_t p = w->position; p < text->place_count && w->span == UINT32_MAX; p++) {
            w->span = text->places[p].span;
            w->offset = text->places[p].offset;
        }
    }
    for (size_t i = 0; i < words->count; i++) {
        struct es_word *w = &words->list[i];
        const char *s = w->span < sentence->span_count ? sentence->spans[w->span].text : NULL;
        size_t limit = SIZE_MAX;
        w->bytes = 0;
        if (s && sentence->spans[w->span].phones && !speaks_word_by_word(&sentence->spans[w->span])) {
            bool first = !i || words->list[i - 1].span != w->span;
            w->offset = 0;
            w->bytes = first ? strlen(s) : 0;
            continue;
        }
        if (!s || is_inside(s, w->offset))
            continue;
        for (size_t k = i + 1; k < words->count && limit == SIZE_MAX; k++) {
            const struct es_word *next = &words->list[k];
            if (next->span == w->span && next->offset > w->offset && !is_inside(s, next->offset))
                limit = next->offset;
            if (next->span != w->span)
                break;
        }
        measure(w, s, limit);
    }
}

enum { TOGETHER_MAX = 3 }; /* most words that the engine adds to one: more are something else */

/* Finds the words between two offsets of a text. Returns their number, or TOGETHER_MAX + 1. */
static size_t words_between(const char *s, size_t from, size_t to, struct es_word found[TOGETHER_MAX]) {
    size_t count = 0, length;
    for (size_t at_word = from; s[at_word] && at_word < to;) {
        size_t end = at_word;
        bool letters = false;
        for (uint32_t c; s[end] && end < to && !is_space(c = at(s, end, &length)); end += length)
            letters |= is_letter(c) && c != '\'';
        if (letters && count == TOGETHER_MAX)
            return TOGETHER_MAX + 1;
        if (letters) {
            found[count] = (struct es_word){.offset = at_word};
            measure(&found[count++], s, end);
        }
        at_word = end;
        if (s[at_word] && at_word < to) {
            at(s, at_word, &length);
            at_word += length;
        }
    }
    return count;
}

static uint32_t nearest(const uint32_t *phones, size_t count, uint32_t sample, uint32_t from, uint32_t to) {
    uint32_t best = sample, least = UINT32_MAX;
    for (size_t i = 0; i < count; i++) {
        uint32_t far = phones[i] > sample ? phones[i] - sample : sample - phones[i];
        if (phones[i] > from && phones[i] < to && far < least) {
            best = phones[i];
            least = far;
        }
    }
    return best;
}

void es_words_complete(struct es_words *words, const struct faccia_sentence *sentence, const uint32_t *phones,
                       size_t phone_count, uint32_t end) {
    struct es_words all = {0};
    for (size_t i = 0; i < words->count; i++) {
        const struct es_word *w = &words->list[i], *next = NULL;
        all.list = mem_grow(all.list, &all.cap, all.count + 1 + TOGETHER_MAX, sizeof *all.list);
        all.list[all.count++] = *w;
        const struct faccia_span *span = w->span < sentence->span_count ? &sentence->spans[w->span] : NULL;
        if (!w->bytes || !span->text || span->phones)
            continue;
        for (size_t k = i + 1; k < words->count && !next; k++)
            next = words->list[k].bytes ? &words->list[k] : NULL;
        size_t from = w->offset + w->bytes,
               to = next && next->span == w->span ? next->offset : strlen(span->text);
        struct es_word found[TOGETHER_MAX];
        size_t count = from < to ? words_between(span->text, from, to, found) : 0;
        uint32_t start = w->start, until = next ? next->start : end;
        if (count > TOGETHER_MAX || until <= start)
            continue;
        size_t letters = w->bytes, passed = w->bytes;
        for (size_t k = 0; k < count; k++)
            letters += found[k].bytes;
        for (size_t k = 0; k < count; k++) {
            uint32_t share = w->start + (uint32_t)((uint64_t)(until - w->start) * passed / letters);
            start = nearest(phones, phone_count, share, start, until);
            passed += found[k].bytes;
            found[k].start = start;
            found[k].span = w->span;
            all.list[all.count++] = found[k];
        }
    }
    free(words->list);
    *words = all;
}

struct writer {
    struct es_text *out;
    const struct es_voice *voice;
    const struct es_voices *voices;
    const struct es_ipa *ipa;
    struct es_prosody now; /* current settings in the text so far */
    void (*warn)(void *ctx, const char *message);
    void *ctx;
};

static void warn(const struct writer *w, const char *format, ...) __attribute__((format(printf, 2, 3)));
static void warn(const struct writer *w, const char *format, ...) {
    char message[200];
    va_list args;
    va_start(args, format);
    vsnprintf(message, sizeof message, format, args);
    va_end(args);
    w->warn(w->ctx, message);
}

static int bounded(const struct writer *w, const char *what, double value, int min, int max) {
    if (value >= min && value <= max)
        return (int)lround(value);
    int nearest = value < min ? min : max;
    warn(w, "the voice speaks with a %s of %d instead of %.0f", what, nearest, value);
    return nearest;
}

/* espeak-ng's pitch, 0..99, is exponential; measured, an octave of F0 is PITCH_OCTAVE. It shifts the
 * contour by some Hz, so the range must scale with it. Range and volume are linear. Emphasis in espeak-ng
 * only changes loudness; rate and pitch are added as in MaryTTS for APML. */
static struct es_prosody prosody_of(const struct writer *w, const struct faccia_span *s) {
    static const double PITCH_OCTAVE = 62.5;
    static const double emphasis[][2] = {{1, 1}, {1.05, 0.97}, {0.95, 1.1}, {0.9, 1.2}, {0.8, 1.3}};
    const double *level = emphasis[s->emphasis <= 4 ? s->emphasis : 4];
    double rate = (s->rate > 0 ? s->rate : ES_RATE_OWN) * level[0];
    double pitch = (s->pitch > 0 ? s->pitch : 1) * level[1];
    double range = (s->range >= 0 ? s->range : 1) * pitch;
    return (struct es_prosody){
        .rate = bounded(w, "rate", rate, ES_RATE_MIN, ES_RATE_MAX),
        .pitch = bounded(w, "pitch", 50 + PITCH_OCTAVE * log2(pitch), 0, 99),
        .range = s->range != 1 ? bounded(w, "pitch range", 50 * range, 0, 99) : (int)fmin(50 * range, 99),
        .volume = bounded(w, "volume", 100 * (s->volume >= 0 ? s->volume : 1), 0, 200),
    };
}

static void place(struct es_text *t, uint32_t span, size_t offset) {
    t->places = mem_grow(t->places, &t->place_cap, t->place_count + 1, sizeof *t->places);
    t->places[t->place_count++] = (struct es_place){span, (uint32_t)offset};
}

/* Adds ASCII markup. */
static void tag(struct es_text *t, const char *format, ...) __attribute__((format(printf, 2, 3)));
static void tag(struct es_text *t, const char *format, ...) {
    char markup[160];
    va_list args;
    va_start(args, format);
    int length = vsnprintf(markup, sizeof markup, format, args);
    va_end(args);
    for (int i = 0; i < length; i++)
        place(t, UINT32_MAX, 0);
    buf_add(&t->text, markup, (size_t)length);
}

/* Control characters would be commands to espeak-ng, and private-use characters its own names. */
static bool is_spoken(uint32_t c) {
    return c >= ' ' && c != 0x7F && !(c >= 0x80 && c < 0xA0) && !(c >= 0xE000 && c < 0xF900) && c != 0xFFFE &&
           c != 0xFFFF;
}

/* Adds a character for the place `at` of the span. */
static void add_character(struct es_text *t, uint32_t span, size_t at, const char *c, size_t length) {
    const char *entity = *c == '<' ? "&lt;" : *c == '>' ? "&gt;" : *c == '&' ? "&amp;" : NULL;
    if (!t->ssml || !entity) {
        place(t, span, at);
        buf_add(&t->text, c, length);
        return;
    }
    for (size_t i = 0; entity[i]; i++)
        place(t, span, at);
    buf_add(&t->text, entity, strlen(entity));
}

/* Adds bytes [at, size) of the span's text. */
static void add_text(struct es_text *t, uint32_t span, const char *s, size_t at, size_t size) {
    for (size_t length; at < size; at += length) {
        uint32_t c;
        length = utf8_next(s + at, size - at, &c);
        if (!length)
            c = length = 1;
        if (is_spoken(c) && !(t->phones && c == '['))
            add_character(t, span, at, s + at, length);
        else
            add_character(t, span, at, " ", 1);
    }
}

/* espeak-ng's own commands. Each makes a short break (7 ms) in the sound, so only changes are sent; SSML's
 * prosody element would reset everything. */
static void set(struct writer *w, int *now, int value, char command) {
    if (*now != value)
        tag(w->out, "\x01%d%c", value, command);
    *now = value;
}

static size_t skip_space(const char *s, size_t at) {
    return at + strspn(s + at, " \t\r\n");
}

static size_t skip_word(const char *s, size_t at) {
    return at + strcspn(s + at, " \t\r\n");
}

/* Counts words separated by white space. */
static size_t es_text_words(const char *s) {
    size_t count = 0;
    for (size_t at = skip_space(s, 0); s[at]; at = skip_space(s, skip_word(s, at)))
        count++;
    return count;
}

/* Adds the span's phones, each word at the place of its word in the text if there are as many. Returns
 * false when one cannot be spoken. */
static bool add_phones(struct writer *w, uint32_t index, const struct faccia_span *s) {
    struct buf word = {0};
    const char *p = s->phones;
    char unknown[8];
    bool changed = false, alike = es_text_words(p) == es_text_words(s->text), known = true;
    struct es_text *t = w->out;
    size_t place_count = t->place_count, size = t->text.size;
    size_t text = skip_space(s->text, 0);
    for (size_t at = skip_space(p, 0), end; p[at] && known; at = skip_space(p, end)) {
        end = skip_word(p, at);
        word.size = 0;
        known = !es_ipa_word(w->ipa, p + at, end - at, &word, unknown, &changed);
        if (place_count < t->place_count)
            add_character(t, index, text, " ", 1);
        for (size_t i = 0; i < word.size && known; i++)
            place(t, index, text); /* markup is ignored between the brackets */
        buf_add(&t->text, word.data, known ? word.size : 0);
        if (alike)
            text = skip_space(s->text, skip_word(s->text, text));
    }
    buf_free(&word);
    if (!known) {
        t->place_count = place_count;
        t->text.size = size;
        warn(w, "the voice has no phone \"%s\": it reads the text instead of /%.80s/", unknown, p);
    } else if (changed) {
        warn(w, "the voice does not have all phones of /%.80s/: it speaks the nearest ones", p);
    }
    return known;
}

/* Changes prosody at the first letter, so that punctuation before it stays with the previous word. */
static void add_text_with_prosody(struct writer *w, uint32_t index, const struct faccia_span *s) {
    struct es_prosody p = prosody_of(w, s);
    size_t length = strlen(s->text), letter = 0;
    while (letter < length && (unsigned char)s->text[letter] < 0x80 &&
           !isalnum((unsigned char)s->text[letter]))
        letter++;
    add_text(w->out, index, s->text, 0, letter);
    if (letter == length)
        return;
    set(w, &w->now.rate, p.rate, 'S');
    set(w, &w->now.pitch, p.pitch, 'P');
    set(w, &w->now.range, p.range, 'R');
    set(w, &w->now.volume, p.volume, 'A');
    if (!s->phones || !add_phones(w, index, s))
        add_text(w->out, index, s->text, letter, length);
}

/* espeak-ng's interpretations by the names of SSML 1.1 and JSML. */
static const char *interpretation(const char *say_as) {
    static const char *const known[][2] = {
        {"characters", "characters"}, {"letters", "characters"},       {"spell", "characters"},
        {"spell-out", "characters"},  {"verbatim", "characters"},      {"literal", "characters"},
        {"digits", "tts:digits"},     {"number:digits", "tts:digits"}, {"telephone", "telephone"},
    };
    for (size_t i = 0; i < sizeof known / sizeof *known; i++)
        if (!strcasecmp(say_as, known[i][0]))
            return known[i][1];
    return NULL;
}

/* espeak-ng 1.51 overruns a buffer when spelling characters of other scripts. */
static bool can_be_spelled(const char *s) {
    uint32_t c;
    for (size_t length; *s; s += length) {
        length = utf8_next(s, strnlen(s, 4), &c);
        if (!length || c >= 0x530)
            return false;
    }
    return true;
}

static const char *emphasis_level(uint32_t emphasis) {
    static const char *const levels[] = {NULL, "reduced", "none", "moderate", "strong"};
    return emphasis < sizeof levels / sizeof *levels ? levels[emphasis] : NULL;
}

static void add_span(struct writer *w, uint32_t index, const struct faccia_span *s) {
    struct es_text *t = w->out;
    const struct es_voice *other = NULL;
    const char *as = s->say_as ? interpretation(s->say_as) : NULL, *level = emphasis_level(s->emphasis);
    if (s->lang && strcasecmp(s->lang, w->voice->lang) != 0) {
        other = es_voices_for_lang(w->voices, s->lang);
        if (!other)
            warn(w, "espeak-ng has no voice for the language \"%s\"", s->lang);
    }
    if (as && !can_be_spelled(s->text))
        as = NULL;
    if (s->say_as && !as)
        warn(w, "espeak-ng cannot read this as \"%s\"", s->say_as);
    if (other)
        tag(t, "<voice xml:lang=\"%s\">", other->id);
    if (level)
        tag(t, "<emphasis level=\"%s\">", level);
    if (as)
        tag(t, "<say-as interpret-as=\"%s\">", as);
    add_text_with_prosody(w, index, s);
    if (as)
        tag(t, "</say-as>");
    if (level)
        tag(t, "</emphasis>");
    if (other)
        tag(t, "</voice>");
}

/* Tells whether all spans sound alike, so that no markup is needed. */
static bool is_plain(const struct writer *w, const struct faccia_sentence *sentence) {
    for (size_t i = 0; i < sentence->span_count; i++) {
        const struct faccia_span *s = &sentence->spans[i];
        if (s->kind != FACCIA_SPAN_TEXT || s->say_as || s->phones || s->emphasis ||
            (s->lang && strcasecmp(s->lang, w->voice->lang) != 0))
            return false;
        const struct faccia_span *first = &sentence->spans[0];
        if (s->rate != first->rate || s->pitch != first->pitch || s->range != first->range ||
            s->volume != first->volume)
            return false;
    }
    return true;
}

void es_text_make(struct es_text *text, const struct faccia_sentence *sentence, const struct es_voice *voice,
                  const struct es_voices *voices, const struct es_ipa *ipa,
                  void (*warn_to)(void *ctx, const char *message), void *ctx) {
    struct writer w = {
        .out = text, .voice = voice, .voices = voices, .ipa = ipa, .warn = warn_to, .ctx = ctx};
    *text = (struct es_text){.prosody = {ES_RATE_OWN, 50, 50, 100}};
    text->ssml = !is_plain(&w, sentence);
    for (size_t i = 0; i < sentence->span_count; i++)
        text->phones |= sentence->spans[i].phones != NULL;
    for (size_t i = 0; i < sentence->span_count; i++)
        if (sentence->spans[i].kind == FACCIA_SPAN_TEXT) {
            text->prosody = prosody_of(&w, &sentence->spans[i]);
            break;
        }
    w.now = text->prosody;
    for (uint32_t i = 0; i < sentence->span_count; i++) {
        const struct faccia_span *s = &sentence->spans[i];
        if (s->kind == FACCIA_SPAN_BREAK)
            tag(text, "<break time=\"%.0fms\"/>", s->seconds > 0 ? fmin(s->seconds, ES_BREAK_MAX) * 1000 : 0);
        else if (s->kind == FACCIA_SPAN_MARK)
            tag(text, "<mark name=\"%u\"/>", i);
        else if (text->ssml)
            add_span(&w, i, s);
        else
            add_text(text, i, s->text, 0, strlen(s->text));
    }
    buf_add(&text->text, "", 1);
}

void es_text_free(struct es_text *text) {
    buf_free(&text->text);
    free(text->places);
    *text = (struct es_text){0};
}
