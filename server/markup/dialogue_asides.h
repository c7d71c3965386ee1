/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The narrator's words inside a speech that a dash begins, between commas: "— Vieni, disse Anna, è tardi." */
#ifndef FACCIA_MARKUP_DIALOGUE_ASIDES_H
#define FACCIA_MARKUP_DIALOGUE_ASIDES_H

#include <stdbool.h>
#include <stddef.h>

/* Finds the first such words in text[from..to): *begins is after the mark before them, *ends after the mark
 * that ends them. lang: BCP 47; NULL, or one without a table of verbs: none are found. */
bool dialogue_aside(const char *text, size_t from, size_t to, const char *lang, size_t *begins, size_t *ends);

#endif
