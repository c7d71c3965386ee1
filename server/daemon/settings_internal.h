/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The table of settings, and conversion of a setting from and to text and JSON. */
#ifndef FACCIA_DAEMON_SETTINGS_INTERNAL_H
#define FACCIA_DAEMON_SETTINGS_INTERNAL_H

#include "server/daemon/settings.h"
#include <jansson.h>

enum { SETTINGS_MAX = 96 };

struct setting {
    const char *path;   /* in the file: "limits.text_bytes" */
    const char *option; /* "max-text" */
    enum {
        SETTING_STRING,
        SETTING_FOLDER, /* an existing folder */
        SETTING_NUMBER, /* an integer */
        SETTING_REAL,
        SETTING_MEGABYTES, /* an integer; stored as bytes in a uint64_t */
        SETTING_FLAG,
        SETTING_LIST,   /* of strings; the option may be repeated, the variable is separated by commas */
        SETTING_OBJECT, /* JSON, stored as text; an option or variable names a file */
        SETTING_CHOICE, /* one of the words in shape, separated by |; stored as its index */
    } type;
    size_t offset;                         /* in struct settings */
    enum { FOR_DAEMON, FOR_BOTH } program; /* facciad only, or faccia, too */
    double min, max;
    const char *value; /* default, as text; NULL = none */
    const char *shape; /* for the help: "N", "FILE" */
    const char *help;
};

extern const struct setting settings_table[];
extern const size_t settings_count;

/* True when the value is a language tag (base/lang.h). */
bool setting_is_tag(const struct setting *setting);

/* -1 with *e, whose field is `name`. */
int setting_from_text(struct settings *s, const struct setting *setting, const char *text, const char *name,
                      struct error *e);
int settings_from_file(struct settings *s, enum program program, const char *file, struct error *e);

#endif
