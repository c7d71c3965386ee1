/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The times of phones as programs write them:
 *   "lab"      Festival, XWaves, MaryTTS: END COLOUR NAME a line, seconds, after an optional header that ends
 * in "#" "htk"      START END NAME a line, in units of 100 ns "textgrid" Praat, long or short text form: the
 * intervals of one tier "json"     {"phones": [{"ipa" or "name", "start", "end", "stress"}], "words":
 * [{"text", "start", "end"}]}, seconds */
#ifndef FACCIA_PLUGINS_COMMAND_TIMES_H
#define FACCIA_PLUGINS_COMMAND_TIMES_H

#include <jansson.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum cm_format { CM_LAB, CM_HTK, CM_TEXTGRID, CM_JSON };

/* How a program tells its times. */
struct cm_timing {
    bool given;
    enum cm_format format;
    const char *tier; /* TextGrid: the tier's name; NULL = the first with intervals */
    const json_t
        *argv; /* a second program that writes them to its standard output; NULL = in the file {times} */
    const json_t *names; /* the program's name -> IPA, "" = a pause; NULL = it writes IPA */
};

/* Reads the setting "times". -1 with the field in it that is wrong, and what is wrong. */
int cm_timing_read(struct cm_timing *timing, const json_t *setting, char *field, size_t field_cap, char *what,
                   size_t what_cap);

struct cm_phone {
    char name[32]; /* as written */
    char ipa[32];
    double start, end; /* seconds */
    uint32_t stress;
};

struct cm_word {
    char text[128];
    double start, end;
};

struct cm_times {
    struct cm_phone *phones;
    size_t phone_count, phone_cap;
    struct cm_word *words;
    size_t word_count, word_cap;
    char unnamed[32]; /* a name that the table does not have */
};

/* data ends with a zero beyond size. -1 with a sentence in message. */
int cm_times_parse(struct cm_times *times, const struct cm_timing *timing, char *data, size_t size,
                   char *message, size_t cap);
void cm_times_free(struct cm_times *times);

#endif
