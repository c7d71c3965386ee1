/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the files of the TEI reader share. */
#ifndef FACCIA_LIBRARY_TEI_INTERNAL_H
#define FACCIA_LIBRARY_TEI_INTERNAL_H

#include "server/library/readers.h"
#include "server/library/xml_walk.h"

enum tei_act {
    ACT_PASS, /* it is its content */
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
    ACT_BREAK,
    ACT_GAP,
};

struct tei_frame {
    enum tei_act act;
    bool opened; /* what it began is to be ended */
    char lang[36];
};

enum { UNKNOWN_MAX = 32 };

struct tei {
    struct tei_frame frames[WORK_DEPTH_MAX + 1];
    struct builder *b;
    struct work_meta *meta;
    struct buf capture;  /* of the header */
    char **wanted;       /* the meta that is being captured */
    unsigned capture_at; /* depth at which it began */
    unsigned skip, header, title_stmt, publication, source, bodies, divs; /* how many are open */
    char *unknown[UNKNOWN_MAX];
    size_t unknown_count;
    bool is_tei;
};

/* tei_elements.c */
enum tei_act tei_act_of(const char *name);

/* tei_header.c */
void tei_header_start(struct tei *tei, const struct xml_walk *walk, const char *name,
                      const char **attributes);
void tei_header_end(struct tei *tei, const struct xml_walk *walk, const char *name);

#endif
