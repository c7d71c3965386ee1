/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Stretches of a text in a script that its language is not written in: Cyrillic in an Italian text. */
#ifndef FACCIA_NORMALIZE_SCRIPT_RUNS_H
#define FACCIA_NORMALIZE_SCRIPT_RUNS_H

#include <stdbool.h>
#include <stddef.h>

struct script_run {
    size_t from, to; /* bytes of the text */
    size_t letters;
    int script; /* a UScriptCode, below SCRIPT_RUN_SCRIPTS */
};
enum { SCRIPT_RUN_SCRIPTS = 512 };

/* Finds the first such run that begins at or after `at`. Consecutive words of one script are one run,
 * including what separates them; Chinese characters and kana count as one script. Skips Latin letters, which
 * voices of all languages read, and single Greek letters, which are signs; finds nothing in a language (BCP
 * 47) whose script is unknown. text: well-formed UTF-8. */
bool script_run_next(const char *text, size_t size, const char *lang, size_t at, struct script_run *run);

/* script_run_lang gets the most likely language of a script, script_run_name its English name. */
enum { SCRIPT_LANG_BYTES = 16 };
void script_run_lang(int script, char lang[SCRIPT_LANG_BYTES]);
const char *script_run_name(int script);

#endif
