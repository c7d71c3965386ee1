/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/mem.h"
#include "server/library/tei_internal.h"
#include <stdlib.h>
#include <string.h>

enum { FIELD_BYTES_MAX = 4096 };

static void count_header(struct tei *t, const char *name, int by) {
    unsigned *counts[] = {&t->title_stmt, &t->publication, &t->source};
    static const char *const names[] = {"titleStmt", "publicationStmt", "sourceDesc"};
    for (size_t i = 0; i < 3; i++)
        if (!strcmp(name, names[i]))
            *counts[i] += (unsigned)by;
}

/* The number of an authority file is no part of a name, nor is what is said about it. */
static bool is_left_out(const char *name) {
    static const char *const names[] = {"idno", "note", "ptr", NULL};
    return xml_is_one(name, names);
}

static bool is_name(const char *name) {
    static const char *const names[] = {"persName", "name", "orgName", NULL};
    return xml_is_one(name, names);
}

/* The date of the edition that was transcribed counts, and that of the file only where there is none. */
static char **date_of(struct tei *t, const char **attributes) {
    static const char *const when[] = {"when", "from", "notBefore", NULL};
    char **to = t->source ? &t->meta->date : t->publication ? &t->first_date : NULL;
    for (const char *const *name = when; to && !*to && *name; name++) {
        const char *value = xml_attribute(attributes, *name);
        if (value && strlen(value) < 40)
            work_meta_set(to, value);
    }
    return to && !*to ? to : NULL;
}

void tei_header_start(struct tei *t, const struct xml_walk *w, const char *name, const char **attributes) {
    struct work_meta *m = t->meta;
    char **wanted = NULL;
    bool again = false;
    count_header(t, name, 1);
    if (t->wanted) {
        if (!strcmp(name, "date"))
            date_of(t, attributes);
        if (is_left_out(name) || (t->wanted == &m->author && is_name(name) && t->names++ > 0) || t->left_out)
            t->left_out++;
        else if (t->capture.size && t->wanted == &m->author)
            buf_add(&t->capture, " ", 1); /* between the parts of a name */
        return;
    }
    if (t->title_stmt && !strcmp(name, "title"))
        wanted = &m->title;
    else if (t->title_stmt && !strcmp(name, "author"))
        wanted = &m->author, again = true;
    else if (t->publication && !strcmp(name, "publisher"))
        wanted = &m->publisher;
    else if (!strcmp(name, "date"))
        wanted = date_of(t, attributes);
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

void tei_header_text(struct tei *t, const char *text, size_t size) {
    if (t->wanted && !t->left_out && t->capture.size + size < FIELD_BYTES_MAX)
        buf_add(&t->capture, text, size);
}

/* Authors are named one after the other. */
static void keep(struct tei *t, const char *text) {
    if (t->wanted == &t->meta->author && t->meta->author && *text) {
        struct buf both = {0};
        if (strlen(t->meta->author) + strlen(text) < FIELD_BYTES_MAX) {
            buf_printf(&both, "%s; %s", t->meta->author, text);
            buf_add(&both, "", 1);
            free(t->meta->author);
            t->meta->author = (char *)both.data;
        }
    } else {
        work_meta_set(t->wanted, text);
    }
}

void tei_header_end(struct tei *t, const struct xml_walk *w, const char *name) {
    count_header(t, name, -1);
    if (!t->wanted)
        return;
    if (t->capture_at != w->depth) {
        t->left_out -= t->left_out > 0;
        return;
    }
    char *text = mem_strndup(t->capture.size ? (char *)t->capture.data : "", t->capture.size);
    char *to = text;
    for (const char *c = text; *c; c++)
        if (!strchr(" \t\r\n", *c))
            *to++ = *c;
        else if (to > text && to[-1] != ' ')
            *to++ = ' ';
    *to = '\0';
    if (to > text && to[-1] == ' ')
        to[-1] = '\0';
    keep(t, text);
    free(text);
    buf_free(&t->capture);
    t->wanted = NULL;
}
