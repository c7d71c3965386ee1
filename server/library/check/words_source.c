/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Scans the source of a work for its words, by other means than the readers': no XML or Markdown library, and
 * tables of its own. */
#include "server/library/check/words_source.h"
#include "server/base/buf.h"
#include "server/base/mem.h"
#include "server/base/utf8.h"
#include "server/library/works/readers.h"
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <utf8proc.h>
#include <zip.h>

enum { CHOICES_MAX = 64, NAME_MAX_BYTES = 40 };

/* ---- XML and HTML, scanned as text ---- */

struct scanner {
    const char *data;
    size_t size, at;
    uint32_t line;
    struct buf entities; /* "name\0value\0" of the document's own declarations */
};

struct token {
    enum { TOKEN_END, TOKEN_TEXT, TOKEN_VERBATIM, TOKEN_START, TOKEN_CLOSE } kind;
    char name[NAME_MAX_BYTES];
    const char *text; /* of a text, or the attributes of a start */
    size_t size;
    bool empty;
};

static void advance(struct scanner *s, size_t to) {
    for (to = to < s->size ? to : s->size; s->at < to; s->at++)
        s->line += s->data[s->at] == '\n';
}

static size_t find(const struct scanner *s, size_t from, const char *what) {
    const char *at = from < s->size ? memmem(s->data + from, s->size - from, what, strlen(what)) : NULL;
    return at ? (size_t)(at - s->data) : s->size;
}

static bool begins(const struct scanner *s, const char *what) {
    size_t length = strlen(what);
    return s->size - s->at >= length && !memcmp(s->data + s->at, what, length);
}

/* Position after a tag or declaration: its '>' outside quotes and brackets. */
static size_t tag_end(const struct scanner *s, size_t at) {
    char quote = 0;
    unsigned brackets = 0;
    for (; at < s->size; at++) {
        char c = s->data[at];
        if (quote)
            quote = c == quote ? 0 : quote;
        else if (c == '"' || c == '\'')
            quote = c;
        else if (c == '[')
            brackets++;
        else if (c == ']' && brackets)
            brackets--;
        else if (c == '>' && !brackets)
            return at + 1;
    }
    return s->size;
}

/* Keeps `<!ENTITY name "value">` declarations. */
static void keep_entities(struct scanner *s, size_t from, size_t to) {
    for (size_t at = find(s, from, "<!ENTITY"); at < to; at = find(s, at + 1, "<!ENTITY")) {
        const char *text = s->data + at + strlen("<!ENTITY"), *end = s->data + to;
        text += strspn(text, " \t\r\n");
        size_t name = strcspn(text, " \t\r\n\"'>");
        const char *value = text + name + strspn(text + name, " \t\r\n");
        const char *close = value < end && (*value == '"' || *value == '\'')
                                ? memchr(value + 1, *value, (size_t)(end - value - 1))
                                : NULL;
        if (!close || *text == '%')
            continue;
        buf_add(&s->entities, text, name);
        buf_add(&s->entities, "", 1);
        buf_add(&s->entities, value + 1, (size_t)(close - value - 1));
        buf_add(&s->entities, "", 1);
    }
}

static void copy_name(const char *from, size_t size, char out[NAME_MAX_BYTES]) {
    const char *colon = memrchr(from, ':', size);
    if (colon) {
        size -= (size_t)(colon + 1 - from);
        from = colon + 1;
    }
    snprintf(out, NAME_MAX_BYTES, "%.*s", (int)(size < NAME_MAX_BYTES ? size : NAME_MAX_BYTES - 1), from);
}

static void next_token(struct scanner *s, struct token *t) {
    static const char white[] = " \t\r\n/>";
    for (;;) {
        *t = (struct token){.text = s->data + s->at};
        if (s->at >= s->size)
            return;
        if (s->data[s->at] != '<') {
            size_t end = find(s, s->at, "<");
            *t = (struct token){.kind = TOKEN_TEXT, .text = s->data + s->at, .size = end - s->at};
            advance(s, end);
            return;
        }
        if (begins(s, "<!--")) {
            advance(s, find(s, s->at + strlen("<!--"), "-->") + 3);
        } else if (begins(s, "<![CDATA[")) {
            size_t end = find(s, s->at, "]]>");
            t->kind = TOKEN_VERBATIM;
            t->text += strlen("<![CDATA[");
            t->size = end - s->at - strlen("<![CDATA[");
            advance(s, end + 3);
            return;
        } else if (begins(s, "<?")) {
            advance(s, find(s, s->at, "?>") + 2);
        } else if (begins(s, "<!")) {
            size_t end = tag_end(s, s->at);
            keep_entities(s, s->at, end);
            advance(s, end);
        } else {
            bool close = begins(s, "</");
            size_t end = tag_end(s, s->at), name = s->at + 1 + close, length = 0;
            while (name + length < end && !strchr(white, s->data[name + length]))
                length++;
            copy_name(s->data + name, length, t->name);
            t->kind = close ? TOKEN_CLOSE : TOKEN_START;
            t->text = s->data + name + length;
            t->size = end > name + length ? end - 1 - (name + length) : 0;
            t->empty = t->size && t->text[t->size - 1] == '/';
            advance(s, end);
            return;
        }
    }
}

/* Copies the value of an attribute with that local name. False: it has none. */
static bool attribute(const struct token *t, const char *name, char *out, size_t room) {
    const char *at = t->text, *end = t->text + t->size;
    size_t length = strlen(name);
    *out = '\0';
    while (at < end) {
        const char *equals = memchr(at, '=', (size_t)(end - at));
        const char *quote = equals ? equals + 1 : end;
        while (quote < end && strchr(" \t\r\n", *quote))
            quote++;
        const char *close = quote < end && (*quote == '"' || *quote == '\'')
                                ? memchr(quote + 1, *quote, (size_t)(end - quote - 1))
                                : NULL;
        if (!close)
            return false;
        const char *tail = equals;
        while (tail > at && strchr(" \t\r\n", tail[-1]))
            tail--;
        if ((size_t)(tail - at) >= length && !memcmp(tail - length, name, length) &&
            (tail - length == at || strchr(" \t\r\n:", tail[-1 - (long)length]))) {
            snprintf(out, room, "%.*s", (int)(close - quote - 1), quote + 1);
            return true;
        }
        at = close + 1;
    }
    return false;
}

static bool attribute_is(const struct token *t, const char *name, const char *values) {
    char value[80];
    return attribute(t, name, value, sizeof value) && *value && strlen(value) < 40 &&
           strstr(values, value) != NULL;
}

/* True when a word of the attribute, without its prefix, is in the list " one two ". */
static bool has_token(const struct token *t, const char *name, const char *list) {
    char value[400], one[80];
    if (!attribute(t, name, value, sizeof value))
        return false;
    for (const char *at = value; *(at += strspn(at, " \t\r\n"));) {
        size_t size = strcspn(at, " \t\r\n");
        const char *colon = memchr(at, ':', size), *own = colon ? colon + 1 : at;
        snprintf(one, sizeof one, " %.*s ", (int)(at + size - own > 70 ? 70 : at + size - own), own);
        if (strstr(list, one))
            return true;
        at += size;
    }
    return false;
}

static bool is_in(const char *list, const char *name) {
    char one[NAME_MAX_BYTES + 2];
    snprintf(one, sizeof one, " %s ", name);
    return strstr(list, one) != NULL;
}

/* Adds the text with its character and entity references replaced. */
static void add_text(struct collector *c, const struct scanner *s, const char *text, size_t size) {
    for (size_t at = 0; at < size;) {
        const char *sign = memchr(text + at, '&', size - at);
        size_t plain = sign ? (size_t)(sign - text) : size;
        collector_add(c, text + at, plain - at);
        const char *end = sign ? memchr(sign, ';', size - plain) : NULL;
        char name[NAME_MAX_BYTES], found[ENTITY_BYTES_MAX];
        at = plain;
        if (!end || end - sign >= NAME_MAX_BYTES) {
            if (sign)
                collector_character(c, '&');
            at += sign != NULL;
            continue;
        }
        snprintf(name, sizeof name, "%.*s", (int)(end - sign - 1), sign + 1);
        at = (size_t)(end - text) + 1;
        if (name[0] == '#') {
            bool hex = name[1] == 'x' || name[1] == 'X';
            unsigned long cp = strtoul(name + 1 + hex, NULL, hex ? 16 : 10);
            collector_character(c, cp && cp < 0x110000 ? (uint32_t)cp : ' ');
            continue;
        }
        const char *own = (const char *)s->entities.data, *stop = own + s->entities.size;
        while (own && own < stop && strcmp(own, name) != 0) {
            own += strlen(own) + 1;
            own += strlen(own) + 1;
        }
        if (own && own < stop) {
            own += strlen(own) + 1;
            struct scanner none = {0};
            add_text(c, &none, own, strlen(own));
        } else {
            size_t length = xml_entity(name, found);
            collector_add(c, length ? found : " ", length ? length : 1);
        }
    }
}

void collector_references(struct collector *c, const char *text, size_t size) {
    const struct scanner none = {0};
    add_text(c, &none, text, size);
}

struct alternatives {
    unsigned depth, chosen, child;
};

struct reading {
    struct collector c;
    struct scanner s;
    unsigned depth, skip_from; /* skip_from: depth of the skipped element; 0: none */
    struct alternatives choices[CHOICES_MAX];
    unsigned choice_count;
    unsigned texts, expansions, drawings, raised, restored; /* open elements */
    bool word_joins;                                        /* the last w or pc joins what follows */
    size_t left_out;                                        /* words in skipped elements */
    struct word_list hidden;                                /* those words */
};

/* Chooses the child to read of an element with alternatives, by looking ahead. */
static unsigned best_child(const struct scanner *at) {
    static const char better[] = " corr reg expan ex lem ", worse[] = " sic orig abbr am ",
                      never[] = " note witDetail wit del ";
    struct scanner s = *at;
    struct token t;
    unsigned depth = 0, child = 0, chosen = 0;
    int best = -1;
    for (next_token(&s, &t); t.kind != TOKEN_END; next_token(&s, &t)) {
        if (t.kind == TOKEN_CLOSE && !depth--)
            break;
        if (t.kind != TOKEN_START)
            continue;
        if (!depth) {
            int rank = is_in(never, t.name) ? 0 : is_in(better, t.name) ? 30 : is_in(worse, t.name) ? 10 : 20;
            rank += rank && attribute_is(&t, "cert", "high")  ? 1
                    : rank && attribute_is(&t, "cert", "low") ? -1
                                                              : 0;
            if (rank > best) {
                best = rank;
                chosen = child;
            }
            child++;
        }
        depth += !t.empty;
    }
    return chosen;
}

/* True when the element's text is a note's sign: at most one letter and 12 bytes. */
static bool holds_sign(const struct scanner *at) {
    struct scanner s = *at;
    struct token t;
    unsigned depth = 0;
    size_t letters = 0, size = 0;
    for (next_token(&s, &t); t.kind != TOKEN_END; next_token(&s, &t)) {
        if (t.kind == TOKEN_CLOSE && !depth--)
            break;
        depth += t.kind == TOKEN_START && !t.empty;
        for (size_t i = 0, n; t.kind == TOKEN_TEXT && i < t.size; i += n ? n : 1) {
            uint32_t cp = ' ';
            n = utf8_next(t.text + i, t.size - i, &cp);
            int category = utf8proc_category((utf8proc_int32_t)cp);
            letters += category >= UTF8PROC_CATEGORY_LU && category <= UTF8PROC_CATEGORY_LO;
            size += strchr(" \t\r\n", t.text[i]) ? 0 : n;
        }
    }
    return letters <= 1 && size <= 12;
}

/* Makes the words of a link that is a note's sign optional. */
static void begin_sign(struct reading *r) {
    if (!holds_sign(&r->s))
        return;
    collector_end_word(&r->c);
    r->c.optional = true;
}

/* True when what stands at that depth is an alternative, or white space between alternatives. */
static bool is_of_alternatives(const struct reading *r, unsigned depth, bool *chosen) {
    const struct alternatives *a = r->choice_count ? &r->choices[r->choice_count - 1] : NULL;
    if (!a || a->depth + 1 != depth)
        return false;
    *chosen = a->child == a->chosen;
    return true;
}

/* Elements within which a word continues. */
static const char tei_inline[] =
    " tagStart tagEnd abbr sic orig corr reg ex expan am choice app lem rdg rdgGrp hi emph foreign c m seg s "
    "phr cl g "
    "supplied "
    "unclear add del damage surplus subst restore retrace ref ptr anchor name persName placeName rs orgName "
    "geogName forename surname roleName addName nameLink genName term gloss title date time num measure "
    "mentioned "
    "soCalled distinct q quote said cit note secl handShift pc w index pb cb gb lb fw milestone metamark gap "
    "space "
    "caesura rhyme met author ident code gi att tag val idno country settlement region formula "
    "undo mod "
    "substJoin addSpan delSpan damageSpan graphic figDesc witDetail wit link alt join interp span objectName "
    "mentioned "
    "eventName district bloc geogFeat unit redo listAnnotation "
    "annotation ";
static const char tei_skipped[] = " teiHeader standOff facsimile sourceDoc del fw metamark figDesc graphic "
                                  "media binaryObject witDetail wit "
                                  "interp interpGrp span spanGrp index ";

static void tei_start(struct reading *r, const struct token *t) {
    struct collector *c = &r->c;
    const char *name = t->name;
    char target[80];
    bool chosen, no = attribute_is(t, "break", "no");
    if (is_of_alternatives(r, r->depth, &chosen)) {
        r->choices[r->choice_count - 1].child++;
        if (!chosen)
            r->skip_from = r->depth;
    }
    if (!strcmp(name, "text"))
        r->texts++;
    if ((is_in(tei_skipped, name) && (strcmp(name, "del") != 0 || !r->restored)) ||
        (!strcmp(name, "am") && r->expansions))
        r->skip_from = r->skip_from ? r->skip_from : r->depth;
    if (r->skip_from)
        return;
    if (is_in(" choice app rdgGrp ", name) && r->choice_count < CHOICES_MAX)
        r->choices[r->choice_count++] = (struct alternatives){r->depth, best_child(&r->s), 0};
    if (!strcmp(name, "expan"))
        r->expansions++;
    r->restored += !strcmp(name, "restore");
    if (!strcmp(name, "note"))
        collector_inset(c);
    else if (!strcmp(name, "lb") || (is_in(" cb gb pb ", name) && no))
        collector_break(c, no);
    else if (is_in(" milestone space caesura gap ", name) && no)
        collector_break(c, true);
    else if (is_in(" milestone space caesura gap tagStart ", name) ||
             (!strcmp(name, "tagEnd") && !attribute_is(t, "gi", "name")))
        collector_end_word(c);
    else if (!strcmp(name, "w") && !r->word_joins && !attribute_is(t, "join", "left both") &&
             !attribute_is(t, "part", "M F"))
        collector_end_word(c);
    else if (!is_in(tei_inline, name))
        collector_end_word(c);
    if (is_in(" w pc ", name))
        r->word_joins = attribute_is(t, "join", "right both");
    if (!strcmp(name, "ref") && attribute(t, "target", target, sizeof target) && *target == '#')
        begin_sign(r);
}

static void tei_close(struct reading *r, const char *name) {
    if (!strcmp(name, "note"))
        collector_inset_end(&r->c);
    else if (!is_in(tei_inline, name))
        collector_end_word(&r->c);
    if (!strcmp(name, "ref") && r->c.optional) {
        collector_end_word(&r->c);
        r->c.optional = false;
    }
    r->expansions -= !strcmp(name, "expan") && r->expansions;
    r->restored -= !strcmp(name, "restore") && r->restored;
}

static const char html_inline[] = " a abbr acronym b bdi bdo big cite code data del dfn em font i ins kbd "
                                  "label mark q ruby rb rt rp rtc s samp "
                                  "small span strike strong sub sup time tt u var wbr script style ";
static const char html_skipped[] = " head script style nav audio video iframe button input rt rp rtc "
                                   "template datalist annotation annotation-xml "
                                   "metadata select textarea ";

static bool is_shut_out(const struct token *t) {
    char value[400];
    if (attribute_is(t, "aria-hidden", "true"))
        return true;
    if (attribute(t, "style", value, sizeof value)) {
        char plain[sizeof value + 1] = ";";
        size_t size = 1;
        for (const char *c = value; *c; c++)
            if (!strchr(" \t\r\n", *c))
                plain[size++] = *c;
        plain[size] = '\0';
        if (strstr(plain, ";display:none") || strstr(plain, ";visibility:hidden"))
            return true;
    }
    return attribute(t, "hidden", value, sizeof value);
}

/* True when a link may lead to a note: it is raised, or in brackets, or its target is called so. */
static bool may_be_note(const struct reading *r, const char *target) {
    static const char *const names[] = {"#note", "#fn", "#ftn", "#endn", "#footn"};
    const char *text = r->s.data + r->s.at;
    bool raised = r->raised || (r->s.size - r->s.at > 4 && !memcmp(text, "<sup", 4));
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        raised = raised || strcasestr(target, names[i]);
    return raised || (r->s.at < r->s.size && strchr("[*^", *text)) ||
           (r->s.size - r->s.at > 1 && (unsigned char)*text == 0xE2); /* daggers and arrows */
}

static void html_start(struct reading *r, const struct token *t) {
    struct collector *c = &r->c;
    const char *name = t->name;
    char value[2000];
    r->texts += !strcmp(name, "body") || (!strcmp(name, "svg") && r->depth == 1);
    bool sign = has_token(t, "type", " noteref backlink referrer pagebreak ") ||
                has_token(t, "role", " doc-noteref doc-backlink doc-pagebreak ");
    bool alternative = !strcmp(name, "img") || !strcmp(name, "math");
    r->drawings += !strcmp(name, "svg") && !t->empty;
    bool described = r->drawings && is_in(" title desc defs ", name);
    if (is_in(html_skipped, name) || is_shut_out(t) || sign || described)
        r->skip_from = r->skip_from ? r->skip_from : r->depth;
    if (r->skip_from)
        return;
    if (alternative && (attribute(t, strcmp(name, "img") ? "alttext" : "alt", value, sizeof value) ||
                        attribute(t, "aria-label", value, sizeof value))) {
        collector_end_word(c);
        add_text(c, &r->s, value, strlen(value));
        collector_end_word(c);
        r->skip_from = r->depth;
        return;
    }
    if (!is_in(html_inline, name))
        collector_end_word(c);
    r->raised += !strcmp(name, "sup") && !t->empty;
    if (!strcmp(name, "a") && attribute(t, "href", value, sizeof value) && may_be_note(r, value))
        begin_sign(r);
}

static void html_close(struct reading *r, const char *name) {
    r->drawings -= r->drawings && !strcmp(name, "svg");
    r->raised -= r->raised && !strcmp(name, "sup");
    if (!is_in(html_inline, name))
        collector_end_word(&r->c);
    if (!strcmp(name, "a") && r->c.optional) {
        collector_end_word(&r->c);
        r->c.optional = false;
    }
}

static void close_element(struct reading *r, const char *name, bool html) {
    if (r->skip_from == r->depth)
        r->skip_from = 0;
    else if (!r->skip_from && html)
        html_close(r, name);
    else if (!r->skip_from)
        tei_close(r, name);
    if (r->choice_count && r->choices[r->choice_count - 1].depth == r->depth)
        r->choice_count--;
    r->depth -= r->depth > 0;
}

static void read_elements(struct reading *r, bool html) {
    struct token t;
    uint32_t line = r->s.line;
    for (next_token(&r->s, &t); t.kind != TOKEN_END; line = r->s.line, next_token(&r->s, &t)) {
        bool chosen, between = is_of_alternatives(r, r->depth + 1, &chosen);
        if (t.kind == TOKEN_START) {
            r->depth++;
            r->c.line = line;
            if (html)
                html_start(r, &t);
            else
                tei_start(r, &t);
            if (t.empty)
                close_element(r, t.name, html);
        } else if (t.kind == TOKEN_CLOSE) {
            r->c.line = line;
            close_element(r, t.name, html);
        } else if (r->texts && r->skip_from) {
            struct collector aside = {.vocabulary = r->c.vocabulary, .words = &r->hidden};
            add_text(&aside, &r->s, t.text, t.size);
            collector_end_word(&aside);
        } else if (r->texts && !between) {
            r->c.line = line;
            if (t.kind == TOKEN_TEXT)
                add_text(&r->c, &r->s, t.text, t.size);
            else
                collector_add(&r->c, t.text, t.size);
        }
    }
    while (r->c.depth)
        collector_inset_end(&r->c);
    collector_end_word(&r->c);
}

static void begin_reading(struct reading *r, const char *data, size_t size) {
    free(r->hidden.list);
    buf_free(&r->s.entities);
    struct collector c = {.vocabulary = r->c.vocabulary, .words = r->c.words, .document = r->c.document};
    size_t left_out = r->left_out;
    *r = (struct reading){.c = c, .s = {.data = data, .size = size, .line = 1}, .left_out = left_out};
}

static void end_reading(struct reading *r) {
    r->left_out += r->hidden.count;
    free(r->hidden.list);
    buf_free(&r->s.entities);
    r->hidden = (struct word_list){0};
}

/* ---- EPUB ---- */

static bool unpack(struct zip *zip, const char *path, struct buf *out) {
    struct zip_file *file = zip_fopen(zip, path, 0);
    zip_int64_t got = 1;
    while (file && got > 0 && out->size <= WORK_FILE_BYTES_MAX) {
        got = zip_fread(file, buf_reserve(out, 65536), 65536);
        out->size += got > 0 ? (size_t)got : 0;
    }
    if (file)
        zip_fclose(file);
    buf_reserve(out, 1);
    return file && !got;
}

/* Finds the element with that name whose attribute has that value (NULL: any), and copies another attribute.
 */
static bool find_element(const struct buf *xml, const char *name, const char *key, const char *value,
                         const char *wanted, char *out, size_t room) {
    struct scanner s = {.data = (const char *)xml->data, .size = xml->size};
    struct token t;
    char found[1024];
    bool there = false;
    for (next_token(&s, &t); t.kind != TOKEN_END && !there; next_token(&s, &t))
        there = t.kind == TOKEN_START && !strcmp(t.name, name) &&
                (!key || (attribute(&t, key, found, sizeof found) && !strcmp(found, value))) &&
                attribute(&t, wanted, out, room);
    buf_free(&s.entities);
    return there;
}

/* Path of a reference in the package: %XX decoded, ".." resolved. */
static void join_path(const char *package, const char *href, char *out, size_t room) {
    char plain[1024];
    size_t length = 0;
    for (; *href && *href != '#' && length + 1 < sizeof plain; href++) {
        unsigned code;
        if (*href == '%' && sscanf(href + 1, "%2x", &code) == 1) {
            plain[length++] = (char)code;
            href += 2;
        } else if (!strncmp(href, "&amp;", 5)) {
            plain[length++] = '&';
            href += 4;
        } else {
            plain[length++] = *href;
        }
    }
    plain[length] = '\0';
    const char *slash = strrchr(package, '/'), *rest = plain;
    int folder = slash ? (int)(slash - package) : 0;
    for (; !strncmp(rest, "../", 3) || !strncmp(rest, "./", 2); rest += rest[1] == '.' ? 3 : 2)
        while (rest[1] == '.' && folder > 0 && package[--folder] != '/')
            ;
    snprintf(out, room, "%.*s%s%s", folder, package, folder ? "/" : "", rest);
}

static int read_epub(struct reading *r, int fd, char ***documents, size_t *document_count) {
    int own = dup(fd), why = 0;
    struct zip *zip = own >= 0 ? zip_fdopen(own, 0, &why) : NULL;
    struct buf xml = {0}, package = {0};
    char opf[1024], id[1024], href[1024], path[2100];
    size_t cap = 0;
    if (!zip) {
        if (own >= 0)
            close(own);
        return -1;
    }
    bool well = unpack(zip, "META-INF/container.xml", &xml) &&
                find_element(&xml, "rootfile", NULL, NULL, "full-path", opf, sizeof opf) &&
                unpack(zip, opf, &package);
    buf_free(&xml);
    struct scanner s = {.data = (const char *)package.data, .size = package.size};
    struct token t = {0};
    if (well)
        next_token(&s, &t);
    for (; well && t.kind != TOKEN_END; next_token(&s, &t)) {
        struct buf text = {0};
        bool again = false;
        if (t.kind != TOKEN_START || strcmp(t.name, "itemref") != 0 ||
            !attribute(&t, "idref", id, sizeof id) ||
            !find_element(&package, "item", "id", id, "href", href, sizeof href))
            continue;
        join_path(opf, href, path, sizeof path);
        for (size_t i = 0; i < *document_count; i++)
            again = again || !strcmp((*documents)[i], path);
        if (again || !unpack(zip, path, &text)) {
            buf_free(&text);
            continue;
        }
        *documents = mem_grow(*documents, &cap, *document_count + 1, sizeof **documents);
        (*documents)[(*document_count)++] = mem_strdup(path);
        begin_reading(r, (const char *)text.data, text.size);
        r->c.document = (uint16_t)*document_count;
        read_elements(r, true);
        end_reading(r);
        buf_free(&text);
    }
    buf_free(&s.entities);
    buf_free(&package);
    zip_discard(zip);
    return well ? 0 : -1;
}

/* ---- Markdown and plain text ---- */

static size_t line_size(const char *text, size_t size) {
    const char *newline = memchr(text, '\n', size);
    return newline ? (size_t)(newline - text) + 1 : size;
}

/* Size of "---" lines around metadata at the beginning; 0: none. */
static size_t front_matter(const char *text, size_t size) {
    size_t at = line_size(text, size), end = 0;
    if (size < 4 || memcmp(text, "---", 3) != 0 || !strchr("\r\n", text[3]))
        return 0;
    for (unsigned line = 1; at < size && line < 50 && !end; line++) {
        size_t length = line_size(text + at, size - at);
        if (length >= 3 && !memcmp(text + at, "---", 3) && (length == 3 || strchr("\r\n", text[at + 3])))
            end = at + length;
        at += length;
    }
    return end;
}

static bool ends_with(const char *path, const char *endings) {
    const char *dot = strrchr(path, '.');
    return dot && strlen(dot) < NAME_MAX_BYTES - 2 && is_in(endings, dot);
}

int words_source_read(struct collector *c, const char *path, FILE *file, const struct buf *data,
                      size_t *left_out) {
    struct reading r = {.c = *c};
    char **documents = NULL;
    size_t document_count = 0;
    int result = 0;
    if (ends_with(path, " .epub ")) {
        result = read_epub(&r, fileno(file), &documents, &document_count);
    } else {
        size_t skip =
            ends_with(path, " .md .markdown .txt ") ? front_matter((const char *)data->data, data->size) : 0;
        begin_reading(&r, (const char *)data->data + skip, data->size - skip);
        for (size_t i = 0; i < skip; i++)
            r.s.line += data->data[i] == '\n';
        r.c.line = r.s.line;
        if (ends_with(path, " .md .markdown "))
            words_markdown_read(&r.c, r.s.data, r.s.size);
        else if (ends_with(path, " .txt "))
            collector_add(&r.c, r.s.data, r.s.size);
        else
            read_elements(&r, false);
        collector_end_word(&r.c);
        end_reading(&r);
    }
    *left_out = r.left_out;
    for (size_t i = 0; i < document_count; i++)
        free(documents[i]);
    free(documents);
    return result;
}
