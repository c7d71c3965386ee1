/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Compares the words that a reader delivers with the words of the source (words_source.c). It reports words
 * that are lost, doubled (or added), glued to their neighbour, or divided. Order is not compared: notes
 * follow the block that refers to them. */
#include "server/base/etag.h"
#include "server/base/mem.h"
#include "server/base/utf8.h"
#include "server/library/check/words_source.h"
#include "server/library/works/work.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <utf8proc.h>

enum { SHOWN_MAX = 10 }; /* reports of each kind */

/* ---- vocabulary ---- */

static size_t slot_of(const struct vocabulary *v, const char *word, size_t size) {
    size_t at = hash_add(HASH_BEGIN, word, size) % v->slot_count;
    while (v->slots[at]) {
        const char *other = v->words[v->slots[at] - 1];
        if (strlen(other) == size && !memcmp(other, word, size))
            break;
        at = (at + 1) % v->slot_count;
    }
    return at;
}

uint32_t vocabulary_number(struct vocabulary *v, const char *word, size_t size) {
    if (2 * (v->count + 1) > v->slot_count) {
        free(v->slots);
        v->slot_count = v->slot_count ? 2 * v->slot_count : 1024;
        v->slots = mem_alloc(v->slot_count * sizeof *v->slots);
        for (size_t i = 0; i < v->count; i++)
            v->slots[slot_of(v, v->words[i], strlen(v->words[i]))] = (uint32_t)i + 1;
    }
    size_t slot = slot_of(v, word, size);
    if (!v->slots[slot]) {
        v->words = mem_grow(v->words, &v->cap, v->count + 1, sizeof *v->words);
        v->words[v->count++] = mem_strndup(word, size);
        v->slots[slot] = (uint32_t)v->count;
    }
    return v->slots[slot] - 1;
}

/* Number + 1 of a word that is known; 0: unknown. */
static uint32_t known_number(const struct vocabulary *v, const char *word, size_t size) {
    return v->slot_count ? v->slots[slot_of(v, word, size)] : 0;
}

static void vocabulary_free(struct vocabulary *v) {
    for (size_t i = 0; i < v->count; i++)
        free(v->words[i]);
    free(v->words);
    free(v->slots);
}

/* ---- splitting text into words ---- */

void collector_end_word(struct collector *c) {
    size_t size = c->open[c->depth].size;
    if (!size)
        return;
    struct word_list *w = c->words;
    w->list = mem_grow(w->list, &w->cap, w->count + 1, sizeof *w->list);
    w->list[w->count++] =
        (struct found_word){.number = vocabulary_number(c->vocabulary, c->open[c->depth].bytes, size),
                            .line = c->line,
                            .document = c->document,
                            .optional = c->optional};
    c->open[c->depth].size = 0;
}

static bool is_part_of_word(uint32_t cp) {
    int category = utf8proc_category((utf8proc_int32_t)cp);
    return (category >= UTF8PROC_CATEGORY_LU && category <= UTF8PROC_CATEGORY_ME) ||
           (category >= UTF8PROC_CATEGORY_ND && category <= UTF8PROC_CATEGORY_NO);
}

/* Takes the last word back, to be continued. */
static void reopen(struct collector *c) {
    if (c->open[c->depth].size || !c->words->count)
        return;
    const char *word = c->vocabulary->words[c->words->list[--c->words->count].number];
    c->open[c->depth].size = strlen(word);
    memcpy(c->open[c->depth].bytes, word, strlen(word));
}

void collector_character(struct collector *c, uint32_t cp) {
    char bytes[4];
    if (cp == 0xAD || cp == 0x200B || cp == 0x2060 || cp == 0xFEFF) {
        c->last = cp;
        return;
    }
    bool white = cp == ' ' || cp == '\t' || cp == '\r' || cp == '\n';
    if (!is_part_of_word(cp)) {
        if (!white)
            c->join = JOIN_NO;
        collector_end_word(c);
    } else {
        if (c->join == JOIN_ALWAYS ||
            (c->join == JOIN_LOWER && utf8proc_category((utf8proc_int32_t)cp) == UTF8PROC_CATEGORY_LL))
            reopen(c);
        c->join = JOIN_NO;
        size_t n = utf8_put(cp, bytes);
        if (c->open[c->depth].size + n < CHECKED_WORD_MAX) {
            memcpy(c->open[c->depth].bytes + c->open[c->depth].size, bytes, n);
            c->open[c->depth].size += n;
        }
    }
    c->before = c->last;
    c->last = cp;
}

void collector_add(struct collector *c, const char *text, size_t size) {
    for (size_t at = 0; at < size;) {
        uint32_t cp;
        size_t n = utf8_next(text + at, size - at, &cp);
        c->line += text[at] == '\n';
        collector_character(c, n ? cp : ' ');
        at += n ? n : 1;
    }
}

/* The end of a line, column or page of an edition. */
void collector_break(struct collector *c, bool join) {
    bool hyphen = c->last == '-' || c->last == 0x2010 || c->last == 0xAC || c->last == 0x2E17;
    if (join || c->last == 0xAD) {
        c->join = JOIN_ALWAYS;
    } else if (hyphen && is_part_of_word(c->before)) {
        c->join = JOIN_LOWER;
    } else {
        collector_end_word(c);
        c->last = ' ';
    }
}

void collector_inset(struct collector *c) {
    if (c->depth + 1 < CHECKED_NESTED_MAX)
        c->depth++;
    else
        collector_end_word(c);
}

void collector_inset_end(struct collector *c) {
    collector_end_word(c);
    c->depth -= c->depth > 0;
}

/* ---- comparison ---- */

struct neighbours {
    uint64_t *slots;
    size_t count;
};

static uint64_t pair_of(const struct word_list *w, size_t first) {
    return (((uint64_t)w->list[first].number << 32) | w->list[first + 1].number) + 1;
}

static bool has_pair(struct neighbours *n, uint64_t pair, bool add) {
    size_t at = (pair * 0x9E3779B97F4A7C15u) % n->count;
    while (n->slots[at] && n->slots[at] != pair)
        at = (at + 1) % n->count;
    bool there = n->slots[at] == pair;
    if (add)
        n->slots[at] = pair;
    return there;
}

static struct neighbours pairs_of(const struct word_list *w) {
    struct neighbours n = {.count = 2 * w->count + 7};
    n.slots = mem_alloc(n.count * sizeof *n.slots);
    for (size_t i = 0; i + 1 < w->count; i++)
        has_pair(&n, pair_of(w, i), true);
    return n;
}

/* Marks as many occurrences of each word as the other list lacks: first those whose neighbours differ. */
static void mark_missed(struct word_list *w, const struct word_list *other, uint32_t *excess) {
    struct neighbours n = pairs_of(other);
    for (int least = 2; least >= 0; least--)
        for (size_t i = 0; i < w->count; i++) {
            struct found_word *f = &w->list[i];
            int strange = (!i || !has_pair(&n, pair_of(w, i - 1), false)) +
                          (i + 1 >= w->count || !has_pair(&n, pair_of(w, i), false));
            if (f->missed || f->optional || !excess[f->number] || strange < least)
                continue;
            f->missed = true;
            excess[f->number]--;
        }
    free(n.slots);
}

/* Counts two missed neighbours that are one missed word of the other list. */
static size_t count_joined(struct word_list *parts, struct word_list *wholes, const struct vocabulary *v,
                           const char *what, struct words_report *report) {
    uint32_t *left = mem_alloc((v->count + 1) * sizeof *left);
    size_t count = 0;
    for (size_t i = 0; i < wholes->count; i++)
        left[wholes->list[i].number] += wholes->list[i].missed;
    for (size_t i = 0; i + 1 < parts->count; i++) {
        struct found_word *one = &parts->list[i], *two = one + 1;
        char both[2 * CHECKED_WORD_MAX];
        if (!one->missed || !two->missed)
            continue;
        int size = snprintf(both, sizeof both, "%s%s", v->words[one->number], v->words[two->number]);
        uint32_t number = known_number(v, both, (size_t)size);
        if (!number || !left[number - 1])
            continue;
        left[number - 1]--;
        one->missed = two->missed = false;
        for (size_t k = 0; k < wholes->count; k++)
            if (wholes->list[k].missed && wholes->list[k].number == number - 1) {
                wholes->list[k].missed = false;
                break;
            }
        if (count++ < SHOWN_MAX)
            report->tell(report->ctx, what, one->line, v->words[one->number], v->words[two->number]);
    }
    free(left);
    return count;
}

static size_t count_missed(const struct word_list *w, const struct vocabulary *v, const char *what,
                           struct words_report *report) {
    size_t count = 0;
    for (size_t i = 0; i < w->count; i++)
        if (w->list[i].missed && count++ < SHOWN_MAX)
            report->tell(report->ctx, what, w->list[i].line, v->words[w->list[i].number],
                         i + 1 < w->count ? v->words[w->list[i + 1].number] : "");
    return count;
}

static void compare(struct word_list *source, struct word_list *read, const struct vocabulary *v,
                    struct words_report *report) {
    uint32_t *lost = mem_alloc((v->count + 1) * sizeof *lost),
             *more = mem_alloc((v->count + 1) * sizeof *more);
    for (size_t i = 0; i < source->count; i++) {
        lost[source->list[i].number] += !source->list[i].optional;
        more[source->list[i].number]++;
    }
    for (size_t i = 0; i < read->count; i++) {
        uint32_t number = read->list[i].number;
        lost[number] -= lost[number] > 0;
    }
    uint32_t *reads = mem_alloc((v->count + 1) * sizeof *reads);
    for (size_t i = 0; i < read->count; i++)
        reads[read->list[i].number]++;
    for (size_t i = 0; i < v->count; i++)
        more[i] = reads[i] > more[i] ? reads[i] - more[i] : 0;
    mark_missed(source, read, lost);
    mark_missed(read, source, more);
    report->source = source->count;
    report->read = read->count;
    report->glued = count_joined(source, read, v, "glued", report);
    report->divided = count_joined(read, source, v, "divided", report);
    report->lost = count_missed(source, v, "lost", report);
    report->doubled = count_missed(read, v, "doubled or added", report);
    free(reads);
    free(lost);
    free(more);
}

static int take_section(void *ctx, const struct section *section) {
    struct collector *c = ctx;
    for (size_t i = 0; i < section->count; i++) {
        const struct block *block = &section->blocks[i];
        c->line = 0;
        collector_add(c, (const char *)block->text.data, block->text.size);
        collector_end_word(c);
    }
    return 0;
}

static void pass_problem(void *ctx, const struct error *e, bool serious) {
    (void)ctx;
    (void)e;
    (void)serious;
}

/* Converts ISO 8859-1, if the XML declaration names it. */
static void to_utf8(struct buf *data) {
    size_t size = data->size < 200 ? data->size : 200;
    const char *close = size ? memmem(data->data, size, "?>", 2) : NULL;
    size = close ? (size_t)(close - (const char *)data->data) : 0;
    struct buf out = {0};
    char bytes[4];
    if (!size || (!memmem(data->data, size, "8859-1", 6) && !memmem(data->data, size, "latin1", 6)))
        return;
    for (size_t i = 0; i < data->size; i++)
        buf_add(&out, bytes, utf8_put(data->data[i], bytes));
    buf_free(data);
    *data = out;
}

int words_check(const char *folder, const char *path, struct words_report *report, struct error *e) {
    struct vocabulary v = {0};
    struct word_list source = {0}, read = {0};
    struct collector of_source = {.vocabulary = &v, .words = &source},
                     of_read = {.vocabulary = &v, .words = &read};
    const struct work_sink sink = {&of_read, take_section, pass_problem};
    struct work_meta meta = {.lang = mem_strdup("en")};
    struct error ignored; /* of the reader: what it cannot read counts as lost */
    FILE *file = work_file_open(folder, path, e);
    struct buf data = {0};
    int result = file && !buf_add_stream(&data, file, WORK_ARCHIVE_BYTES_MAX) ? 0 : -1;
    to_utf8(&data);
    *(char *)buf_reserve(&data, 1) = '\0';
    if (!result)
        result = words_source_read(&of_source, path, file, &data, &report->left_out);
    if (file)
        fclose(file);
    if (file && result)
        error_set(e, ERROR_BAD_WORK, "the words of the source cannot be counted");
    if (!result) {
        work_read(folder, path, &meta, &sink, &ignored);
        compare(&source, &read, &v, report);
    }
    buf_free(&data);
    free(source.list);
    free(read.list);
    vocabulary_free(&v);
    work_meta_free(&meta);
    return result;
}
