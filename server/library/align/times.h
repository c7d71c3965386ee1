/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Files that tell the times of recorded phones and words:
 *   "lab"      Festival, XWaves, MaryTTS: END COLOUR NAME a line, seconds, after an optional header that ends
 *              with a line "#"
 *   "htk"      START END NAME [SCORE] [WORD] a line, in units of 100 ns; also in a master label file (.mlf)
 *   "textgrid" Praat, long or short text form: the intervals of one tier, and of one with words
 *   "json"     {"phones": [{"ipa" or "name", "start", "end", "stress"}], "words": [{"text", "start",
 * "end"}]}, seconds: what `faccia say --json` and `faccia align --json` write "offsets"  INDEX: OFFSET SYMBOL
 * a line (server/face/packs/transcription.h) in UTF-8, or in UTF-16 with a byte order mark, as Praat writes
 * them.
 */
#ifndef FACCIA_LIBRARY_ALIGN_TIMES_H
#define FACCIA_LIBRARY_ALIGN_TIMES_H

#include "server/base/error.h"
#include "server/face/packs/transcription.h"
#include <jansson.h>

enum times_format {
    TIMES_LAB,
    TIMES_HTK,
    TIMES_TEXTGRID,
    TIMES_JSON,
    TIMES_OFFSETS,
    TIMES_FORMATS,
    TIMES_GUESS = TIMES_FORMATS, /* detect it */
};
extern const char *const times_format_names[TIMES_FORMATS];

struct times_options {
    enum times_format format;
    const char *tier; /* textgrid: tier of the phones; NULL = "phones", "MAU", "anna - phones"..., or the only
                         one besides the words */
    const char *
        word_tier; /* textgrid: tier of the words; NULL = "words", "ORT-MAU", "anna - words"..., if present */
    const char *entry;   /* htk, in a master label file: name of the sound; NULL = the first */
    const json_t *names; /* name in the file -> IPA with optional stress mark, "" = a pause; NULL = names are
                            IPA (or X-SAMPA) */
    const struct speech_pack *pack;   /* offsets: its table of symbols */
    struct transcription_sound sound; /* offsets: their sound; rate 0 = transcription_wav */
};

/* Times in seconds. */
struct times_phone {
    char name[32]; /* as written */
    char ipa[32];  /* "" = a pause */
    double start, end;
    uint8_t stress;
};

struct times_word {
    char *text;
    double start, end;
};

struct times {
    struct times_phone *phones; /* ascending, without overlap */
    size_t phone_count, phone_cap;
    struct times_word *words; /* ascending */
    size_t word_count, word_cap;
    char unnamed[32]; /* a name missing from the table */
};

/* -1 with *e ("bad-times"; line, field or byte). Free the times in either case. */
int times_read(struct times *times, const struct times_options *options, const char *data, size_t size,
               struct error *e);
void times_free(struct times *times);

#endif
