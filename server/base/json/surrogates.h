/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Lone surrogates in JSON. A program that splits a text at UTF-16 units may send "\\ud83d" in one message
 * and "\\ude00" in the next. Jansson rejects such messages, so the half is kept here until the other one
 * arrives. */
#ifndef FACCIA_BASE_JSON_SURROGATES_H
#define FACCIA_BASE_JSON_SURROGATES_H

#include "server/base/buf.h"
#include "server/base/work/work_limit.h"
#include <jansson.h>
#include <stddef.h>
#include <stdint.h>

/* As json_loadb with NULs allowed. A lone surrogate becomes four noncharacters in the string, which
 * surrogates_join decodes. */
json_t *surrogates_load(const char *data, size_t size, json_error_t *why);
/* The same; returns NULL soon after the limit is exceeded. */
json_t *surrogates_load_until(const char *data, size_t size, struct work_limit *limit, json_error_t *why);

/* Appends text[0..n) to `out`, joining surrogate pairs. *half carries a high surrogate at the end of one text
 * to the next text (0: none). Unpaired surrogates become U+FFFD. */
void surrogates_join(const char *text, size_t n, uint16_t *half, struct buf *out);

#endif
