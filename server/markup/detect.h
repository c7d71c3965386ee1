/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What stands before the root element of an XML document, and what kind of document that makes it. */
#ifndef FACCIA_MARKUP_DETECT_H
#define FACCIA_MARKUP_DETECT_H

#include "server/markup/markup_reader.h"

struct prolog {
    size_t end;       /* byte where the root element begins, or what stands in its place */
    const char *root; /* its name, not ended; NULL when there is none */
    size_t root_bytes;
    bool declared;      /* there is an XML declaration or a DOCTYPE, complete or not */
    size_t entities;    /* byte of the first entity declaration; 0 = none */
    size_t instruction; /* byte of the first processing instruction; 0 = none */
    char encoding[32];  /* as the XML declaration states it, lower case; "" = not stated */
    size_t encoding_at;
};

/* Passes over byte order mark, XML declaration, comments, processing instructions and DOCTYPE. -1 with *e
 * ("bad-xml", with its line and column) when one of them does not end. */
int prolog_read(const char *text, size_t size, struct prolog *prolog, struct error *e);

/* Regardless of case and of a prefix. */
bool prolog_root_is(const struct prolog *prolog, const char *name);

#endif
