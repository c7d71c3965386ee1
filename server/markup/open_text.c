/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/markup/open_text.h"
#include "server/base/buf.h"
#include "server/base/mem.h"
#include "server/base/utf8.h"
#include "server/markup/detect.h"
#include "server/markup/plain.h"
#include <stdlib.h>
#include <string.h>

/* ---- text with tags: finds sentences in the text between tags, and encloses each piece in copies of its
 * open elements. The reader of a piece reports errors in it. ---- */

struct token {
    enum { TOKEN_TEXT, TOKEN_OPEN, TOKEN_CLOSE, TOKEN_EMPTY, TOKEN_OTHER, TOKEN_HALF } kind;
    size_t start, end;
};

/* blocks: a sentence ends with the element. wholes: no sentence ends inside. */
static const char blocks[] = " p s paragraph sentence sent para div speak jsml apml performative ";
static const char wholes[] = " say-as sayas sub phoneme audio desc w token emphasis emp ";

static bool begins(const char *s, size_t n, const char *with) {
    size_t length = strlen(with);
    return n >= length && !memcmp(s, with, length);
}

static size_t past(const char *s, size_t n, const char *end) {
    const char *found = memmem(s, n, end, strlen(end));
    return found ? (size_t)(found - s) + strlen(end) : 0;
}

/* Length of a tag, whose attributes may contain ">"; 0: incomplete. */
static size_t tag_length(const char *s, size_t n) {
    char quote = 0;
    for (size_t i = 1; i < n; i++) {
        if (quote)
            quote = s[i] == quote ? 0 : quote;
        else if (s[i] == '"' || s[i] == '\'')
            quote = s[i];
        else if (s[i] == '>')
            return i + 1;
    }
    return 0;
}

static struct token markup_at(const char *s, size_t n, size_t at) {
    struct token t = {TOKEN_OTHER, at, at};
    size_t length;
    if (begins(s, n, "<!--"))
        length = past(s, n, "-->");
    else if (begins(s, n, "<![CDATA["))
        length = past(s, n, "]]>");
    else if (begins(s, n, "<?"))
        length = past(s, n, "?>");
    else if (begins(s, n, "<!"))
        length = n < 9 ? 0 : past(s, n, memchr(s, '[', n) ? "]>" : ">");
    else {
        length = tag_length(s, n);
        t.kind = begins(s, n, "</") ? TOKEN_CLOSE : TOKEN_OPEN;
        if (length > 2 && s[length - 2] == '/' && t.kind == TOKEN_OPEN)
            t.kind = TOKEN_EMPTY;
    }
    t.end = at + length;
    if (!length)
        t = (struct token){TOKEN_HALF, at, at + n};
    return t;
}

/* Token at text[at], at < size. An incomplete character reference is TOKEN_HALF, too. */
static struct token token_at(const char *text, size_t size, size_t at) {
    enum { REFERENCE = 12 };
    size_t n = size - at;
    if (text[at] == '<')
        return markup_at(text + at, n, at);
    if (text[at] == '&' && n < REFERENCE && !memchr(text + at, ';', n) && !memchr(text + at, ' ', n))
        return (struct token){TOKEN_HALF, at, size};
    return (struct token){TOKEN_TEXT, at, at + 1};
}

/* True if the tag's name, without its prefix, is in the list. */
static bool is_one_of(const char *text, struct token t, const char *names) {
    char name[32] = " ";
    const char *s = text + t.start + (t.kind == TOKEN_CLOSE ? 2 : 1);
    size_t n = strcspn(s, " \t\r\n/>");
    const char *colon = memchr(s, ':', n);
    if (colon) {
        n -= (size_t)(colon + 1 - s);
        s = colon + 1;
    }
    if (!n || n > sizeof name - 3)
        return false;
    for (size_t i = 0; i < n; i++)
        name[i + 1] = s[i] >= 'A' && s[i] <= 'Z' ? (char)(s[i] | 32) : s[i];
    strcpy(name + 1 + n, " ");
    return strstr(names, name) != NULL;
}

/* The text after the last piece, without tags. */
struct view {
    struct buf flat; /* text without tags; inside `wholes`, without punctuation */
    size_t *from;    /* offset in the text for each byte of it */
    size_t from_cap;
    size_t whole;             /* open elements of `wholes` */
    size_t end;               /* end of the last complete token */
    bool tags;                /* contains tags other than end tags */
    bool line_ended, between; /* white space so far holds a line end; a tag followed it */
};

static void add(struct view *v, char c, size_t at) {
    v->from = mem_grow(v->from, &v->from_cap, v->flat.size + 1, sizeof *v->from);
    v->from[v->flat.size] = at;
    /* Line ends on both sides of a tag do not make a blank line (passage.c). */
    char white = c == '\n' && !v->between && !v->whole ? '\n' : ' ';
    char seen = is_white(c) ? white : v->whole && c && strchr(".?!,;:", c) ? 'x' : c;
    buf_add(&v->flat, &seen, 1);
    v->line_ended = is_white(c) && (v->line_ended || c == '\n');
    v->between = v->between && is_white(c);
}

static void view_free(struct view *v) {
    buf_free(&v->flat);
    free(v->from);
}

static const char *flat(const struct view *v) {
    return v->flat.size ? (const char *)v->flat.data : "";
}

/* Offset in the text where the first sentence of the view ends; 0: unknown. limit: returned if there is
 * only one sentence. */
static size_t first_end(const struct view *v, const struct markup_rules *base, bool more, size_t limit) {
    struct markup_rules rules = *base;
    size_t skip = 0, n = v->flat.size;
    rules.more = more;
    rules.markdown = false;
    rules.wrapped = true;
    while (skip < n && is_white(flat(v)[skip]))
        skip++;
    if (!markdown_has_words(flat(v), n))
        return 0;
    size_t length = plain_sentence(flat(v) + skip, n - skip, &rules);
    if (length == PLAIN_UNKNOWN)
        return 0;
    if (skip + length == n && !more)
        return limit;
    while (length && is_white(flat(v)[skip + length - 1]))
        length--;
    return v->from[skip + length - 1] + 1;
}

static void take(struct view *v, const char *text, struct token t) {
    bool is_whole = t.kind != TOKEN_TEXT && t.kind != TOKEN_OTHER && is_one_of(text, t, wholes);
    v->end = t.end;
    v->between |= t.kind != TOKEN_TEXT && v->line_ended;
    if (t.kind == TOKEN_TEXT)
        add(v, text[t.start], t.start);
    if (begins(text + t.start, t.end - t.start, "<![CDATA["))
        for (size_t i = t.start + 9; i + 3 < t.end; i++)
            add(v, text[i], i);
    v->tags |= t.kind == TOKEN_OPEN || t.kind == TOKEN_EMPTY;
    if (is_whole && t.kind == TOKEN_OPEN)
        v->whole++;
    if (is_whole && t.kind == TOKEN_CLOSE && v->whole)
        v->whole--;
}

/* Returns the offset of the next piece's end; 0: unknown; SIZE_MAX with *e. */
static size_t find_end(struct open_text *o, const char *text, size_t size, enum open_end end,
                       const struct markup_rules *rules, struct view *v, struct error *e) {
    size_t found = 0;
    v->end = o->at;
    for (size_t i = 0; i < o->element_count; i++)
        v->whole += is_one_of(text, (struct token){TOKEN_OPEN, o->elements[i].start, 0}, wholes);
    while (v->end < size) {
        struct token t = token_at(text, size, v->end);
        if (t.end - o->at > OPEN_PIECE_BYTES && v->end > o->at)
            return (found = first_end(v, rules, false, v->end)) ? found : v->end;
        if (t.kind == TOKEN_HALF && t.end - t.start > OPEN_PIECE_BYTES) {
            struct lines lines = {0};
            size_t line, column;
            lines_place(&lines, text, t.start, &line, &column);
            error_at_line(e, ERROR_BAD_XML, line, column, "a tag may have at most %d bytes",
                          OPEN_PIECE_BYTES);
            return SIZE_MAX;
        }
        if (t.kind == TOKEN_HALF)
            break;
        take(v, text, t);
        if (t.kind == TOKEN_CLOSE && is_one_of(text, t, blocks) &&
            (found = first_end(v, rules, false, t.end)))
            return found;
    }
    if (end == OPEN_CLOSED) /* incomplete tokens are left to the reader, which reports them */
        return (found = first_end(v, rules, false, size)) ? found : size;
    return first_end(v, rules, end == OPEN_GOES_ON, v->end);
}

/* Updates the open elements with the tags of a piece. */
static int follow(struct open_text *o, const char *text, size_t end, struct error *e) {
    for (size_t at = o->at; at < end;) {
        struct token t = token_at(text, end, at);
        at = t.end;
        if (t.kind == TOKEN_CLOSE && o->element_count)
            o->element_count--;
        if (t.kind != TOKEN_OPEN)
            continue;
        if (o->element_count == OPEN_ELEMENTS)
            return error_set(e, ERROR_TOO_DEEP, "elements are nested more than %d deep", OPEN_ELEMENTS);
        o->elements = mem_grow(o->elements, &o->element_cap, o->element_count + 1, sizeof *o->elements);
        o->elements[o->element_count++] = (struct open_element){t.start, t.end};
    }
    o->at = end;
    return 0;
}

/* Writes the start tags on one line, to keep the line numbers of the piece. */
static void add_starts(struct buf *b, const struct open_text *o, const char *text) {
    for (size_t i = 0; i < o->element_count; i++)
        for (size_t at = o->elements[i].start; at < o->elements[i].end; at++)
            buf_add(b, text[at] == '\n' ? " " : text + at, 1);
}

static void add_ends(struct buf *b, const struct open_text *o, const char *text) {
    for (size_t i = o->element_count; i-- > 0;) {
        const char *name = text + o->elements[i].start + 1;
        buf_printf(b, "</%.*s>", (int)strcspn(name, " \t\r\n/>"), name);
    }
}

/* Like open_text_next, for text with tags. */
static int open_xml_next(struct open_text *o, const char *text, size_t size, enum open_end end,
                         const struct markup_rules *rules, struct open_piece *piece, struct error *e) {
    struct view v = {0};
    struct buf b = {0};
    bool blank = true;
    size_t to = o->at < size ? find_end(o, text, size, end, rules, &v, e) : 0;
    view_free(&v);
    if (!to || to == SIZE_MAX)
        return to ? -1 : 0;
    *piece = (struct open_piece){.start = o->at, .length = to - o->at};
    for (size_t i = o->at; i < to && blank; i++)
        blank = is_white(text[i]);
    add_starts(&b, o, text);
    piece->lead = b.size;
    buf_add(&b, text + o->at, to - o->at);
    if (follow(o, text, to, e)) {
        buf_free(&b);
        return -1;
    }
    add_ends(&b, o, text);
    piece->size = b.size;
    buf_add(&b, "", 1);
    piece->text = (char *)b.data;
    if (!blank)
        return 1;
    free(piece->text);
    return 0;
}

/* Like open_text_seems_ended, for text with tags. */
static bool open_xml_seems_ended(const struct open_text *o, const char *text, size_t size,
                                 const struct markup_rules *rules) {
    struct view v = {.end = o->at};
    while (v.end < size) {
        struct token t = token_at(text, size, v.end);
        if (t.kind == TOKEN_HALF)
            break;
        take(&v, text, t);
    }
    bool ended = v.end == size && !v.whole && plain_seems_ended(flat(&v), v.flat.size, rules);
    view_free(&v);
    return ended;
}

/* ---- any text ---- */

/* Length without an incomplete character at the end. */
static size_t whole_characters(const char *text, size_t size) {
    size_t back = 0;
    uint32_t cp;
    while (back < 3 && back < size && ((unsigned char)text[size - 1 - back] & 0xC0) == 0x80)
        back++;
    if (back == size || (unsigned char)text[size - 1 - back] < 0xC0)
        return size;
    return utf8_next(text + size - 1 - back, back + 1, &cp) ? size : size - 1 - back;
}

/* Determines the kind from the root element, once its name is complete. Unlike for a complete text, the
 * end of the text plays no role. */
static bool find_kind(struct open_text *o, const char *text, size_t size, enum open_end end) {
    struct prolog prolog;
    struct error e;
    size_t at = 0;
    while (at < size && is_white(text[at]))
        at++;
    if (at == size && end != OPEN_CLOSED)
        return false;
    if (o->kind != markup_by_name("auto"))
        return o->found = true;
    if (at == size || text[at] != '<') {
        o->kind = markup_by_name("plain");
        return o->markdown = o->found = true;
    }
    bool broken = prolog_read(text, size, &prolog, &e);
    size_t root = prolog.root ? (size_t)(prolog.root - text) + prolog.root_bytes : size;
    if (end != OPEN_CLOSED && (broken || root >= size))
        return false;
    o->kind = markup_detect(o->kind, text, root);
    o->markdown = o->kind == markup_by_name("plain");
    return o->found = true;
}

static size_t skip_white(const char *text, size_t size, size_t at, bool *goes_on) {
    for (; at < size && is_white(text[at]); at++)
        *goes_on = *goes_on && text[at] != '\n';
    return at;
}

/* Skips sentences without words. */
static int plain_next(struct open_text *o, const char *text, size_t size, enum open_end end,
                      const struct markup_rules *base, struct open_piece *piece) {
    struct markup_rules rules = *base;
    rules.more = end == OPEN_GOES_ON;
    rules.markdown = o->markdown;
    for (;;) {
        o->at = skip_white(text, size, o->at, &o->goes_on);
        if (o->at == size)
            return 0;
        size_t length = plain_sentence(text + o->at, size - o->at, &rules);
        if (length == PLAIN_UNKNOWN)
            return 0;
        while (is_white(text[o->at + length - 1]))
            length--;
        *piece = (struct open_piece){.start = o->at, .size = length, .length = length};
        piece->text = mem_strndup(text + o->at, length);
        if (rules.markdown)
            markdown_blank(piece->text, length, !o->goes_on, &rules);
        o->at += length;
        o->goes_on = true;
        if (markdown_has_words(piece->text, length))
            return 1;
        free(piece->text);
    }
}

static int no_pieces(const struct open_text *o, struct error *e) {
    return error_in_field(e, ERROR_BAD_FIELD, "markup",
                          "%s is read as a whole: it cannot be sent piece by piece", o->kind->name);
}

static bool has_pieces(const struct markup_kind *kind) {
    return kind == markup_by_name("plain") || kind == markup_by_name("ssml") ||
           kind == markup_by_name("apml") || kind == markup_by_name("jsml");
}

int open_text_next(struct open_text *o, const char *text, size_t size, enum open_end end,
                   const struct markup_rules *rules, struct open_piece *piece, struct error *e) {
    size = whole_characters(text, size);
    if (!o->found && !find_kind(o, text, size, end))
        return 0;
    if (!has_pieces(o->kind))
        return no_pieces(o, e);
    if (o->kind == markup_by_name("plain"))
        return plain_next(o, text, size, end, rules, piece);
    return open_xml_next(o, text, size, end, rules, piece, e);
}

bool open_text_seems_ended(const struct open_text *o, const char *text, size_t size,
                           const struct markup_rules *base) {
    struct markup_rules rules = *base;
    size_t whole = whole_characters(text, size);
    if (!o->found || whole != size || o->at >= size)
        return false;
    rules.markdown = o->markdown;
    if (o->kind == markup_by_name("plain"))
        return plain_seems_ended(text + o->at, size - o->at, &rules);
    return open_xml_seems_ended(o, text, size, &rules);
}

/* True for letters, and what separates them in a plain sentence. False for non-ASCII quotes, which may be
 * closed later: U+00AB, U+2018 to U+201F, U+300C and the like. */
static bool is_simple(uint32_t c) {
    if (c < 0x80)
        return (c | 32) >= 'a' ? (c | 32) <= 'z' : strchr(" ,;-'", (int)c) != NULL;
    return (c >= 0xC0 && c < 0x2000) || c == 0x2019;
}

bool open_text_surely_ended(const struct open_text *o, const char *text, size_t size,
                            const struct markup_rules *rules) {
    enum { WORD_LETTERS = 4 };
    size_t letters = 0, words = 0, at = o->at;
    uint32_t c;
    bool lower = false;
    if (!size || !strchr(".?!", text[size - 1]) || o->kind != markup_by_name("plain") ||
        !open_text_seems_ended(o, text, size, rules))
        return false;
    for (; at < size - 1; at += utf8_next(text + at, size - at, &c)) {
        utf8_next(text + at, size - at, &c);
        if (!is_simple(c))
            return false;
        bool letter = c >= 0x80 || c >= 'A';
        if (letter && !letters)
            lower = (c >= 'a' && c <= 'z') || c >= 0xDF;
        words += letter && !letters;
        letters = letter ? letters + 1 : 0;
    }
    return words > 1 && letters >= WORD_LETTERS && lower;
}

size_t open_piece_byte(const struct open_piece *p, size_t byte) {
    size_t in = byte > p->lead ? byte - p->lead : 0;
    return p->start + (in < p->length ? in : p->length);
}

void open_piece_place(const struct open_piece *p, const char *text, struct error *e) {
    struct lines in = {0}, of = {0};
    size_t line = 1, column = 1, byte = 0;
    if (e->place != PLACE_LINE)
        return;
    while (byte < p->size && (line < e->line || (line == e->line && column < e->column)))
        lines_place(&in, p->text, ++byte, &line, &column);
    lines_place(&of, text, open_piece_byte(p, byte), &e->line, &e->column);
}

void open_text_free(struct open_text *o) {
    free(o->elements);
    *o = (struct open_text){0};
}
