/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Parses an uploaded form (RFC 7578). */
#ifndef FACCIA_HTTP_MULTIPART_H
#define FACCIA_HTTP_MULTIPART_H

#include "server/base/error.h"
#include <stdint.h>

/* Finds the form's part of that name and borrows it in *part. Returns 1 if found and 0 if not; -1 with *e
 * ("bad-form") if the body is not a form of that Content-Type. */
int form_part(const char *content_type, const void *body, size_t size, const char *name, const uint8_t **part,
              size_t *part_size, struct error *e);

#endif
