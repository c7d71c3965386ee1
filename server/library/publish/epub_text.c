/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/mem.h"
#include "server/library/publish/publish_internal.h"
#include <stdlib.h>
#include <string.h>

/* Turns overlapping marks into nested elements: units stay whole, and lie within what somebody speaks; marks
 * are closed and reopened at their edges. */

enum event_kind {
    MARK_ENDS,
    UNIT_ENDS,
    SPEECH_ENDS,
    POINT,
    SPEECH_BEGINS,
    UNIT_BEGINS,
    MARK_BEGINS
}; /* order of events at the same byte */

struct event {
    size_t at;
    enum event_kind kind;
    size_t number; /* of the mark, unit or speech */
};

struct stretch {
    struct buf *out;
    const struct section *section;
    const struct block *block;
    const struct narration_part *part;
    struct event *events;
    size_t count, cap;
    size_t *open; /* marks, outermost first */
    size_t open_count, open_cap;
};

void epub_escape(struct buf *out, const char *text, size_t size) {
    for (size_t i = 0; i < size; i++) {
        unsigned char c = (unsigned char)text[i];
        bool bad = (c < ' ' && c != '\t' && c != '\n') ||
                   (c == 0xEF && size - i > 2 && (unsigned char)text[i + 1] == 0xBF &&
                    (unsigned char)text[i + 2] >= 0xBE); /* U+FFFE, U+FFFF */
        const char *entity = c == '&'   ? "&amp;"
                             : c == '<' ? "&lt;"
                             : c == '>' ? "&gt;"
                             : c == '"' ? "&quot;"
                                        : NULL;
        if (bad)
            i += c == 0xEF ? 2 : 0;
        else if (entity)
            buf_add(out, entity, strlen(entity));
        else
            buf_add(out, text + i, 1);
    }
}

static int compare(const void *a, const void *b) {
    const struct event *x = a, *y = b;
    if (x->at != y->at)
        return x->at < y->at ? -1 : 1;
    if (x->kind != y->kind)
        return x->kind < y->kind ? -1 : 1;
    return (x->number > y->number) - (x->number < y->number);
}

static void add_event(struct stretch *s, size_t at, enum event_kind kind, size_t number) {
    s->events = mem_grow(s->events, &s->cap, s->count + 1, sizeof *s->events);
    s->events[s->count++] = (struct event){at, kind, number};
}

static bool is_span(const struct block_mark *m) {
    return m->kind == MARK_EMPHASIS || m->kind == MARK_FOREIGN || m->kind == MARK_STAGE;
}

static void close_marks(struct stretch *s) {
    static const char *const ends[] = {
        [MARK_EMPHASIS] = "</em>", [MARK_FOREIGN] = "</i>", [MARK_STAGE] = "</span>"};
    for (size_t i = s->open_count; i-- > 0;)
        buf_printf(s->out, "%s", ends[s->block->marks[s->open[i]].kind]);
}

static void open_marks(struct stretch *s) {
    for (size_t i = 0; i < s->open_count; i++) {
        const struct block_mark *m = &s->block->marks[s->open[i]];
        if (m->kind == MARK_EMPHASIS) {
            buf_printf(s->out, "<em>");
        } else if (m->kind == MARK_STAGE) {
            buf_printf(s->out, "<span class=\"stage\" epub:type=\"z3998:stage-direction\">");
        } else {
            const char *lang = m->value ? m->value : "und";
            buf_printf(s->out, "<i lang=\"");
            epub_escape(s->out, lang, strlen(lang));
            buf_printf(s->out, "\" xml:lang=\"");
            epub_escape(s->out, lang, strlen(lang));
            buf_printf(s->out, "\">");
        }
    }
}

static const struct block *note_of(const struct stretch *s, const char *name) {
    for (size_t i = 0; name && i < s->section->count; i++)
        if (s->section->blocks[i].kind == BLOCK_NOTE && !strcmp(s->section->blocks[i].name, name))
            return &s->section->blocks[i];
    return NULL;
}

static void put_point(struct stretch *s, const struct block_mark *m) {
    const struct block *note = m->kind == MARK_NOTE ? note_of(s, m->value) : NULL;
    if (note) {
        const char *sign = note->n ? note->n : "*";
        buf_printf(s->out, "<a epub:type=\"noteref\" role=\"doc-noteref\" href=\"#%s\">", note->name);
        epub_escape(s->out, sign, strlen(sign));
        buf_printf(s->out, "</a>");
    } else if (m->kind == MARK_PAGE && m->value) {
        buf_printf(s->out, "<span epub:type=\"pagebreak\" role=\"doc-pagebreak\" title=\"");
        epub_escape(s->out, m->value, strlen(m->value));
        buf_printf(s->out, "\"></span>");
    }
}

static void take(struct stretch *s, const struct event *event) {
    switch (event->kind) {
    case POINT:
        put_point(s, &s->block->marks[event->number]);
        return;
    case SPEECH_BEGINS:
        close_marks(s);
        buf_printf(s->out, "<span class=\"speech\" data-who=\"");
        epub_escape(s->out, s->part->speeches[event->number].who,
                    strlen(s->part->speeches[event->number].who));
        buf_printf(s->out, "\">");
        break;
    case UNIT_BEGINS:
        close_marks(s);
        buf_printf(s->out, "<span id=\"w%zu\">", event->number + 1);
        break;
    case SPEECH_ENDS:
    case UNIT_ENDS:
        close_marks(s);
        buf_printf(s->out, "</span>");
        break;
    case MARK_BEGINS:
        close_marks(s);
        s->open = mem_grow(s->open, &s->open_cap, s->open_count + 1, sizeof *s->open);
        s->open[s->open_count++] = event->number;
        break;
    case MARK_ENDS:
        close_marks(s);
        for (size_t i = 0; i < s->open_count; i++)
            if (s->open[i] == event->number) {
                memmove(s->open + i, s->open + i + 1, (s->open_count - i - 1) * sizeof *s->open);
                s->open_count--;
                break;
            }
        break;
    }
    open_marks(s);
}

/* Index of the first speech in the block or after it. */
static size_t first_speech(const struct narration_part *part, size_t number) {
    size_t low = 0, high = part->speech_count;
    while (low < high) {
        size_t middle = (low + high) / 2;
        if (part->speeches[middle].block < number)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

/* Adds what somebody speaks in a block without lines. A unit across its edge lies within it. */
static void add_speeches(struct stretch *s, size_t number, size_t first, size_t last) {
    const struct narration_part *part = s->part;
    size_t unit = first, before = 0;
    for (size_t i = first_speech(part, number); i < part->speech_count && part->speeches[i].block == number;
         i++) {
        size_t from = part->speeches[i].from, to = part->speeches[i].to;
        for (; unit < last && part->units[unit].from < to; unit++)
            if (part->units[unit].to > from) {
                from = part->units[unit].from < from ? part->units[unit].from : from;
                to = part->units[unit].to > to ? part->units[unit].to : to;
            }
        from = from > before ? from : before;
        if (from >= to)
            continue;
        add_event(s, from, SPEECH_BEGINS, i);
        add_event(s, to, SPEECH_ENDS, i);
        before = to;
    }
}

/* Writes a range of a block's text with its marks, and the units [first, last) as id="w1"... Takes the
 * signs of notes from the section. */
static void epub_stretch(struct buf *out, const struct section *section, size_t number, size_t from,
                         size_t to, const struct narration_part *part, size_t first, size_t last) {
    const struct block *block = &section->blocks[number];
    struct stretch s = {.out = out, .section = section, .block = block, .part = part};
    const char *text = block->text.size ? (const char *)block->text.data : "";
    for (size_t i = 0; i < block->mark_count; i++) {
        const struct block_mark *m = &block->marks[i];
        size_t start = m->start > from ? m->start : from, end = m->end < to ? m->end : to;
        if (!is_span(m) && m->start >= from && m->start <= to)
            add_event(&s, m->start, POINT, i);
        else if (is_span(m) && start < end) {
            add_event(&s, start, MARK_BEGINS, i);
            add_event(&s, end, MARK_ENDS, i);
        }
    }
    for (size_t i = first; i < last; i++) {
        add_event(&s, part->units[i].from, UNIT_BEGINS, i);
        add_event(&s, part->units[i].to < to ? part->units[i].to : to, UNIT_ENDS, i);
    }
    if (block->kind == BLOCK_PARAGRAPH)
        add_speeches(&s, number, first, last);
    if (s.count)
        qsort(s.events, s.count, sizeof *s.events, compare);
    size_t at = from;
    for (size_t i = 0; i < s.count; i++) {
        epub_escape(out, text + at, s.events[i].at - at);
        at = s.events[i].at;
        take(&s, &s.events[i]);
    }
    epub_escape(out, text + at, to - at);
    free(s.events);
    free(s.open);
}

enum { NUMBERED_LINES = 5 }; /* verse shows every fifth line number */

struct page {
    struct buf *out;
    const struct section *section;
    const struct narration_part *part;
    const char *lang;
    size_t unit; /* next one */
};

static void put(struct page *p, const char *text) {
    epub_escape(p->out, text, strlen(text));
}

static void put_lang(struct page *p, const char *lang) {
    if (!lang || !strcmp(lang, p->lang))
        return;
    buf_printf(p->out, " lang=\"");
    put(p, lang);
    buf_printf(p->out, "\" xml:lang=\"");
    put(p, lang);
    buf_printf(p->out, "\"");
}

/* Writes the text with the units that begin in the range. */
static void put_stretch(struct page *p, size_t number, size_t from, size_t to) {
    const struct narration_part *part = p->part;
    size_t first = p->unit;
    while (p->unit < part->count && part->units[p->unit].block == number && part->units[p->unit].from < to)
        p->unit++;
    epub_stretch(p->out, p->section, number, from, to, part, first, p->unit);
}

/* A paragraph with breaks, so that readers without style sheets show verse, too. */
static void put_verse(struct page *p, size_t number) {
    const struct block *b = &p->section->blocks[number];
    buf_printf(p->out, "<p class=\"verse\" id=\"%s\"", b->name);
    put_lang(p, b->lang);
    buf_printf(p->out, ">");
    for (size_t i = 0; i < b->line_count; i++) {
        const struct block_line *l = &b->lines[i];
        size_t n = b->first_line + i;
        buf_printf(p->out, "%s<span class=\"line%s\" id=\"l%zu\"", i ? "<br/>\n" : "", l->indent ? " in" : "",
                   n);
        if (l->n) {
            buf_printf(p->out, " data-n=\"");
            put(p, l->n);
            buf_printf(p->out, "\"");
        } else if (n % NUMBERED_LINES == 0) {
            buf_printf(p->out, " data-n=\"%zu\"", n);
        }
        buf_printf(p->out, ">");
        put_stretch(p, number, l->start, l->end);
        buf_printf(p->out, "</span>");
    }
    buf_printf(p->out, "</p>\n");
}

/* The id of who says the block after a name. NULL: the source gives none. */
static const char *who_after(const struct section *section, size_t number) {
    for (size_t i = number + 1; i < section->count && section->blocks[i].kind != BLOCK_SPEAKER; i++)
        if (section->blocks[i].who)
            return section->blocks[i].who;
    return NULL;
}

static void put_flowing(struct page *p, size_t number) {
    const struct block *b = &p->section->blocks[number];
    const char *who;
    char head[4];
    snprintf(head, sizeof head, "h%u", b->level < 1 ? 1 : b->level > 6 ? 6 : b->level);
    const char *name = b->kind == BLOCK_HEAD ? head : b->kind == BLOCK_NOTE ? "aside" : "p";
    buf_printf(p->out, "<%s", name);
    if (*b->name)
        buf_printf(p->out, " id=\"%s\"", b->name);
    if (b->kind == BLOCK_NOTE)
        buf_printf(p->out, " epub:type=\"footnote\" role=\"doc-footnote\"");
    else if (b->kind == BLOCK_SPEAKER || b->kind == BLOCK_STAGE || b->item)
        buf_printf(p->out, " class=\"%s\"",
                   b->kind == BLOCK_SPEAKER ? "speaker\" epub:type=\"z3998:persona"
                   : b->kind == BLOCK_STAGE ? "stage\" epub:type=\"z3998:stage-direction"
                                            : "item");
    if (b->kind == BLOCK_SPEAKER && (who = who_after(p->section, number))) {
        buf_printf(p->out, " data-who=\"");
        put(p, who);
        buf_printf(p->out, "\"");
    }
    put_lang(p, b->lang);
    buf_printf(p->out, ">");
    if (b->kind == BLOCK_NOTE && b->n) {
        buf_printf(p->out, "<span class=\"sign\">");
        put(p, b->n);
        buf_printf(p->out, "</span> ");
    }
    put_stretch(p, number, 0, b->text.size);
    buf_printf(p->out, "</%s>\n", name);
}

static void put_block(struct page *p, size_t number) {
    const struct block *b = &p->section->blocks[number];
    while (p->unit < p->part->count && p->part->units[p->unit].block < number)
        p->unit++;
    if (b->kind == BLOCK_VERSE && b->line_count) {
        put_verse(p, number);
    } else if (b->kind == BLOCK_PAGE) {
        buf_printf(p->out, "<div epub:type=\"pagebreak\" role=\"doc-pagebreak\" title=\"");
        put(p, b->n ? b->n : "");
        buf_printf(p->out, "\"></div>\n");
    } else {
        put_flowing(p, number);
    }
}

void epub_xhtml(struct buf *out, const struct section *section, const struct narration_part *part,
                const char *lang) {
    struct page p = {out, section, part, lang, 0};
    buf_printf(out, "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<!DOCTYPE html>\n<html "
                    "xmlns=\"http://www.w3.org/1999/xhtml\" xmlns:epub=\"http://www.idpf.org/2007/ops\" "
                    "epub:prefix=\"z3998: http://www.daisy.org/z3998/2012/vocab/structure/\" lang=\"");
    put(&p, lang);
    buf_printf(out, "\" xml:lang=\"");
    put(&p, lang);
    buf_printf(out, "\">\n<head>\n<title>");
    if (section->title && *section->title)
        put(&p, section->title);
    else
        buf_printf(out, "%u", section->number);
    buf_printf(out, "</title>\n<link rel=\"stylesheet\" type=\"text/css\" "
                    "href=\"style.css\"/>\n</head>\n<body id=\"all\">\n");
    for (size_t i = 0; i < section->count; i++)
        put_block(&p, i);
    buf_printf(out, "</body>\n</html>\n");
}

void epub_clock(struct buf *out, uint64_t ms) {
    buf_printf(out, "%llu:%02u:%02u.%03u", (unsigned long long)(ms / 3600000), (unsigned)(ms / 60000 % 60),
               (unsigned)(ms / 1000 % 60), (unsigned)(ms % 1000));
}

static uint64_t ms_of(uint64_t samples, uint32_t rate) {
    return samples * 1000 / rate;
}

uint64_t epub_smil(struct buf *out, unsigned section, const struct narration_part *part, uint32_t rate) {
    uint64_t whole = rate ? ms_of(part->samples, rate) : 0, from = 0;
    if (!part->count || !whole)
        return 0;
    buf_printf(out,
               "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<smil xmlns=\"http://www.w3.org/ns/SMIL\" "
               "xmlns:epub=\"http://www.idpf.org/2007/ops\" version=\"3.0\">\n<body>\n<seq id=\"all\" "
               "epub:textref=\"s%u.xhtml#all\">\n",
               section);
    for (size_t i = 0; i < part->count; i++) {
        uint64_t to = i + 1 < part->count ? ms_of(part->units[i + 1].start, rate) : whole;
        if (to <= from)
            continue; /* shorter than a millisecond: joins the next clip */
        buf_printf(out, "<par id=\"p%zu\"><text src=\"s%u.xhtml#w%zu\"/><audio src=\"s%u.mp3\" clipBegin=\"",
                   i + 1, section, i + 1, section);
        epub_clock(out, from);
        buf_printf(out, "\" clipEnd=\"");
        epub_clock(out, to);
        buf_printf(out, "\"/></par>\n");
        from = to;
    }
    buf_printf(out, "</seq>\n</body>\n</smil>\n");
    return whole;
}
