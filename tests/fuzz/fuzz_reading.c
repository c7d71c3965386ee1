/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Texts such as dates, numbers and sums: byte 0 selects the language, byte 1 the kind, the rest is the text.
 */
#include "server/base/utf8.h"
#include "server/normalize/normalizers.h"
#include "tests/fuzz/fuzz.h"
#include <stdlib.h>
#include <string.h>

static const struct normalizers *normalizers(void) {
    static struct normalizers loaded;
    struct error e;
    FUZZ_CHECK(loaded.count || !normalizers_load(&loaded, SOURCE_ROOT "/models/normalization", &e));
    return &loaded;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    static const char *const langs[] = {"it", "en", "pt-BR", "tr", "ja"};
    static const char *const ways[] = {"cardinal", "ordinal",  "digits",   "telephone", "fraction",
                                       "date",     "date:dmy", "date:mdy", "date:ymd",  "date:dm",
                                       "date:my",  "date:y",   "time",     "time:hms",  "time:h",
                                       "duration", "currency", "measure",  "net:email", "net:url"};
    struct fuzz_input in = fuzz_input(data, size);
    const char *lang = langs[fuzz_below(&in, sizeof langs / sizeof *langs)];
    const char *way = ways[fuzz_below(&in, sizeof ways / sizeof *ways)];
    char *text = fuzz_rest_text(&in);
    if (utf8_check(text, strlen(text)) == strlen(text)) { /* like all text accepted by the markup readers */
        struct buf out = {0};
        bool read = normalizer_words(normalizers_find(normalizers(), lang), way, text, &out);
        FUZZ_CHECK(read || !out.size);
        FUZZ_CHECK(!out.size || utf8_check((char *)out.data, out.size) == out.size);
        buf_free(&out);

        struct score *score = score_new();
        struct score_style style = score_plain_style;
        style.say_as = score_strndup(score, way, strlen(way));
        struct score_item *item = score_add(score, SCORE_TEXT, 0, strlen(text));
        item->text = score_strndup(score, text, strlen(text));
        item->style = score_keep_style(score, &style);
        item->verbatim = true;
        score->input = item->text;
        score->input_size = strlen(text);
        normalizers_apply(normalizers(), score, 0, lang);
        FUZZ_CHECK(!score->items[0].verbatim || !strcmp(score->items[0].text, text));
        score_free(score);
    }
    free(text);
    return 0;
}
