/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A text with marks that overlap as they like, as elements that nest: units are whole, marks are closed and
 * opened again at their edges. */
#include "server/base/mem.h"
#include "server/publish/epub_text.h"
#include <stdlib.h>
#include <string.h>

enum event_kind { MARK_ENDS, UNIT_ENDS, POINT, UNIT_BEGINS, MARK_BEGINS }; /* in that order at one place */

struct event {
    size_t at;
    enum event_kind kind;
    size_t number; /* of the mark, or of the unit */
};

struct stretch {
    struct buf *out;
    const struct section *section;
    const struct block *block;
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
            buf_printf(s->out, "<span class=\"stage\">");
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
    case UNIT_BEGINS:
        close_marks(s);
        buf_printf(s->out, "<span id=\"w%zu\">", event->number + 1);
        break;
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

void epub_stretch(struct buf *out, const struct section *section, const struct block *block, size_t from,
                  size_t to, const struct recital_unit *units, size_t first, size_t last) {
    struct stretch s = {.out = out, .section = section, .block = block};
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
        add_event(&s, units[i].from, UNIT_BEGINS, i);
        add_event(&s, units[i].to < to ? units[i].to : to, UNIT_ENDS, i);
    }
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
