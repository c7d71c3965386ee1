/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Readers of files build a work from consecutive blocks, grouped into sections. */
#ifndef FACCIA_LIBRARY_WORKS_READERS_H
#define FACCIA_LIBRARY_WORKS_READERS_H

#include "server/base/error.h"
#include "server/library/works/work.h"
#include <expat.h>
#include <stdbool.h>
#include <time.h>

/* work_meta.c: sets a date, unless the one that is set has an earlier year. */
void work_meta_earlier(char **date, const char *text);

/* Removes the years of their lives from names of authors, which semicolons divide. NULL: nothing. */
void work_meta_authors(char *authors);

/* Removes from the end of a title that it is an electronic edition. NULL: nothing. */
void work_meta_title(char *title);

struct builder {
    const struct work_sink *sink;
    struct section section;
    struct block *open[NOTE_DEPTH_MAX]; /* the current block and the insets in it, outermost first */
    bool waits[NOTE_DEPTH_MAX];         /* whether white space was pending before the inset */
    unsigned depth;
    struct block *pending; /* insets that follow the block */
    size_t pending_count, pending_cap;
    char *speaker, *who;
    char verse[24];            /* number of the last line of verse */
    const char *lang;          /* language of what comes next; owned by the reader */
    const char *work_lang;     /* that of the work, likewise; NULL: not known yet */
    unsigned sections, told;   /* counts */
    bool space, stopped, keep; /* space: white space is pending; keep: white space is kept verbatim */
    enum {
        BREAK_NONE,
        BREAK_JOINS,
        BREAK_HYPHEN,
        BREAK_APART
    } line_break;          /* to be resolved by the next text */
    bool soft;             /* the last character was a soft hyphen */
    bool cut;              /* the block's excess length was reported */
    uint64_t bytes;        /* size of the work so far, limited by bytes_max */
    uint64_t bytes_max;    /* WORK_BYTES_MAX, unless builder_allow has raised it */
    struct timespec begun; /* processor time of the thread at the start */
    struct error why;      /* the reason for `stopped`, if a limit caused it */
    void (*where)(void *ctx, size_t *line,
                  size_t *column); /* reports the position in the file; NULL: unknown */
    void *where_ctx;
};

/* The reader may set lang at any time. */
void builder_open(struct builder *b, const struct work_sink *sink);

/* Raises the size limit to a multiple of the file's size. */
void builder_allow(struct builder *b, uint64_t file_bytes);

/* Delivers the rest. Nonzero: the sink has stopped the reading. */
int builder_close(struct builder *b);

/* Reports why reading stopped: a limit of the work (ERROR_BAD_WORK, with its place) or the sink. Returns
 * -1. */
int builder_why(const struct builder *b, struct error *e);

/* Starts a section of that level, from 1. Its title is its first heading. */
void build_section(struct builder *b, unsigned level);

/* Starts a block, and ends the current one. */
void build_block(struct builder *b, enum block_kind kind);
void build_end(struct builder *b);
bool build_is_open(const struct builder *b);
enum block_kind build_kind(const struct builder *b); /* kind of the innermost open block */
struct block *build_top(struct builder *b);          /* the innermost open block, or NULL */

/* Collapses white space to one space, and strips it at the ends of blocks and lines. Drops soft hyphens
 * and zero-width characters. */
void build_text(struct builder *b, const char *text, size_t size);
void build_newline(struct builder *b);

/* Marks the end of a line, column or page of the edition. join: it divides a word, whose hyphen is
 * dropped. Otherwise it is white space, except that a hyphenated word is joined if it continues with a
 * lower-case letter. */
void build_break(struct builder *b, bool join);

/* Separates what comes next: inserts a space before a letter or digit that follows one, or a mark. */
void build_apart(struct builder *b);

/* Separates the next cell of a table's row from the one before, if there is one. */
void build_join_cells(struct builder *b);

/* Truncates the text of the innermost block to `size` bytes. */
void build_cut(struct builder *b, size_t size);

/* Begins a mark at the current end of the text; build_mark_end ends it there. Marks nest. */
void build_mark(struct builder *b, enum mark_kind kind, const char *value);
void build_mark_end(struct builder *b, enum mark_kind kind);

/* Starts a line of verse. n is the edition's number, or NULL. */
void build_line(struct builder *b, const char *n, bool indent);
void build_line_end(struct builder *b);

/* The line just started continues the verse of the line before it, in whatever speech: it is indented and has
 * that line's number. */
void build_line_goes_on(struct builder *b);

/* Starts a note or a stage direction, inside a block or on its own. */
void build_inset(struct builder *b, enum block_kind kind, const char *n);
void build_inset_end(struct builder *b);

void build_page(struct builder *b, const char *n);
void build_speaker(struct builder *b, const char *name); /* NULL: no speaker from here on */
void build_who(struct builder *b, const char *who);      /* ids of who speaks; NULL: none */

/* Reports a problem to the sink; only the first PROBLEMS_MAX are reported. */
void build_problem(struct builder *b, const struct error *e, bool serious);

/* quotes.c: marks that an element implies are written unless the source has marks there already. A quotation
 * that continues in another block gets none. */
enum { QUOTES_MAX = 8 };
struct quotes {
    struct quote {
        bool waits, opened; /* waits: for its first text */
        unsigned section;   /* where it began */
        char block[16], lang[36];
    } list[QUOTES_MAX];
    unsigned depth;
};

void quotes_begin(struct quotes *quotes, struct builder *b, const char *lang); /* of the surroundings */

/* Call it before a text is added. Returns how much of it, white space, has been added. */
size_t quotes_text(struct quotes *quotes, struct builder *b, const char *text, size_t size);
void quotes_end(struct quotes *quotes, struct builder *b);

/* Parses an untrusted XML document with expat: external entities are not read, expat's limits on entity
 * expansion apply, and excessive depth is an error. Names lose their namespace prefix. */

struct xml_walk {
    XML_Parser parser;
    void *ctx;
    void (*start)(struct xml_walk *walk, const char *name, const char **attributes);
    void (*end)(struct xml_walk *walk, const char *name);
    void (*text)(struct xml_walk *walk, const char *text, size_t size);
    void (*entity)(struct xml_walk *walk, const char *name); /* an undeclared entity; NULL: ignored */
    const bool *stop; /* stops the parsing without an error when true; may be NULL */
    unsigned depth;
    struct error *e; /* set on failure */
    int result;
};

/* The caller sets everything but the parser. -1 with *e at its line: "bad-work". */
int xml_walk(struct xml_walk *walk, const char *data, size_t size, struct error *e);

/* Writes the characters of an HTML entity ("eacute") to out. Returns their length; 0: HTML has no such
 * entity. */
enum { ENTITY_BYTES_MAX = 16 };
size_t xml_entity(const char *name, char out[ENTITY_BYTES_MAX]);

/* For builder's `where`; ctx is the walk. */
void xml_walk_where(void *walk, size_t *line, size_t *column);

/* Current position. */
size_t xml_walk_line(const struct xml_walk *walk);
size_t xml_walk_column(const struct xml_walk *walk);

/* Value of the attribute with that local name, or NULL. */
const char *xml_attribute(const char **attributes, const char *name);

/* True when the attribute with that local name contains the word. A prefix of the word ("z3998:") is
 * ignored. */
bool xml_has_token(const char **attributes, const char *name, const char *word);

/* True when the name is in a NULL-terminated list. */
int xml_is_one(const char *name, const char *const *list);

/* Readers, one for each file format. Each fills in metadata, builds the sections and reports what it
 * leaves out. -1 with *e: the rest cannot be read. */

/* TEI P5 and P4: teiHeader; text, front, body, back, div, head, p, ab, list, item, lg, l, sp, speaker,
 * stage, note, pb, lb, foreign, names, emphasis, w, pc, gap. Of choice and app it reads one child: the
 * correction, regularisation, expansion or lemma, else the first. */
int tei_read(const char *data, size_t size, struct work_meta *meta, struct builder *builder, struct error *e);

/* EPUB 2 and 3: reads the package's metadata and each document of its spine once. The caller keeps fd. */
int epub_read(int fd, struct work_meta *meta, struct builder *builder, struct error *e);

/* Reads one XHTML document of an EPUB. Its problems name that file. */
int xhtml_read(const char *data, size_t size, const char *name, struct builder *builder, struct error *e);

/* CommonMark with tables, footnotes, strikethrough and task lists (GitHub Flavored Markdown), optionally
 * headed by "key: value" lines between two --- lines: title, author, lang, date, publisher, licence, source.
 * A paragraph with hard line breaks is verse. */
int commonmark_read(const char *data, size_t size, struct work_meta *meta, struct builder *builder,
                    struct error *e);

/* Reads that header. Returns its size in bytes; 0: none. */
size_t front_matter_read(const char *data, size_t size, struct work_meta *meta, struct builder *b);

/* Plain text: empty lines separate paragraphs. A paragraph of two or more lines, none longer than 60
 * characters, is verse unless its lines are as full as those of wrapped prose. "CHAPTER II" and the like
 * begin a section. The header of Markdown files is accepted, too. */
int plain_work_read(const char *data, size_t size, struct work_meta *meta, struct builder *builder,
                    struct error *e);

/* APML, JSML and SSML. */
int markup_work_read(const char *data, size_t size, const char *markup, struct work_meta *meta,
                     struct builder *builder, struct error *e);

/* tei_persons.c: the persons that a document lists, collected while it is walked. */
struct tei_persons {
    struct work_person *list; /* in document order */
    size_t count, cap;
    struct work_person **by_id; /* those with an id, each once, sorted */
    size_t id_count;
    struct work_person now; /* the one that is open */
    struct buf name, about, word;
    unsigned at, name_at, about_at, sex_at, age_at, out_at; /* depths of the open elements; 0: none */
    bool cast_item;                                         /* text outside other elements describes */
};

/* Call them for each element and text, then tei_persons_done before the rest. */
void tei_persons_start(struct tei_persons *persons, unsigned depth, const char *name,
                       const char **attributes);
void tei_persons_text(struct tei_persons *persons, const char *text, size_t size);
void tei_persons_end(struct tei_persons *persons, unsigned depth);
void tei_persons_done(struct tei_persons *persons);
const struct work_person *tei_persons_find(const struct tei_persons *persons, const char *id);
void tei_persons_take(struct tei_persons *persons, struct work_meta *meta); /* moves them */
void tei_persons_free(struct tei_persons *persons);

/* tei_outline.c: collected in a first pass. */
struct tei_outline {
    unsigned *choices; /* which child of each CHOICE to read, in document order */
    size_t count, cap;
    char **notes; /* ids, sorted */
    size_t note_count, note_cap;
    bool *speeches; /* whether each SPEECH has a speaker's name, in document order */
    size_t speech_count, speech_cap;
    struct tei_persons persons;
};

/* Fills the outline. Errors in the document are left to the second pass. */
void tei_outline_read(struct tei_outline *outline, const char *data, size_t size);
void tei_outline_free(struct tei_outline *outline);
bool tei_outline_has_note(const struct tei_outline *outline, const char *id);

/* tei_elements.c: what the TEI reader does with an element. */
enum tei_act {
    ACT_PASS,  /* only its content counts */
    ACT_APART, /* the same, but no word continues across its ends */
    ACT_UNKNOWN,
    ACT_SKIP,
    ACT_ROOT,
    ACT_HEADER,
    ACT_BODY,
    ACT_DIV,
    ACT_HEAD,
    ACT_PARAGRAPH,
    ACT_ITEM,
    ACT_GROUP,
    ACT_LINE,
    ACT_SPEECH,
    ACT_SPEAKER,
    ACT_STAGE,
    ACT_NOTE,
    ACT_EMPHASIS,
    ACT_FOREIGN,
    ACT_NAME,
    ACT_PAGE,
    ACT_COLUMN, /* a column break or another marker that is not white space */
    ACT_BREAK,
    ACT_SPACE,
    ACT_GAP,
    ACT_CHOICE, /* contains alternatives; only one is read */
    ACT_EXPANSION,
    ACT_SIGN, /* abbreviation sign, not read where the abbreviation is expanded */
    ACT_WORD,
    ACT_POINT, /* punctuation */
    ACT_REFERENCE,
    ACT_FIGURE,
    ACT_ROW, /* of a table */
    ACT_CELL,
    ACT_QUOTE, /* speech that the element marks */
};
enum tei_act tei_act_of(const char *name);

#endif
