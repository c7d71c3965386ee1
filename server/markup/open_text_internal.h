/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Shared by open_text.c and open_xml.c. */
#ifndef FACCIA_MARKUP_OPEN_TEXT_INTERNAL_H
#define FACCIA_MARKUP_OPEN_TEXT_INTERNAL_H

#include "server/markup/open_text.h"

/* Like open_text_next and open_text_seems_ended, for text with tags. */
int open_xml_next(struct open_text *o, const char *text, size_t size, enum open_end end,
                  const struct markup_rules *rules, struct open_piece *piece, struct error *e);
bool open_xml_seems_ended(const struct open_text *o, const char *text, size_t size,
                          const struct markup_rules *rules);

#endif
