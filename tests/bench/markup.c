/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Usage: bench_markup FILE ROUNDS: CPU seconds of reading FILE into a score, and of expat alone, as JSON. */
#include "server/markup/markup.h"
#include "server/base/buf.h"
#include <expat.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec + (double)t.tv_nsec * 1e-9;
}

static void on_start(void *count, const XML_Char *name, const XML_Char **attributes) {
    (void)name;
    (void)attributes;
    ++*(size_t *)count;
}

static void on_end(void *count, const XML_Char *name) {
    (void)count;
    (void)name;
}

static void on_text(void *count, const XML_Char *text, int n) {
    (void)text;
    *(size_t *)count += (size_t)n;
}

static double bare(const struct buf *text) {
    size_t count = 0;
    double begin = now();
    XML_Parser parser = XML_ParserCreate("UTF-8");
    XML_SetUserData(parser, &count);
    XML_SetElementHandler(parser, on_start, on_end);
    XML_SetCharacterDataHandler(parser, on_text);
    bool well = XML_Parse(parser, (char *)text->data, (int)text->size, 1) == XML_STATUS_OK && count;
    XML_ParserFree(parser);
    return well ? now() - begin : -1;
}

static double ours(const struct buf *text) {
    struct error e;
    double begin = now();
    struct score *score = markup_read(markup_by_name("auto"), (char *)text->data, text->size, NULL, &e);
    bool well = score;
    score_free(score);
    return well ? now() - begin : -1;
}

int main(int argc, char **argv) {
    FILE *file = argc == 3 ? fopen(argv[1], "rb") : NULL;
    struct buf text = {0};
    for (size_t n = 1; file && n; text.size += n)
        n = fread(buf_reserve(&text, 65536), 1, 65536, file);
    if (!text.size)
        return 1;
    for (int i = 0; i < atoi(argv[2]); i++) {
        double a = bare(&text), b = ours(&text);
        if (a < 0 || b < 0)
            return 1;
        printf("%s[%.6f, %.6f]", i ? ", " : "[", a, b);
    }
    puts("]");
    fclose(file);
    buf_free(&text);
    return 0;
}
