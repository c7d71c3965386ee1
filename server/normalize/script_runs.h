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

/* Finds the first such run that begins at or after `at`. Words of one script and what stands between them
 * are one run; Chinese characters and kana are one script. Not found: Latin letters, which voices of all
 * languages read; a single Greek letter, which is a sign; anything in a language whose script is unknown
 * (BCP 47). text: well-formed UTF-8. */
bool script_run_next(const char *text, size_t size, const char *lang, size_t at, struct script_run *run);

/* The language that is most likely written in a script, and the script's English name. */
enum { SCRIPT_LANG_BYTES = 16 };
void script_run_lang(int script, char lang[SCRIPT_LANG_BYTES]);
const char *script_run_name(int script);

#endif
