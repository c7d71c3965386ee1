/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finds which of the answers on offer a listener has said: the answer itself, its place ("the second one"),
 * or yes and no in other words; and whether they ask to
 * have something said again. Case, accents and punctuation do not matter. The words of each language are
 * data (models/answers.json). */
#ifndef FACCIA_LIVE_ANSWERS_H
#define FACCIA_LIVE_ANSWERS_H

#include "server/base/error.h"
#include <jansson.h>
#include <stdbool.h>

struct answers;

/* Returns NULL with *e ("bad-normalization"). */
struct answers *answers_load(const char *path, struct error *e);
void answers_free(struct answers *answers); /* NULL is ignored */

/* Returns the index of the only choice that the words may mean, or -1. choices: a list of strings. In a
 * language without words, and with answers NULL, only the choices themselves are known. */
int answers_choose(const struct answers *answers, const char *lang, const json_t *choices, const char *said);

/* Returns whether the words only ask to have something said again: "come?", "say that again, please". */
bool answers_asks_again(const struct answers *answers, const char *lang, const char *said);

#endif
