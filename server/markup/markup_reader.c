/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/markup/markup_reader.h"
#include "server/base/lang.h"
#include "server/base/utf8.h"
#include "server/markup/passage.h"
#include "server/markup/plain.h"
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

/* True if both tags mean the same language, one perhaps with a region. */
static bool same_language(const char *a, const char *b) {
    size_t n = strlen(a), m = strlen(b), shorter = n < m ? n : m;
    return !strncasecmp(a, b, shorter) && (n == m || (n > m ? a : b)[shorter] == '-');
}

void reader_language(struct tag *tag, const char *attribute) {
    struct markup_reader *r = tag->r;
    const char *lang = tag_take(tag, attribute);
    if (!lang)
        return;
    size_t bad;
    if (*lang && !lang_is_tag(lang, strlen(lang), &bad)) {
        tag_bad(tag, attribute, "is not a language tag");
        return;
    }
    bool usual = !*lang || (r->rules && r->rules->lang && same_language(lang, r->rules->lang));
    tag->frame->style.lang = usual ? NULL : score_strndup(r->score, lang, strlen(lang));
}

static struct score_cue *add_cue(struct markup_reader *r, size_t at, const char *kind, const char *name) {
    char lower[64];
    size_t n = 0;
    while (is_white(*name))
        name++;
    for (; *name && n < sizeof lower - 1; name++)
        lower[n++] = *name >= 'A' && *name <= 'Z' ? (char)(*name | 32) : *name;
    while (n && is_white(lower[n - 1]))
        n--;
    while (*name && n && ((unsigned char)lower[n - 1] & 0x80)) /* the cut may be inside a character */
        n--;
    lower[n] = '\0';
    return score_add_cue(r->score, kind, lower, at);
}

struct score_cue *reader_cue(struct markup_reader *r, struct frame *frame, size_t at, const char *kind,
                             const char *name) {
    struct score_cue *cue = add_cue(r, at, kind, name);
    size_t depth = (size_t)(frame - r->frames);
    if (!passage_open(&r->passage, r->score->cue_count - 1, at, depth))
        score_warn(r->score, at, ERROR_IGNORED, "too many behaviours at once: this one is ignored");
    return cue;
}

const char *reader_affect(const struct markup_reader *r, const char *name) {
    return affect_meant(r->rules ? r->rules->affects : NULL, name);
}

struct score_cue *reader_point(struct markup_reader *r, size_t at, const char *kind, const char *name) {
    struct score_cue *cue = add_cue(r, at, kind, name);
    passage_open(&r->passage, r->score->cue_count - 1, at, READER_DEPTH + 1);
    passage_close(&r->passage, READER_DEPTH + 1);
    return cue;
}

struct score_cue *reader_last_word(struct markup_reader *r, size_t at, const char *kind, const char *name) {
    struct score_cue *cue = add_cue(r, at, kind, name);
    passage_last_word(&r->passage, r->score->cue_count - 1, at);
    return cue;
}

void reader_boundary(struct markup_reader *r) {
    if (r->audio)
        return;
    passage_flush(&r->passage);
    r->passage.whole = false;
}

static struct piece piece_here(const struct markup_reader *r, enum score_kind kind, size_t start,
                               size_t end) {
    const struct frame *frame = &r->frames[r->depth];
    return (struct piece){
        .kind = kind, .start = start, .end = end, .style = frame->kept, .depth = frame->style_depth};
}

void reader_pause(struct tag *tag, const char *attribute, double seconds) {
    struct markup_reader *r = tag->r;
    if (seconds < 0) {
        tag_bad(tag, attribute, "is negative: no pause");
        return;
    }
    if (seconds > READER_SECONDS) {
        tag_bad(tag, attribute, "is longer than the limit of 60 s");
        seconds = READER_SECONDS;
    }
    struct piece piece = piece_here(r, SCORE_BREAK, tag->at, tag->at + tag->bytes);
    piece.seconds = seconds;
    if (seconds > 0)
        passage_add(&r->passage, piece);
}

void reader_mark(struct markup_reader *r, size_t at, const char *name) {
    struct piece piece = piece_here(r, SCORE_MARK, at, at);
    piece.name = score_strndup(r->score, name, strlen(name));
    passage_add(&r->passage, piece);
    if (r->vocabulary->mark)
        r->vocabulary->mark(r, at, name);
}

bool reader_capture(struct markup_reader *r, struct frame *frame) {
    if (r->capturing)
        return false;
    r->capturing = frame->captures = true;
    r->capture.size = 0;
    return true;
}

const char *reader_captured(struct markup_reader *r, struct frame *frame) {
    r->capturing = frame->captures = false;
    buf_add(&r->capture, "", 1);
    return (const char *)r->capture.data;
}

void reader_say(struct markup_reader *r, const struct frame *frame, const char *text,
                const struct score_style *style) {
    size_t bytes = strlen(text);
    struct piece piece = {.start = frame->inside,
                          .end = r->end,
                          .style = style,
                          .depth = frame->style_depth,
                          .given = text == frame->value,
                          .atomic = bytes <= READER_ONE_BYTES};
    if (bytes)
        passage_text(&r->passage, text, bytes, piece);
}

const char *reader_keep(struct markup_reader *r, const char *s) {
    return score_strndup(r->score, s, strlen(s));
}

/* A start tag: finds its attributes, and warns of unused ones. */

static size_t find_attribute(const struct tag *tag, const char *name) {
    for (size_t i = 0; i < tag->count; i++) {
        const char *attribute = tag->attributes[2 * i];
        if ((*attribute | 32) == (*name | 32) && !strcasecmp(attribute, name))
            return i;
    }
    return tag->count;
}

bool tag_has(const struct tag *tag, const char *name) {
    return find_attribute(tag, name) < tag->count;
}

const char *tag_take(struct tag *tag, const char *name) {
    size_t i = find_attribute(tag, name);
    if (i == tag->count)
        return NULL;
    tag->taken |= (uint64_t)1 << i;
    return tag->attributes[2 * i + 1];
}

size_t tag_place(const struct tag *tag, const char *name) {
    size_t wanted = find_attribute(tag, name);
    const char *s = tag->r->text + tag->at, *end = s + tag->bytes;
    if (wanted == tag->count)
        return tag->at;
    while (s < end && !is_white(*s))
        s++;
    for (size_t i = 0; s < end; i++) {
        while (s < end && is_white(*s))
            s++;
        if (i == wanted)
            return (size_t)(s - tag->r->text);
        while (s < end && *s != '"' && *s != '\'')
            s++;
        const char *close = s < end ? memchr(s + 1, *s, (size_t)(end - s - 1)) : NULL;
        s = close ? close + 1 : end;
    }
    return tag->at;
}

void tag_warn(struct tag *tag, const char *name, enum error_code code, const char *format, ...) {
    char message[200];
    va_list args;
    va_start(args, format);
    vsnprintf(message, sizeof message, format, args);
    va_end(args);
    score_warn(tag->r->score, tag_place(tag, name), code, "%s", message);
}

void tag_bad(struct tag *tag, const char *name, const char *why) {
    const char *value = tag_take(tag, name);
    tag_warn(tag, name, ERROR_BAD_VALUE, "%s=\"%.60s\" %s", name, value ? value : "", why);
}

static bool listed(const char *list, const char *name) {
    size_t length = strlen(name);
    for (const char *at = list; at && (at = strcasestr(at, name)); at += length)
        if (at > list && at[-1] == ' ' && at[length] == ' ')
            return true;
    return false;
}

void tag_check_attributes(struct tag *tag) {
    static const char quiet[] = " xmlns xml:id xml:space id version xsi:schemaLocation ";
    const struct element *element = tag->frame->element;
    for (size_t i = 0; i < tag->count; i++) {
        const char *name = tag->attributes[2 * i];
        if (tag->taken >> i & 1 || listed(quiet, name) || listed(element->quiet, name) ||
            !strncmp(name, "xmlns:", 6))
            continue;
        bool known = listed(element->ignored, name);
        tag_warn(tag, name, known ? ERROR_IGNORED : ERROR_UNKNOWN_ATTRIBUTE,
                 known ? "the attribute '%.40s' is ignored" : "unknown attribute '%.40s'", name);
    }
}

/* The parser drops entity references in attributes. */
void tag_check_references(struct tag *tag) {
    static const char *const known[] = {"&lt;", "&gt;", "&amp;", "&quot;", "&apos;", "&#"};
    const char *text = tag->r->text, *s = text + tag->at, *end = s + tag->bytes;
    while ((s = memchr(s, '&', (size_t)(end - s)))) {
        bool found = false;
        for (size_t i = 0; i < sizeof known / sizeof *known && !found; i++)
            found = !strncmp(s, known[i], strlen(known[i]));
        if (!found)
            score_warn(tag->r->score, (size_t)(s - text), ERROR_ENTITY,
                       "entities are not expanded: nothing is read in its place");
        s++;
    }
}

/* Parses attribute values: words from a list, numbers with units. */

const struct choice *choice_find(const struct choice *choices, size_t count, const char *name) {
    while (is_white(*name))
        name++;
    size_t length = strlen(name);
    while (length && is_white(name[length - 1]))
        length--;
    for (size_t i = 0; i < count; i++)
        if (strlen(choices[i].name) == length && !strncasecmp(choices[i].name, name, length))
            return &choices[i];
    return NULL;
}

static bool is_digit(char c) {
    return c >= '0' && c <= '9';
}

bool quantity_read(const char *s, struct quantity *q) {
    *q = (struct quantity){0};
    double sign = 1, place = 1;
    while (is_white(*s))
        s++;
    if (*s == '+' || *s == '-') {
        q->relative = true;
        sign = *s++ == '-' ? -1 : 1;
    }
    if (!is_digit(*s) && !(*s == '.' && is_digit(s[1])))
        return false;
    for (; is_digit(*s); s++)
        q->number = q->number < 1e12 ? q->number * 10 + (*s - '0') : q->number;
    if (*s == '.')
        for (s++; is_digit(*s); s++)
            q->number += (*s - '0') * (place /= 10);
    q->number *= sign;
    while (is_white(*s))
        s++;
    size_t n = 0;
    for (; *s && !is_white(*s) && n < sizeof q->unit - 1; s++)
        q->unit[n++] = *s >= 'A' && *s <= 'Z' ? (char)(*s | 32) : *s;
    while (is_white(*s))
        s++;
    return !*s;
}

bool quantity_seconds(const char *text, double unit, double *seconds) {
    static const struct choice units[] = {
        {"s", 1}, {"sec", 1}, {"ms", 0.001}, {"msec", 0.001}, {"msecs", 0.001}};
    struct quantity q;
    if (!quantity_read(text, &q))
        return false;
    if (*q.unit) {
        const struct choice *known = choice_find(units, sizeof units / sizeof *units, q.unit);
        if (!known)
            return false;
        unit = known->value;
    }
    *seconds = q.number * unit;
    return true;
}

bool quantity_plain(const char *text, double min, double max, double *number) {
    struct quantity q;
    if (!quantity_read(text, &q) || *q.unit || q.number < min || q.number > max)
        return false;
    *number = q.number;
    return true;
}

/* Finds the element that a name stands for. */

static int compare_name(const void *key, const void *element) {
    return strcasecmp(key, ((const struct element *)element)->name);
}

static const struct element *find_in(const struct vocabulary *v, const char *name) {
    return bsearch(name, v->elements, v->element_count, sizeof *v->elements, compare_name);
}

/* Vendors' elements include the prefix in their name; otherwise a prefix is a namespace, and is ignored. */
static const struct element *find_element(const struct vocabulary *v, const char *name) {
    const struct element *element = find_in(v, name);
    const char *colon = element ? NULL : strchr(name, ':');
    return colon ? find_in(v, colon + 1) : element;
}

const struct element *vocabulary_find(const struct vocabulary *vocabulary, bool mute, const char *name) {
    const struct element *element = find_element(vocabulary, name);
    const struct vocabulary *also = mute ? NULL : vocabulary->spoken;
    return element || !also ? element : find_element(also, name);
}

/* Finds words in a passage. */

/* How far before the end the last word is searched for, and its greatest length. */
enum { NEAR_BYTES = 256 };

/* True for letters, digits and characters that join them. Scripts without spaces have no words in this
 * sense: a style may begin at any of their characters. */
static bool is_word(uint32_t c) {
    if (c < 0x80)
        return (c >= '0' && c <= '9') || ((c | 32) >= 'a' && (c | 32) <= 'z') || c == '\'';
    if (c < 0xC0)
        return c == 0xAA || c == 0xAD || c == 0xB5 || c == 0xBA;
    if (c == 0xD7 || c == 0xF7)
        return false;
    return c < 0x2000 || c == 0x2019 || (c >= 0x2C00 && c < 0x2E00) ||
           (c >= 0xA640 && c < 0xAC00 && c > 0xA63F) || (c >= 0x10000 && c < 0x1F000);
}

static bool is_apostrophe(uint32_t c) {
    return c == '\'' || c == 0x2019;
}

static bool inside_character(const char *s, size_t at) {
    return ((unsigned char)s[at] & 0xC0) == 0x80;
}

/* Character that ends before `at`, and its length; 0 at the beginning. */
static uint32_t before(const char *s, size_t at, size_t *length) {
    uint32_t c = 0;
    size_t from = at;
    while (from > 0 && at - from < 4) {
        from--;
        if (!inside_character(s, from))
            break;
    }
    *length = at - from;
    if (*length)
        utf8_next(s + from, *length, &c);
    return c;
}

static uint32_t after(const char *s, size_t at, size_t size, size_t *length) {
    uint32_t c = 0;
    *length = at < size ? utf8_next(s + at, size - at, &c) : 0;
    return c;
}

/* Index of the first barrier at or after `flat`. */
static size_t barrier_from(const struct passage *p, size_t flat) {
    size_t low = 0, high = p->barrier_count;
    while (low < high) {
        size_t middle = (low + high) / 2;
        if (p->barriers[middle] < flat)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

/* True if a word continues across `at`. An apostrophe joins only two letters. */
static bool joins(const char *s, size_t size, size_t at) {
    size_t left, right, more;
    uint32_t a = before(s, at, &left), b = after(s, at, size, &right);
    if (!left || !right || !is_word(a) || !is_word(b))
        return false;
    if (is_apostrophe(a)) {
        uint32_t c = before(s, at - left, &more);
        return !is_apostrophe(b) && more && is_word(c) && !is_apostrophe(c);
    }
    if (is_apostrophe(b)) {
        uint32_t c = after(s, at + right, size, &more);
        return more && is_word(c) && !is_apostrophe(c);
    }
    return true;
}

static size_t word_begin(const char *s, size_t size, size_t at, size_t least) {
    for (size_t length; at > least && joins(s, size, at); at -= length)
        before(s, at, &length);
    return at;
}

static size_t word_end(const char *s, size_t size, size_t at, size_t most) {
    for (size_t length; at < most && joins(s, size, at); at += length)
        after(s, at, size, &length);
    return at;
}

bool passage_word(struct passage *p, size_t slot, size_t flat, struct word *word) {
    const char *s = (const char *)p->flat.data;
    size_t size = p->flat.size;
    struct word *last = &p->words[slot];
    if (flat <= last->from || flat >= last->to) {
        if (!flat || flat >= size || !joins(s, size, flat))
            return false;
        size_t next = barrier_from(p, flat);
        if (next < p->barrier_count && p->barriers[next] == flat)
            return false;
        last->from = word_begin(s, size, flat, next ? p->barriers[next - 1] : 0);
        last->to = word_end(s, size, flat, next < p->barrier_count ? p->barriers[next] : size);
    }
    *word = *last;
    return true;
}

bool passage_word_before(const struct passage *p, struct word *word) {
    const char *s = (const char *)p->flat.data;
    size_t size = p->flat.size, to = size, length;
    for (; to > 0 && size - to < NEAR_BYTES; to -= length) {
        uint32_t c = before(s, to, &length);
        if (is_word(c) && !is_apostrophe(c))
            break;
    }
    if (!to || size - to >= NEAR_BYTES)
        return false;
    before(s, to, &length);
    size_t next = barrier_from(p, to), least = next ? p->barriers[next - 1] : 0;
    least = to - least > NEAR_BYTES ? to - NEAR_BYTES : least;
    while (inside_character(s, least))
        least++;
    *word = (struct word){word_begin(s, to, to - length, least), to};
    return true;
}
