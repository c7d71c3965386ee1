/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Usage: bench_readings LANG FILE ROUNDS: CPU seconds, as JSON, of normalising each line of FILE, of ICU
 * segmenting it into sentences and words, and of only composing its letters, as for a language without a
 * file.
 */
#include "server/base/buf.h"
#include "server/normalize/normalizers.h"
#include "server/normalize/text_rules.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unicode/ubrk.h>
#include <unicode/ustring.h>

enum { LINE = 4096 };

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec + (double)t.tv_nsec * 1e-9;
}

typedef size_t (*each)(void *ctx, const char *line, size_t size);

/* Returns the CPU seconds of applying the function to each line; negative on failure. */
static double spend(const struct buf *text, each act, void *ctx) {
    const char *s = (const char *)text->data;
    size_t made = 0;
    double begin = now();
    for (size_t at = 0; at < text->size;) {
        const char *end = memchr(s + at, '\n', text->size - at);
        size_t size = end ? (size_t)(end - s) - at : text->size - at;
        made += act(ctx, s + at, size);
        at += size + 1;
    }
    return made ? now() - begin : -1;
}

static size_t in_words(void *rules, const char *line, size_t size) {
    struct said said;
    if (!text_rules_say(rules, line, size, &said))
        return size;
    size_t bytes = said.words.size;
    said_free(&said);
    return bytes;
}

struct breaks {
    UBreakIterator *sentences, *words;
};

static size_t boundaries(void *ctx, const char *line, size_t size) {
    const struct breaks *b = ctx;
    UChar units[LINE];
    int32_t length = 0;
    size_t count = 0;
    UErrorCode e = U_ZERO_ERROR;
    u_strFromUTF8(units, LINE, &length, line, (int32_t)size, &e);
    ubrk_setText(b->sentences, units, length, &e);
    while (U_SUCCESS(e) && ubrk_next(b->sentences) != UBRK_DONE)
        count++;
    ubrk_setText(b->words, units, length, &e);
    while (U_SUCCESS(e) && ubrk_next(b->words) != UBRK_DONE)
        count++;
    return count;
}

int main(int argc, char **argv) {
    FILE *file = argc == 4 ? fopen(argv[2], "rb") : NULL;
    struct buf text = {0};
    struct normalizers normalizers = {0};
    struct error e;
    UErrorCode why = U_ZERO_ERROR;
    for (size_t n = 1; file && n; text.size += n)
        n = fread(buf_reserve(&text, 65536), 1, 65536, file);
    if (!text.size || normalizers_load(&normalizers, SOURCE_ROOT "/models/normalization", &e))
        return 1;
    struct breaks breaks = {ubrk_open(UBRK_SENTENCE, argv[1], NULL, 0, &why),
                            ubrk_open(UBRK_WORD, argv[1], NULL, 0, &why)};
    struct text_rules *rules = normalizers_rules(&normalizers, argv[1]);
    if (U_FAILURE(why) || !rules || spend(&text, in_words, rules) < 0) /* compiles the expressions */
        return 1;
    for (int i = 0; i < atoi(argv[3]); i++)
        printf("%s[%.6f, %.6f, %.6f]", i ? ", " : "[", spend(&text, in_words, rules),
               spend(&text, boundaries, &breaks), spend(&text, in_words, NULL));
    puts("]");
    ubrk_close(breaks.sentences);
    ubrk_close(breaks.words);
    normalizers_free(&normalizers);
    buf_free(&text);
    fclose(file);
    return 0;
}
