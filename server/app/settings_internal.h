/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Inside of the settings: the table, and one setting in and out of text and JSON. */
#ifndef FACCIA_APP_SETTINGS_INTERNAL_H
#define FACCIA_APP_SETTINGS_INTERNAL_H

#include "server/app/settings.h"
#include <jansson.h>

enum { SETTINGS_MAX = 96 };

struct setting {
    const char *path;   /* in the file: "limits.text_bytes" */
    const char *option; /* "max-text" */
    enum {
        SETTING_STRING,
        SETTING_FOLDER, /* one that is there */
        SETTING_NUMBER, /* whole */
        SETTING_REAL,
        SETTING_MEGABYTES, /* whole; kept as bytes, in a uint64_t */
        SETTING_FLAG,
        SETTING_LIST,   /* of strings; the option may be repeated, the variable has commas */
        SETTING_OBJECT, /* JSON, kept as text; as an option or variable: the name of a file */
        SETTING_CHOICE, /* one of the words of shape, with | between, kept as its index */
    } type;
    size_t offset;                         /* in struct settings */
    enum { FOR_DAEMON, FOR_BOTH } program; /* that has it: facciad, or faccia, too */
    double min, max;
    const char *value; /* default, as text; NULL = none */
    const char *shape; /* "N", "FILE": for the help */
    const char *help;
};

extern const struct setting settings_table[];
extern const size_t settings_count;

/* Does the setting concern the program? */
bool setting_is_of(enum program program, const struct setting *setting);

/* Is its value the tag of a language (base/lang.h)? */
bool setting_is_tag(const struct setting *setting);

/* The daemon's --token-file, as it was called once: -1 with *e, which says what it is called now. name: as
 * the setting was written. */
int setting_was_renamed(const char *name, struct error *e);

/* -1 with *e, whose field is name. */
int setting_from_text(struct settings *s, const struct setting *setting, const char *text, const char *name,
                      struct error *e);
int settings_from_file(struct settings *s, enum program program, const char *file, struct error *e);

/* Puts it where its path says. */
void setting_to_json(const struct settings *s, const struct setting *setting, json_t *root);
void setting_clear(struct settings *s, const struct setting *setting);

#endif
