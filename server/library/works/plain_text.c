/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Plain text: which lines are a heading, verse or wrapped prose. */
#include "server/base/mem.h"
#include "server/base/utf8.h"
#include "server/library/works/readers.h"
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <utf8proc.h>

enum {
    LINE_MOST = 60,   /* characters of a line of verse and of a heading */
    WIDTH_LEAST = 50, /* narrower paragraphs are not recognised as wrapped prose by their width */
    WIDTH_MOST = 200,
    HEADING_LINES_MAX = 3,
};

struct line {
    const char *text;
    size_t size;   /* bytes, without white space at its ends */
    size_t length; /* characters */
    bool indent;
};

struct plain {
    struct builder *b;
    struct line *lines; /* of the paragraph */
    size_t count, cap;
    size_t width;  /* of the file's wrapped lines, in characters; 0: unknown */
    bool parts;    /* a heading of a part or book has come */
    bool headed;   /* the last paragraph was a heading */
    bool emphasis; /* _ has begun one */
    bool unended;  /* no _ that follows in the paragraph ends one */
};

static size_t line_end(const char *data, size_t size, size_t at) {
    const char *newline = memchr(data + at, '\n', size - at);
    return newline ? (size_t)(newline - data) : size;
}

static size_t characters(const char *text, size_t size) {
    size_t count = 0;
    for (size_t i = 0; i < size; i++)
        count += (text[i] & 0xC0) != 0x80;
    return count;
}

static struct line trimmed(const char *text, size_t size) {
    struct line line = {.text = text, .size = size, .indent = size && strchr(" \t", *text)};
    while (line.size && strchr(" \t\r", line.text[line.size - 1]))
        line.size--;
    while (line.size && strchr(" \t", *line.text)) {
        line.text++;
        line.size--;
    }
    line.length = characters(line.text, line.size);
    return line;
}

static size_t first_word(const struct line *line) {
    size_t size = 0;
    while (size < line->size && !strchr(" \t", line->text[size]))
        size++;
    return characters(line->text, size);
}

/* Counts the letters of each case; *first: category of the first letter. */
static size_t letters_of(const struct line *line, size_t *lower, int *first) {
    size_t letters = 0;
    *lower = 0;
    *first = 0;
    for (size_t at = 0, length; at < line->size; at += length ? length : 1) {
        uint32_t cp = 0;
        length = utf8_next(line->text + at, line->size - at, &cp);
        int category = utf8proc_category((utf8proc_int32_t)cp);
        bool letter = category >= UTF8PROC_CATEGORY_LU && category <= UTF8PROC_CATEGORY_LO;
        if (letter && !letters)
            *first = category;
        letters += letter;
        *lower += category == UTF8PROC_CATEGORY_LL;
    }
    return letters;
}

static bool starts_low(const struct line *line) {
    size_t lower;
    int first;
    letters_of(line, &lower, &first);
    return first == UTF8PROC_CATEGORY_LL;
}

/* ---- headings ---- */

static bool is_one_of(const char *list, const char *word, size_t size) {
    for (const char *at = list; *at; at += strspn(at, " ")) {
        size_t length = strcspn(at, " ");
        if (length == size && !strncasecmp(at, word, size))
            return true;
        at += length;
    }
    return false;
}

/* Size of the word at text[at..size), without a full stop or colon after it. */
static size_t word_size(const char *text, size_t size) {
    size_t length = 0;
    while (length < size && !strchr(" \t.:,;", text[length]))
        length++;
    return length;
}

static bool is_roman(const char *word, size_t size) {
    for (size_t i = 0; i < size; i++)
        if (!strchr("IVXLCDM", word[i]))
            return false;
    return size > 0;
}

static bool is_number(const char *word, size_t size) {
    static const char words[] =
        "one two three four five six seven eight nine ten eleven twelve thirteen fourteen fifteen sixteen "
        "seventeen eighteen nineteen twenty first second third fourth fifth sixth seventh eighth ninth tenth "
        "the "
        "last uno due tre quattro cinque sei sette otto nove dieci primo seconda secondo prima terzo terza "
        "quarto "
        "quarta quinto quinta sesto sesta settimo settima ottavo ottava nono nona decimo decima undicesimo "
        "dodicesimo undecimo duodecimo decimoterzo decimoquarto ultimo ultima unico unica primeiro primeira "
        "segundo segunda terceiro terceira quarto sexto sexta setimo oitavo oitava um dois bir iki altı yedi "
        "sekiz "
        "dokuz on birinci ikinci beşinci altıncı yedinci sekizinci dokuzuncu onuncu ";
    size_t digits = 0;
    while (digits < size && word[digits] >= '0' && word[digits] <= '9')
        digits++;
    return is_roman(word, size) || (digits && digits == size) || is_one_of(words, word, size);
}

/* Level of a heading: 1 for parts, 2 for chapters, 3 for scenes; 0: this is no heading. */
static unsigned heading_level(const struct line *line) {
    static const char parts[] = "parte libro atto part book act volume livro ato kisim kitap perde tome ";
    static const char chapters[] =
        "capitolo canto capo chapter canto stave letter lettera capítulo capitulo carta "
        "bölüm giornata novella sonetto ";
    static const char scenes[] = "scena scene cena sahne ";
    static const char alone[] =
        "prologo epilogo prefazione introduzione conclusione proemio congedo prologue "
        "epilogue preface introduction conclusion foreword afterword prólogo epílogo prefácio "
        "introdução conclusão önsöz sonsöz ";
    size_t size = word_size(line->text, line->size), lower, letters;
    const char *rest = line->text + size, *end = line->text + line->size;
    int first;
    unsigned level = is_one_of(parts, line->text, size)      ? 1
                     : is_one_of(chapters, line->text, size) ? 2
                     : is_one_of(scenes, line->text, size)   ? 3
                                                             : 0;
    if (line->length > LINE_MOST || !size)
        return 0;
    while (rest < end && strchr(" \t", *rest))
        rest++;
    letters = letters_of(line, &lower, &first);
    if (level && letters &&
        (!lower || (rest > line->text + size && is_number(rest, word_size(rest, (size_t)(end - rest))))))
        return first == UTF8PROC_CATEGORY_LL ? 0 : level;
    bool bare = rest == end || (rest + 1 == end && strchr(".:", *rest));
    return bare && (is_roman(line->text, size) || is_one_of(alone, line->text, size)) ? 2 : 0;
}

static bool is_capitals(const struct line *line) {
    size_t lower;
    int first;
    return letters_of(line, &lower, &first) > 1 && !lower && line->length <= LINE_MOST;
}

/* ---- verse or prose ---- */

/* Words that a line of verse hardly ends with. */
static bool ends_loosely(const struct line *line) {
    static const char words[] =
        "di a ad ed se non da in con su per tra fra il lo la i gli le un uno una e o che del della al alla "
        "nel nella dal dalla the of and an to at by for with from or that o os as um uma de do "
        "dos das em no na com por para ao ve bir ile için ";
    size_t size = 0;
    while (size < line->size && line->text[line->size - 1 - size] != ' ')
        size++;
    return is_one_of(words, line->text + line->size - size, size);
}

/* True when the next line's first word hardly fitted into the width. */
static bool is_full(const struct line *line, size_t width) {
    return line->length + 1 + first_word(line + 1) > width - width / 10;
}

/* True when a line begins a speech of its own: a dash and a capital after the end of a sentence. */
static bool is_speech(const struct line *line) {
    static const char *const dashes[] = {"–", "—", "―"}, *const stops[] = {".", "!",  "?", "…",
                                                                           "»", "\"", "”", ":"};
    const struct line *above = line - 1;
    bool dash = false, stop = false;
    for (size_t i = 0; i < sizeof dashes / sizeof *dashes; i++)
        dash = dash || (line->size > 3 && !memcmp(line->text, dashes[i], 3));
    for (size_t i = 0; i < sizeof stops / sizeof *stops; i++)
        stop = stop || (above->size >= strlen(stops[i]) &&
                        !memcmp(above->text + above->size - strlen(stops[i]), stops[i], strlen(stops[i])));
    return dash && stop && !starts_low(line);
}

static bool is_verse(const struct plain *p) {
    size_t full = 0, loose = 0, low = 0, longest = 0;
    if (p->count < 2)
        return false;
    for (size_t i = 0; i < p->count; i++) {
        const struct line *line = &p->lines[i];
        bool last = i + 1 == p->count;
        longest = line->length > longest ? line->length : longest;
        full += !last && p->width && is_full(line, p->width);
        loose += !last && ends_loosely(line);
        low += i && starts_low(line);
        if (i && is_speech(line))
            return false;
    }
    size_t others = p->count - 1;
    bool wrapped = p->width >= WIDTH_LEAST && 10 * full >= 8 * others && low;
    bool running = longest >= WIDTH_LEAST - 5 && loose && 2 * low >= others;
    return longest <= LINE_MOST && !wrapped && !running;
}

/* ---- blocks ---- */

/* level 0: a title below the heading before it */
static void add_heading(struct plain *p, unsigned level) {
    p->parts = p->parts || level == 1;
    if (level > 1 && !p->parts)
        level--;
    if (level)
        build_section(p->b, level);
    for (size_t i = 0; i < p->count; i++) {
        build_block(p->b, BLOCK_HEAD);
        build_top(p->b)->level = level ? level : 3;
        build_text(p->b, p->lines[i].text, p->lines[i].size);
        build_end(p->b);
    }
}

static bool is_of_word(const char *text, size_t size, size_t at) {
    unsigned char c = at < size ? (unsigned char)text[at] : ' ';
    return c >= 0x80 || (c >= '0' && c <= '9') || ((c | 32) >= 'a' && (c | 32) <= 'z');
}

/* True when a _ there ends an emphasis (begins: begins one). */
static bool is_underscore(const struct line *line, size_t at, bool begins) {
    if (at >= line->size || line->text[at] != '_')
        return false;
    bool before = at && is_of_word(line->text, line->size, at - 1);
    bool white =
        begins ? at + 1 >= line->size || line->text[at + 1] == ' ' : !at || line->text[at - 1] == ' ';
    return begins ? !white && !before : !white && !is_of_word(line->text, line->size, at + 1);
}

/* True when the paragraph ends the emphasis that begins there. A paragraph is searched to its end once only.
 */
static bool ends_emphasis(struct plain *p, size_t line, size_t at) {
    for (; line < p->count && !p->unended; line++, at = 0)
        for (; at < p->lines[line].size; at++)
            if (is_underscore(&p->lines[line], at, false))
                return true;
    p->unended = true;
    return false;
}

/* Adds a line, with _words_ as an emphasis. */
static void add_line(struct plain *p, size_t i) {
    const struct line *line = &p->lines[i];
    size_t from = 0;
    for (size_t at = 0; at < line->size; at++) {
        bool ends = p->emphasis && is_underscore(line, at, false);
        bool begins = !p->emphasis && is_underscore(line, at, true) && ends_emphasis(p, i, at + 1);
        if (!ends && !begins)
            continue;
        build_text(p->b, line->text + from, at - from);
        from = at + 1;
        if (begins)
            build_mark(p->b, MARK_EMPHASIS, NULL);
        else
            build_mark_end(p->b, MARK_EMPHASIS);
        p->emphasis = begins;
    }
    build_text(p->b, line->text + from, line->size - from);
    build_text(p->b, " ", 1);
}

static void add_paragraph(struct plain *p) {
    bool verse = is_verse(p);
    if (!verse)
        build_block(p->b, BLOCK_PARAGRAPH);
    for (size_t i = 0; i < p->count; i++) {
        if (verse)
            build_line(p->b, NULL, p->lines[i].indent);
        else if (i && is_speech(&p->lines[i]))
            build_block(p->b, BLOCK_PARAGRAPH);
        add_line(p, i);
    }
    build_end(p->b);
    p->emphasis = p->unended = false;
}

static void end_paragraph(struct plain *p) {
    unsigned level = 0;
    size_t headings = 0;
    if (!p->count)
        return;
    for (size_t i = 0; i < p->count && p->count <= HEADING_LINES_MAX; i++) {
        unsigned one = heading_level(&p->lines[i]);
        headings += one > 0;
        level = i ? level : one;
        if (p->lines[i].length > LINE_MOST)
            headings = p->count;
    }
    if (level && headings == 1) {
        add_heading(p, level);
        p->headed = true;
    } else if (p->headed && p->count == 1 && is_capitals(p->lines)) {
        add_heading(p, 0);
        p->headed = false;
    } else {
        add_paragraph(p);
        p->headed = false;
    }
    p->count = 0;
}

/* Width that the file's paragraphs are wrapped to: 95 of 100 lines that another follows are not longer. */
static size_t width_of(const char *data, size_t size, size_t at) {
    size_t *counts = mem_alloc((WIDTH_MOST + 1) * sizeof *counts), lines = 0, width = 0, sum = 0;
    struct line before = {0};
    while (at < size) {
        size_t end = line_end(data, size, at);
        struct line line = trimmed(data + at, end - at);
        if (line.size && before.size) {
            counts[before.length < WIDTH_MOST ? before.length : WIDTH_MOST]++;
            lines++;
        }
        before = line;
        at = end + 1;
    }
    while (lines && width < WIDTH_MOST && 100 * (sum += counts[width]) < 95 * lines)
        width++;
    free(counts);
    return width;
}

/* Takes title, author and language from the header of a text of Project Gutenberg. */
static void read_gutenberg(const char *data, size_t size, struct work_meta *meta) {
    static const char start[] = "*** START OF TH";
    static const char *const langs[][2] = {
        {"English", "en"}, {"Italian", "it"}, {"Portuguese", "pt"}, {"Turkish", "tr"}, {"French", "fr"},
        {"Spanish", "es"}, {"German", "de"},  {"Latin", "la"},      {"Dutch", "nl"},   {"Catalan", "ca"}};
    enum { HEADER_BYTES = 20000, VALUE_BYTES = 300 };
    const char *end = memmem(data, size < HEADER_BYTES ? size : HEADER_BYTES, start, strlen(start));
    for (size_t at = 0; end && data + at < end;) {
        size_t stop = line_end(data, size, at);
        struct line line = trimmed(data + at, stop - at);
        const struct {
            const char *name;
            char **to;
        } fields[] = {{"Title: ", &meta->title}, {"Author: ", &meta->author}, {"Language: ", NULL}};
        at = stop + 1;
        for (size_t i = 0; i < sizeof fields / sizeof *fields; i++) {
            size_t name = strlen(fields[i].name);
            if (line.size <= name || line.size > VALUE_BYTES || memcmp(line.text, fields[i].name, name) != 0)
                continue;
            char *value = mem_strndup(line.text + name, line.size - name);
            if (fields[i].to)
                work_meta_set(fields[i].to, value);
            for (size_t k = 0; !fields[i].to && k < sizeof langs / sizeof *langs; k++)
                if (!strcmp(value, langs[k][0])) {
                    free(meta->lang);
                    meta->lang = mem_strdup(langs[k][1]);
                }
            free(value);
        }
    }
}

int plain_work_read(const char *data, size_t size, struct work_meta *meta, struct builder *b,
                    struct error *e) {
    size_t at = front_matter_read(data, size, meta, b);
    struct plain p = {.b = b, .width = width_of(data, size, at)};
    (void)e;
    meta->format = "text";
    if (!at)
        read_gutenberg(data, size, meta);
    while (at < size && !b->stopped) {
        size_t end = line_end(data, size, at);
        struct line line = trimmed(data + at, end - at);
        if (line.size) {
            p.lines = mem_grow(p.lines, &p.cap, p.count + 1, sizeof *p.lines);
            p.lines[p.count++] = line;
        } else {
            end_paragraph(&p);
        }
        at = end + 1;
    }
    end_paragraph(&p);
    free(p.lines);
    return 0;
}
