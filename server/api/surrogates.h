/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Halves of characters in JSON: a program that cuts a text at UTF-16 units may send "\\ud83d" in one message
 * and
 * "\\ude00" in the next. Jansson refuses a message with a half; here it is kept until its other half comes.
 */
#ifndef FACCIA_API_SURROGATES_H
#define FACCIA_API_SURROGATES_H

#include "server/base/buf.h"
#include "server/base/work_limit.h"
#include <jansson.h>
#include <stddef.h>
#include <stdint.h>

/* As json_loadb (NULs allowed). In the strings a half stands as four
 * noncharacters, which surrogates_join takes for what they are. */
json_t *surrogates_load(const char *data, size_t size, json_error_t *why);
/* The same; NULL soon after the limit is over. */
json_t *surrogates_load_until(const char *data, size_t size, struct work_limit *limit, json_error_t *why);

/* Copies text[0..n), with its halves joined, to `out`. *half is the high half at the end of what came before,
 * 0: none; afterwards the one at the end of this. What has no other half becomes U+FFFD. */
void surrogates_join(const char *text, size_t n, uint16_t *half, struct buf *out);

#endif
