/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Named gestures: face movements in files of their own, models/gestures/NAME.json and those in the
 * operator's folder. The format is described in models/gestures/README.md. They are expressions of kind
 * "gesture". */
#ifndef FACCIA_EXPRESSION_GESTURES_H
#define FACCIA_EXPRESSION_GESTURES_H

#include "server/expression/expressions.h"

/* Loads a gesture, replacing one of the same name. Returns -1 with *e (field = JSON path) without any
 * change. Call while no expression is shown. */
int gesture_load(struct expressions *expressions, const char *path, struct error *e);

/* Checks the content of a gesture file. Returns -1 with *e as above. Callable from any thread. */
int gesture_check(const char *name, const void *data, size_t size, struct error *e);

/* Loads all *.json of a folder in order of name; a missing folder counts as empty. Returns -1 with *e,
 * whose message begins with the file. */
int gestures_load(struct expressions *expressions, const char *folder, struct error *e);

#endif
