/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/lang.h"
#include "server/base/mem.h"
#include "server/base/utf8.h"
#include "server/library/works/readers.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <utf8proc.h>

/* TEI P5 (Guidelines, https://tei-c.org/guidelines/p5): the elements that literature needs. */

struct tei_frame {
    enum tei_act act;
    bool opened;            /* it opened something that its end must close */
    bool foreign;           /* it opened a stretch in another language */
    bool aside;             /* a stage direction within a line of a speech */
    bool begun;             /* CELL: it has had a paragraph */
    bool restored;          /* within <restore>, whose deletions do not hold */
    unsigned child, chosen; /* CHOICE: children so far; the one to read */
    size_t from;            /* REFERENCE: size of the block's text at its start */
    char lang[36];
};

enum { UNKNOWN_MAX = 32 };

struct tei {
    struct tei_frame frames[WORK_DEPTH_MAX + 1];
    struct builder *b;
    struct work_meta *meta;
    struct tei_outline outline;
    struct quotes quotes;
    size_t choice;       /* number of CHOICE elements started */
    size_t speech;       /* number of SPEECH elements started */
    struct buf capture;  /* text of a header field */
    char **wanted;       /* metadata field that is being captured */
    unsigned capture_at; /* depth of the captured element */
    unsigned names;      /* names in it; only the first is used */
    unsigned left_out;   /* open elements in it that are skipped */
    char *first_date;    /* publication date, used if the source has none */
    char **date;         /* a date within the captured element goes here; NULL: none is open */
    size_t date_from;    /* its first byte in `capture` */
    unsigned skip, header, title_stmt, publication, source, creation, bodies,
        divs;                                           /* numbers of open elements */
    unsigned asides, expansions, figures;               /* likewise */
    enum { AFTER_TEXT, AFTER_WORD, AFTER_POINT } after; /* kind of the element that ended last */
    bool joins;                                         /* it declares that the next word joins it */
    bool text_lang;                                     /* the text declared the work's language */
    bool line;                                          /* a line of verse is open */
    bool told_reading;
    char *unknown[UNKNOWN_MAX];
    size_t unknown_count;
    bool is_tei;
};

enum { FIELD_BYTES_MAX = 4096, DATE_BYTES_MAX = 40 };

static void count_header(struct tei *t, const char *name, int by) {
    unsigned *counts[] = {&t->title_stmt, &t->publication, &t->source, &t->creation};
    static const char *const names[] = {"titleStmt", "publicationStmt", "sourceDesc", "creation"};
    for (size_t i = 0; i < sizeof counts / sizeof *counts; i++)
        if (!strcmp(name, names[i]))
            *counts[i] += (unsigned)by;
}

/* ---- header ---- */
static bool is_left_out(const char *name) {
    static const char *const names[] = {"idno", "note", "ptr", "affiliation", "email", "address", NULL};
    return xml_is_one(name, names);
}

static bool is_name(const char *name) {
    static const char *const names[] = {"persName", "name", "orgName", NULL};
    return xml_is_one(name, names);
}

/* Keeps a date. The earliest of the source's is that of the work, and wins over the publication's. */
static void keep_date_at(struct tei *t, char **to, const char *text) {
    if (!*text || strlen(text) >= DATE_BYTES_MAX)
        return;
    if (to == &t->meta->date)
        work_meta_earlier(to, text);
    else
        work_meta_set(to, text);
}

static const char *when_of(const char **attributes) {
    static const char *const when[] = {"when", "from", "notBefore", NULL};
    const char *value = NULL;
    for (const char *const *name = when; !value && *name; name++)
        value = xml_attribute(attributes, *name);
    return value;
}

static bool is_date(const char *name) {
    return !strcmp(name, "date") || !strcmp(name, "origDate");
}

/* Keeps the date of an attribute, or chooses where the text of the element goes. */
static char **date_of(struct tei *t, const char **attributes) {
    char **to = t->source || t->creation ? &t->meta->date : t->publication ? &t->first_date : NULL;
    const char *value = when_of(attributes);
    if (to && value && *value) {
        keep_date_at(t, to, value);
        return NULL;
    }
    return to;
}

/* Keeps the date when the work was written, printed or first played, as corpora of plays tell it. */
static void tei_event(struct tei *t, const char **attributes) {
    static const char *const types[] = {"written", "premiere", "print", "publication", "creation", NULL};
    const char *type = xml_attribute(attributes, "type"), *value = when_of(attributes);
    if (type && value && xml_is_one(type, types))
        keep_date_at(t, &t->meta->date, value);
}

static void tei_header_start(struct tei *t, const struct xml_walk *w, const char *name,
                             const char **attributes) {
    struct work_meta *m = t->meta;
    char **wanted = NULL;
    bool again = false;
    count_header(t, name, 1);
    if (t->wanted) {
        if (is_date(name) && (t->date = date_of(t, attributes)))
            t->date_from = t->capture.size;
        if (is_left_out(name) || (t->wanted == &m->author && is_name(name) && t->names++ > 0) || t->left_out)
            t->left_out++;
        else if (t->capture.size && t->wanted == &m->author)
            buf_add(&t->capture, " ", 1); /* separates the parts of a name */
        return;
    }
    bool own = t->title_stmt && !t->source; /* not of the edition that was transcribed */
    if ((own || !m->title) && t->title_stmt && !strcmp(name, "title"))
        wanted = &m->title;
    else if ((own || !m->author) && t->title_stmt && !strcmp(name, "author"))
        wanted = &m->author, again = true;
    else if (t->publication && !strcmp(name, "publisher"))
        wanted = &m->publisher;
    else if (is_date(name))
        wanted = date_of(t, attributes), again = true;
    else if (t->publication && !strcmp(name, "licence"))
        wanted = &m->licence;
    else if (t->source && (!strcmp(name, "bibl") || !strcmp(name, "p")))
        wanted = &m->source;
    if (wanted && (!*wanted || again)) {
        t->wanted = wanted;
        t->capture_at = w->depth;
        t->names = t->left_out = 0;
    }
    const char *target = wanted == &m->licence ? xml_attribute(attributes, "target") : NULL;
    if (target && t->wanted == wanted && strlen(target) < FIELD_BYTES_MAX)
        buf_printf(&t->capture, "%s ", target);
}

static void tei_header_text(struct tei *t, const char *text, size_t size) {
    if (t->wanted && !t->left_out && t->capture.size + size < FIELD_BYTES_MAX)
        buf_add(&t->capture, text, size);
}

/* Joins several authors with semicolons. */
static void keep_field(struct tei *t, const char *text) {
    if (t->wanted == &t->meta->author && t->meta->author && *text) {
        struct buf both = {0};
        if (strlen(t->meta->author) + strlen(text) < FIELD_BYTES_MAX) {
            buf_printf(&both, "%s; %s", t->meta->author, text);
            buf_add(&both, "", 1);
            free(t->meta->author);
            t->meta->author = (char *)both.data;
        }
    } else if (t->wanted == &t->meta->date || t->wanted == &t->first_date) {
        keep_date_at(t, t->wanted, text);
    } else {
        work_meta_set(t->wanted, text);
    }
}

/* Returns the captured text from a byte on, with single spaces. Free it. */
static char *captured(const struct tei *t, size_t from) {
    char *text =
        mem_strndup(t->capture.size > from ? (char *)t->capture.data + from : "", t->capture.size - from);
    char *to = text;
    for (const char *c = text; *c; c++)
        if (!strchr(" \t\r\n", *c))
            *to++ = *c;
        else if (to > text && to[-1] != ' ')
            *to++ = ' ';
    *to = '\0';
    if (to > text && to[-1] == ' ')
        to[-1] = '\0';
    return text;
}

/* Keeps the text of a date without attributes, which has ended. */
static void keep_date(struct tei *t) {
    char *text = captured(t, t->date_from);
    keep_date_at(t, t->date, text);
    free(text);
    t->date = NULL;
}

static void tei_header_end(struct tei *t, const struct xml_walk *w, const char *name) {
    count_header(t, name, -1);
    if (!t->wanted)
        return;
    if (t->capture_at != w->depth) {
        if (is_date(name) && t->date)
            keep_date(t);
        t->left_out -= t->left_out > 0;
        return;
    }
    char *text = captured(t, 0);
    keep_field(t, text);
    free(text);
    buf_free(&t->capture);
    t->wanted = NULL;
}

/* ---- text ---- */

/* Reports each unknown name once. */
static void tell_unknown(struct tei *t, const struct xml_walk *w, const char *name) {
    struct error e;
    for (size_t i = 0; i < t->unknown_count; i++)
        if (!strcmp(t->unknown[i], name))
            return;
    if (t->unknown_count == UNKNOWN_MAX)
        return;
    t->unknown[t->unknown_count++] = mem_strdup(name);
    error_at_line(&e, ERROR_UNKNOWN_ELEMENT, xml_walk_line(w), xml_walk_column(w),
                  "<%.60s> is unknown: only its content is read", name);
    build_problem(t->b, &e, false);
}

/* Reads a language tag into `out`. NULL if it is invalid, which is reported. */
static const char *tei_lang(struct tei *t, const struct xml_walk *w, const char *lang,
                            char out[LANG_BYTES + 1]) {
    struct error e;
    size_t bad;
    if (!lang || !*lang)
        return NULL;
    if (lang_read(lang, strlen(lang), out, &bad))
        return out;
    error_at_line(&e, ERROR_BAD_VALUE, xml_walk_line(w), xml_walk_column(w),
                  "\"%.40s\" is not a language tag (BCP 47, such as pt-BR)", lang);
    build_problem(t->b, &e, false);
    return NULL;
}

/* Starts a stretch in another language than its surroundings. */
static void start_foreign(struct tei *t, struct tei_frame *f) {
    build_mark(t->b, MARK_FOREIGN, *f->lang ? f->lang : NULL);
    f->foreign = true;
}

static bool is_no(const char **attributes, const char *name) {
    const char *value = xml_attribute(attributes, name);
    return value && !strcmp(value, "no");
}

/* True for the end of a name in a reading of Perseus, whose tags are empty elements: an ending may follow. */
static bool ends_name(const char *name, const char **attributes) {
    const char *gi = xml_attribute(attributes, "gi");
    return !strcmp(name, "tagEnd") && gi && !strcmp(gi, "name");
}

static void start_inline(struct tei *t, struct tei_frame *f, const char *name, const char **attributes) {
    struct builder *b = t->b;
    if (!build_is_open(b))
        return;
    f->opened = f->act == ACT_EMPHASIS || f->act == ACT_NAME;
    if (f->act == ACT_EMPHASIS)
        build_mark(b, MARK_EMPHASIS, NULL);
    else if (f->act == ACT_NAME)
        build_mark(b, MARK_NAME, NULL);
    else if (f->act == ACT_FOREIGN && !f->foreign)
        build_mark(b, MARK_FOREIGN, NULL), f->foreign = true;
    else if (f->act == ACT_BREAK || (f->act == ACT_COLUMN && is_no(attributes, "break")))
        build_break(b, is_no(attributes, "break"));
    else if (f->act == ACT_SPACE && is_no(attributes, "break"))
        build_break(b, true);
    else if (f->act == ACT_SPACE && !ends_name(name, attributes))
        build_text(b, " ", 1);
    else if (f->act == ACT_GAP)
        build_text(b, "[…]", strlen("[…]"));
}

/* Tokenised text: words are separated by white space unless they say otherwise. */
static void start_word(struct tei *t, const struct tei_frame *f, const char **attributes) {
    const char *join = xml_attribute(attributes, "join"), *part = xml_attribute(attributes, "part");
    bool joins = join && (!strcmp(join, "left") || !strcmp(join, "both"));
    bool goes_on = part && (*part == 'F' || *part == 'M');
    if (f->act == ACT_WORD && t->after == AFTER_WORD && !joins && !t->joins && !goes_on)
        build_text(t->b, " ", 1);
    if (f->act == ACT_WORD && t->after == AFTER_POINT && !joins && !t->joins && build_is_open(t->b)) {
        const struct buf *text = &build_top(t->b)->text;
        if (text->size && strchr(".,;:!?)]", text->data[text->size - 1]))
            build_text(t->b, " ", 1);
    }
}

static void end_word(struct tei *t, const struct tei_frame *f) {
    t->after = f->act == ACT_WORD ? AFTER_WORD : AFTER_POINT;
    t->joins = f->opened;
}

/* True in a note or within a line, where a nested block becomes a line. */
static bool in_inset(const struct tei *t) {
    return build_is_open(t->b) &&
           (t->asides || build_kind(t->b) == BLOCK_NOTE || build_kind(t->b) == BLOCK_STAGE);
}

/* True when a block is open, and in verse a line of it. */
static bool in_line(const struct tei *t) {
    const struct block *block = build_top(t->b);
    return block && (block->kind != BLOCK_VERSE || t->line);
}

/* A stage direction or a figure's title inside a speech stays within it; between two lines it becomes a
 * block. */
static bool start_aside(struct tei *t, struct tei_frame *f) {
    if (!in_line(t))
        return false;
    build_apart(t->b);
    if (f->act == ACT_STAGE && build_kind(t->b) != BLOCK_STAGE) {
        build_mark(t->b, MARK_STAGE, NULL);
        f->opened = true;
    }
    f->aside = true;
    t->asides++;
    return true;
}

static void start_block(struct tei *t, struct tei_frame *f, const char **attributes) {
    struct builder *b = t->b;
    const char *n = xml_attribute(attributes, "n"), *rend = xml_attribute(attributes, "rend"),
               *part = xml_attribute(attributes, "part");
    if (t->asides && f->act != ACT_NOTE) {
        build_apart(b);
        return;
    }
    if (in_inset(t) && f->act != ACT_NOTE && f->act != ACT_STAGE) {
        build_newline(b);
        return;
    }
    if (f->act == ACT_STAGE && start_aside(t, f))
        return;
    struct block *top = build_top(b);
    if (f->act == ACT_PARAGRAPH && (f - 1)->act == ACT_PARAGRAPH && (f - 1)->opened && top) {
        build_apart(b); /* the date of an imprint, the author of a byline */
        return;
    }
    if (f->act == ACT_PARAGRAPH && (f - 1)->act == ACT_CELL && !(f - 1)->opened && !(f - 1)->begun && top) {
        (f - 1)->begun = true;
        return;
    }
    f->opened = true;
    if (f->act == ACT_CELL && top && top->item && (f - 1)->act == ACT_ROW) {
        build_join_cells(b);
        f->opened = false;
        return;
    }
    if (f->act == ACT_PARAGRAPH && top && top->item && !top->text.size)
        return; /* the item has no text before it */
    switch (f->act) {
    case ACT_HEAD:
        build_block(b, t->figures ? BLOCK_PARAGRAPH : BLOCK_HEAD);
        break;
    case ACT_PARAGRAPH:
    case ACT_ITEM:
    case ACT_ROW:
    case ACT_CELL:
        build_block(b, BLOCK_PARAGRAPH);
        build_top(b)->item = f->act != ACT_PARAGRAPH;
        break;
    case ACT_GROUP:
        build_block(b, BLOCK_VERSE);
        break;
    case ACT_LINE:
        build_line(b, n, rend && strstr(rend, "indent"));
        if (part && (*part == 'M' || *part == 'F') && !part[1])
            build_line_goes_on(b);
        t->line = true;
        break;
    case ACT_SPEAKER:
        build_block(b, BLOCK_SPEAKER);
        break;
    case ACT_STAGE:
        build_block(b, BLOCK_STAGE);
        break;
    default:
        build_inset(b, BLOCK_NOTE, n);
    }
}

/* The work's language is that of its text, else of the document; elements inherit it. */
static void set_lang(struct tei *t, struct tei_frame *f, const char *name, const char *lang) {
    snprintf(f->lang, sizeof f->lang, "%s", lang ? lang : (f - 1)->lang);
    t->b->lang = f->lang;
    if (f->act == ACT_ROOT && lang && (!*t->frames[1].lang || (!strcmp(name, "text") && !t->text_lang))) {
        memmove(t->frames[1].lang, f->lang, sizeof f->lang);
        t->text_lang = !strcmp(name, "text");
    }
}

/* Skips the alternatives that are not chosen. */
static void choose(struct tei *t, struct tei_frame *f, const struct xml_walk *w, const char *name) {
    struct tei_frame *up = f - 1;
    if (f->act == ACT_CHOICE) {
        f->chosen = t->choice < t->outline.count ? t->outline.choices[t->choice] : 0;
        t->choice++;
    }
    if (up->act != ACT_CHOICE)
        return;
    bool rdg = !strcmp(name, "rdg") && up->child == up->chosen && !t->skip && !t->header;
    if (up->child++ != up->chosen)
        f->act = ACT_SKIP;
    if (rdg && !t->told_reading) {
        struct error e;
        t->told_reading = true;
        error_at_line(&e, ERROR_UNKNOWN_ELEMENT, xml_walk_line(w), xml_walk_column(w),
                      "<app> without <lem>: its first reading is used, here and elsewhere");
        build_problem(t->b, &e, false);
    }
}

/* Notes who speaks, and names them where the text does not: by the list of persons, else by the id. */
static void name_speaker(struct tei *t, const char *who) {
    struct buf names = {0}, ids = {0};
    const size_t speech = t->speech - 1;
    if (!who)
        return;
    for (; *(who += strspn(who, " \t\r\n")) && names.size < FIELD_BYTES_MAX;) {
        size_t size = strcspn(who, " \t\r\n");
        const char *hash = memchr(who, '#', size), *id = hash ? hash + 1 : who;
        char *key = mem_strndup(id, (size_t)(who + size - id));
        const struct work_person *person = tei_persons_find(&t->outline.persons, key);
        buf_printf(&names, "%s%s", names.size ? ", " : "", person && *person->name ? person->name : key);
        buf_printf(&ids, "%s%s", ids.size ? "+" : "", key);
        free(key);
        who += size;
    }
    buf_add(&names, "", 1);
    buf_add(&ids, "", 1);
    build_who(t->b, (char *)ids.data);
    if (speech >= t->outline.speech_count || !t->outline.speeches[speech])
        build_speaker(t->b, (char *)names.data);
    buf_free(&names);
    buf_free(&ids);
}

static bool is_inline(enum tei_act act) {
    return act == ACT_PASS || act == ACT_APART || act == ACT_UNKNOWN ||
           (act >= ACT_EMPHASIS && act <= ACT_NAME) ||
           (act >= ACT_CHOICE && act != ACT_ROW && act != ACT_CELL);
}

static void start_other(struct tei *t, struct tei_frame *f, const struct xml_walk *w, const char *name,
                        const char **attributes) {
    const char *target;
    switch (f->act) {
    case ACT_BODY:
        f->opened = !t->bodies++; /* not of a floating text */
        if (f->opened)
            build_section(t->b, 1);
        break;
    case ACT_DIV:
        build_section(t->b, ++t->divs);
        break;
    case ACT_SPEECH:
        build_end(t->b);
        name_speaker(t, xml_attribute(attributes, "who"));
        break;
    case ACT_PAGE:
        if (is_no(attributes, "break"))
            build_break(t->b, true);
        build_page(t->b, xml_attribute(attributes, "n"));
        break;
    case ACT_EMPHASIS:
    case ACT_NAME:
    case ACT_FOREIGN:
    case ACT_BREAK:
    case ACT_COLUMN:
    case ACT_SPACE:
    case ACT_GAP:
        start_inline(t, f, name, attributes);
        break;
    case ACT_UNKNOWN:
        tell_unknown(t, w, name);
        break;
    case ACT_EXPANSION:
        t->expansions++;
        break;
    case ACT_WORD:
    case ACT_POINT:
        start_word(t, f, attributes);
        target = xml_attribute(attributes, "join");
        f->opened = target && (!strcmp(target, "right") || !strcmp(target, "both"));
        break;
    case ACT_REFERENCE:
        target = xml_attribute(attributes, "target");
        f->opened =
            target && *target == '#' && build_is_open(t->b) && tei_outline_has_note(&t->outline, target + 1);
        f->from = build_is_open(t->b) ? build_top(t->b)->text.size : 0;
        break;
    case ACT_FIGURE:
        t->figures++;
        start_aside(t, f);
        break;
    case ACT_QUOTE:
        quotes_begin(&t->quotes, t->b, (f - 1)->lang);
        break;
    case ACT_APART:
        build_apart(t->b);
        break;
    case ACT_ROOT:
    case ACT_PASS:
    case ACT_CHOICE:
    case ACT_SIGN:
        break;
    default:
        start_block(t, f, attributes);
    }
}

static void on_start(struct xml_walk *w, const char *name, const char **attributes) {
    struct tei *t = w->ctx;
    struct tei_frame *f = &t->frames[w->depth];
    char tag[LANG_BYTES + 1];
    const char *lang = tei_lang(t, w, xml_attribute(attributes, "lang"), tag);
    *f = (struct tei_frame){.act = tei_act_of(name)};
    if (w->depth == 1)
        t->is_tei = f->act == ACT_ROOT;
    f->restored = !strcmp(name, "restore") || ((f - 1)->restored && strcmp(name, "subst") != 0);
    if (f->restored && !strcmp(name, "del"))
        f->act = ACT_PASS;
    t->speech += f->act == ACT_SPEECH;
    choose(t, f, w, name);
    if (t->skip && !strcmp(name, "event"))
        tei_event(t, attributes);
    if (f->act == ACT_SIGN && t->expansions)
        f->act = ACT_SKIP;
    if (t->skip || f->act == ACT_SKIP) {
        memcpy(f->lang, (f - 1)->lang, sizeof f->lang);
        f->act = ACT_SKIP;
        t->skip++;
        return;
    }
    set_lang(t, f, name, t->header || f->act == ACT_HEADER ? NULL : lang);
    if (t->header || f->act == ACT_HEADER) {
        f->act = ACT_HEADER;
        t->header++;
        const char *ident =
            !strcmp(name, "language") ? tei_lang(t, w, xml_attribute(attributes, "ident"), tag) : NULL;
        if (ident && !*t->frames[1].lang)
            snprintf(t->frames[1].lang, sizeof t->frames[1].lang, "%s", ident);
        tei_header_start(t, w, name, attributes);
        return;
    }
    if (lang && is_inline(f->act) && in_line(t) && strcmp(lang, (f - 1)->lang) != 0)
        start_foreign(t, f);
    start_other(t, f, w, name, attributes);
    if (f->act == ACT_LINE && f->opened && build_is_open(t->b)) { /* the line may have opened a block */
        const char *around = build_top(t->b)->lang;
        if (*f->lang && strcmp(f->lang, around ? around : "") != 0)
            start_foreign(t, f);
    }
    if (f->act != ACT_WORD && f->act != ACT_POINT && f->act != ACT_PASS)
        t->after = AFTER_TEXT;
}

/* The speaker's name without stage directions. */
static char *name_of(const struct block *block) {
    struct buf text = {0};
    block_spoken(block, &text);
    size_t size = text.size, from = 0;
    while (from < size && text.data[from] == ' ')
        from++;
    while (size > from && (text.data[size - 1] == ' ' || text.data[size - 1] == '\n'))
        size--;
    char *name = mem_strndup(text.size ? (char *)text.data + from : "", size - from);
    buf_free(&text);
    return name;
}

static void end_block(struct tei *t, const struct tei_frame *f) {
    struct builder *b = t->b;
    if (f->act == ACT_LINE) {
        build_line_end(b);
        t->line = false;
    } else if (f->act == ACT_NOTE) {
        build_inset_end(b);
    } else if (f->act == ACT_SPEAKER && build_is_open(b)) {
        char *who = name_of(build_top(b));
        build_end(b);
        build_speaker(b, who);
        free(who);
    } else {
        build_end(b);
    }
}

/* True for digits, asterisks and brackets, and at most one letter: a note's sign rather than a word. */
static bool is_sign(const char *text, size_t size) {
    size_t letters = 0;
    for (size_t at = 0, length; at < size; at += length ? length : 1) {
        uint32_t cp = 0;
        length = utf8_next(text + at, size - at, &cp);
        int category = utf8proc_category((utf8proc_int32_t)cp);
        letters += category >= UTF8PROC_CATEGORY_LU && category <= UTF8PROC_CATEGORY_LO;
    }
    return size <= 12 && letters <= 1;
}

static void end_reference(struct tei *t, const struct tei_frame *f) {
    const struct block *block = build_top(t->b);
    if (f->opened && block && block->text.size > f->from &&
        is_sign((char *)block->text.data + f->from, block->text.size - f->from)) {
        build_cut(t->b, f->from);
        build_apart(t->b);
    }
}

static void end_other(struct tei *t, const struct tei_frame *f) {
    switch (f->act) {
    case ACT_BODY:
        t->bodies--;
        if (f->opened)
            build_section(t->b, 1);
        break;
    case ACT_DIV:
        t->divs--;
        build_section(t->b, t->divs ? t->divs : 1);
        break;
    case ACT_SPEECH:
        build_end(t->b);
        build_speaker(t->b, NULL);
        build_who(t->b, NULL);
        break;
    case ACT_EXPANSION:
        t->expansions--;
        break;
    case ACT_FIGURE:
        t->figures--;
        break;
    case ACT_WORD:
    case ACT_POINT:
        end_word(t, f);
        break;
    case ACT_APART:
        build_apart(t->b);
        break;
    case ACT_REFERENCE:
        end_reference(t, f);
        break;
    case ACT_EMPHASIS:
    case ACT_NAME:
        if (f->opened)
            build_mark_end(t->b, f->act == ACT_EMPHASIS ? MARK_EMPHASIS : MARK_NAME);
        break;
    default:
        if (f->opened)
            end_block(t, f);
    }
}

static void on_end(struct xml_walk *w, const char *name) {
    struct tei *t = w->ctx;
    struct tei_frame *f = &t->frames[w->depth];
    if (f->act == ACT_SKIP) {
        t->skip--;
    } else if (f->act == ACT_HEADER) {
        tei_header_end(t, w, name);
        t->header--;
    } else {
        if (f->act == ACT_QUOTE)
            quotes_end(&t->quotes, t->b);
        if (f->foreign)
            build_mark_end(t->b, MARK_FOREIGN);
        if (f->aside) {
            if (f->opened)
                build_mark_end(t->b, MARK_STAGE);
            build_apart(t->b);
            t->asides--;
            f->opened = false;
        }
        end_other(t, f);
        if (f->act != ACT_WORD && f->act != ACT_POINT && f->act != ACT_PASS)
            t->after = AFTER_TEXT;
    }
    t->b->lang = t->frames[w->depth - 1].lang;
}

static void on_text(struct xml_walk *w, const char *text, size_t size) {
    struct tei *t = w->ctx;
    if (t->skip)
        return;
    if (t->header) {
        tei_header_text(t, text, size);
        return;
    }
    if (t->frames[w->depth].act == ACT_CHOICE) /* white space between alternatives */
        return;
    if ((!build_is_open(t->b) || (build_kind(t->b) == BLOCK_VERSE && !t->line)) && t->bodies) {
        size_t i = 0;
        while (i < size && strchr(" \t\r\n", text[i]))
            i++;
        if (i < size)
            build_block(t->b, BLOCK_PARAGRAPH);
    }
    t->after = AFTER_TEXT;
    size_t done = t->quotes.depth ? quotes_text(&t->quotes, t->b, text, size) : 0;
    build_text(t->b, text + done, size - done);
}

static void on_entity(struct xml_walk *w, const char *name) {
    struct tei *t = w->ctx;
    struct error e;
    char text[ENTITY_BYTES_MAX];
    size_t size = xml_entity(name, text);
    if (size) {
        on_text(w, text, size);
        return;
    }
    error_at_line(&e, ERROR_ENTITY, xml_walk_line(w), xml_walk_column(w),
                  "&%.60s; is not declared in the file: it is dropped", name);
    build_problem(t->b, &e, false);
}

int tei_read(const char *data, size_t size, struct work_meta *meta, struct builder *b, struct error *e) {
    struct tei *t = mem_alloc(sizeof *t);
    struct xml_walk walk = {.ctx = t,
                            .start = on_start,
                            .end = on_end,
                            .text = on_text,
                            .entity = on_entity,
                            .stop = &b->stopped};
    t->b = b;
    t->meta = meta;
    b->work_lang = meta->lang;
    tei_outline_read(&t->outline, data, size);
    b->where = xml_walk_where;
    b->where_ctx = &walk;
    meta->format = "tei";
    int result = xml_walk(&walk, data, size, e);
    if (!result && !t->is_tei)
        result =
            error_at_line(e, ERROR_BAD_WORK, 1, 1, "the root element is neither TEI nor a supported markup");
    while (build_is_open(b))
        build_end(b);
    b->lang = b->work_lang = NULL;
    b->where = NULL;
    work_meta_set(&meta->date, t->first_date);
    work_meta_title(meta->title);
    free(t->first_date);
    tei_persons_take(&t->outline.persons, meta);
    tei_outline_free(&t->outline);
    if (*t->frames[1].lang) {
        free(meta->lang);
        meta->lang = mem_strdup(t->frames[1].lang);
    }
    for (size_t i = 0; i < t->unknown_count; i++)
        free(t->unknown[i]);
    buf_free(&t->capture);
    free(t);
    return result;
}
