/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The page of a listening test: a template with its data, and the client that draws the face, put into it. */
#ifndef FACCIA_APP_STIMULI_PAGE_H
#define FACCIA_APP_STIMULI_PAGE_H

#include "server/base/buf.h"
#include <stddef.h>

/* Appends the template with {{data}} and {{bundle}} replaced; neither can end the script element that it lies
 * in. */
void stimuli_page(const struct buf *template, const struct buf *data, const struct buf *bundle,
                  struct buf *out);

#endif
