/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/mem.h"
#include "server/library/tei_internal.h"
#include <stdlib.h>
#include <string.h>

static void count_header(struct tei *t, const char *name, int by) {
    unsigned *counts[] = {&t->title_stmt, &t->publication, &t->source};
    static const char *const names[] = {"titleStmt", "publicationStmt", "sourceDesc"};
    for (size_t i = 0; i < 3; i++)
        if (!strcmp(name, names[i]))
            *counts[i] += (unsigned)by;
}

void tei_header_start(struct tei *t, const struct xml_walk *w, const char *name, const char **attributes) {
    struct work_meta *m = t->meta;
    char **wanted = NULL;
    count_header(t, name, 1);
    if (t->title_stmt && !strcmp(name, "title"))
        wanted = &m->title;
    else if (t->title_stmt && !strcmp(name, "author"))
        wanted = &m->author;
    else if (t->publication && !strcmp(name, "publisher"))
        wanted = &m->publisher;
    else if (t->publication && !strcmp(name, "date"))
        wanted = &m->date;
    else if (t->publication && !strcmp(name, "licence"))
        wanted = &m->licence;
    else if (t->source && (!strcmp(name, "bibl") || !strcmp(name, "p")))
        wanted = &m->source;
    if (wanted && !*wanted && !t->wanted) {
        t->wanted = wanted;
        t->capture_at = w->depth;
    }
    const char *target = wanted == &m->licence ? xml_attribute(attributes, "target") : NULL;
    if (target && t->wanted == wanted)
        buf_printf(&t->capture, "%s ", target);
}

void tei_header_end(struct tei *t, const struct xml_walk *w, const char *name) {
    count_header(t, name, -1);
    if (!t->wanted || t->capture_at != w->depth)
        return;
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
    work_meta_set(t->wanted, text);
    free(text);
    buf_free(&t->capture);
    t->wanted = NULL;
}
