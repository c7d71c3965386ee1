/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Addresses of the daemon's pages, for a screen that has no keyboard: with a token, and as a QR code. */
#ifndef FACCIA_ACCESS_PAGE_LINK_H
#define FACCIA_ACCESS_PAGE_LINK_H

#include "server/base/buf.h"
#include "server/base/error.h"
#include <stdio.h>

/* Appends the address of a page with the token in its query, where the page takes it from. Returns -1 with
 * *e: "bad-field" (the address does not begin with http:// or https:// and a host, or names a token). */
int page_link_write(const char *page, const char *token, struct buf *out, struct error *e);

/* Draws the text as a QR code, dark on light in any terminal, two modules to a character, with the margin
 * that readers need. Returns -1 if the text is too long for one (2953 bytes). */
int page_link_draw(const char *text, FILE *out);

#endif
