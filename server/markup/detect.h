/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads what precedes the root element of an XML document, to tell its kind. */
#ifndef FACCIA_MARKUP_DETECT_H
#define FACCIA_MARKUP_DETECT_H

#include "server/markup/markup_reader.h"

struct prolog {
    size_t end;       /* byte of the root element, or of the first byte that is not one */
    const char *root; /* name of the root element, not NUL-terminated; NULL: none */
    size_t root_bytes;
    bool declared;      /* has an XML declaration or a DOCTYPE, complete or not */
    size_t entities;    /* byte of the first entity declaration; 0 = none */
    size_t instruction; /* byte of the first processing instruction; 0 = none */
    char encoding[32];  /* from the XML declaration, lower case; "" = not stated */
    size_t encoding_at;
};

/* Skips the byte order mark, XML declaration, comments, processing instructions and DOCTYPE. Returns -1
 * with *e ("bad-xml", line and column) if one of them is unterminated. */
int prolog_read(const char *text, size_t size, struct prolog *prolog, struct error *e);

/* Checks that a document is UTF-8 without NUL. what: "text". -1 with *e: "bad-utf8", "nul" (byte). */
int text_check(const char *text, size_t size, const char *what, struct error *e);

/* Compares the root element's name, ignoring case and prefix. */
bool prolog_root_is(const struct prolog *prolog, const char *name);

#endif
