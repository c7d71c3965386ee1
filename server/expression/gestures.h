/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Named gestures: stretches of face movement in files of their own, models/gestures/NAME.json and those of a
 * folder of the operator's. The file's format is described in models/gestures/README.md. They are expressions
 * of the kind "gesture". */
#ifndef FACCIA_EXPRESSION_GESTURES_H
#define FACCIA_EXPRESSION_GESTURES_H

#include "server/expression/expressions.h"

/* Adds one from its file; it takes the place of one that has its name. -1 with *e (field = JSON path); then
 * nothing has changed. Not while anybody shows expressions. */
int gesture_load(struct expressions *expressions, const char *path, struct error *e);

/* Is it the content of such a file, with that name? -1 with *e as above. In any thread. */
int gesture_check(const char *name, const void *data, size_t size, struct error *e);

/* Adds all *.json of a folder, in the order of their names; a folder that is not there has none. -1 with *e,
 * whose message begins with the file. */
int gestures_load(struct expressions *expressions, const char *folder, struct error *e);

#endif
