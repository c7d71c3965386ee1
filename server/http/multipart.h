/* SPDX-License-Identifier: GPL-3.0-or-later */
/* An uploaded form (RFC 7578), taken apart. */
#ifndef FACCIA_HTTP_MULTIPART_H
#define FACCIA_HTTP_MULTIPART_H

#include "server/base/error.h"
#include <stdint.h>

/* The part of the form that has that name, in *part. 1: it is there; 0: it is not; -1 with *e ("bad-form")
 * when the body is no form of that Content-Type. */
int form_part(const char *content_type, const void *body, size_t size, const char *name, const uint8_t **part,
              size_t *part_size, struct error *e);

#endif
