/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Lexicons (PLS) and their application to a text: byte 0 selects the language, then comes the text preceded
 * by its size, the rest is the document. */
#include "server/markup/markup.h"
#include "server/normalize/lexicon.h"
#include "tests/fuzz/fuzz.h"
#include <stdlib.h>
#include <string.h>

enum { TEXT_MAX = 2000 };

/* Replaced items must follow each other in the text, as marks and captions point there. */
static void check(const struct score *script, const size_t *was) {
    for (size_t i = 0; i + 1 < script->item_count; i++) {
        FUZZ_CHECK(was[i] <= was[i + 1]);
        FUZZ_CHECK(script->items[i].start <= script->items[i].end);
    }
    for (size_t i = 0; i < script->sentence_count; i++)
        FUZZ_CHECK(script->sentences[i].first + script->sentences[i].count <= script->item_count);
    for (size_t i = 0; i < script->cue_count; i++)
        FUZZ_CHECK(script->cues[i].first <= script->cues[i].last &&
                   script->cues[i].last <= script->item_count);
}

static void apply(struct lexicon *lexicon, const char *lang, const char *text, size_t size) {
    struct lexicons all = {0};
    struct error e;
    lexicons_add(&all, lexicon);
    const struct markup_rules rules = {
        .lang = lang, .markdown_out = true, .sign_said = lexicons_sign, .sign_lexicons = &all};
    struct score *document =
        markup_read(markup_detect(markup_by_name("auto"), text, size), text, size, &rules, &e);
    struct score *script = document ? score_script(document) : NULL;
    if (script) {
        const char **langs = malloc((script->item_count + 1) * sizeof *langs);
        FUZZ_CHECK(langs);
        for (size_t i = 0; i < script->item_count; i++)
            langs[i] = script->items[i].style->lang ? script->items[i].style->lang : lang;
        size_t *was = lexicons_apply(&all, NULL, script, langs, NULL, NULL);
        if (was)
            check(script, was);
        free(was);
        free(langs);
        score_free(script);
    }
    score_free(document);
    lexicons_free(&all);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    static const char *const langs[] = {"it", "pt-BR", "tr", "en", "ja", "th"};
    struct fuzz_input in = fuzz_input(data, size);
    const char *lang = langs[fuzz_below(&in, 6)];
    struct error e;
    char text[TEXT_MAX + 1];
    size_t length = fuzz_u16(&in) % (TEXT_MAX + 1), bytes = 0, count;
    while (bytes < length && fuzz_left(&in))
        text[bytes++] = (char)fuzz_u8(&in);
    text[bytes] = '\0';
    uint8_t *document = fuzz_rest(&in, &size);
    struct lexicon *lexicon = lexicon_read((char *)document, size, &e);
    if (lexicon) {
        lexicon_warnings(lexicon, &count);
        FUZZ_CHECK(count <= SCORE_WARNINGS);
        apply(lexicon, lang, text, bytes);
    }
    free(document);
    return 0;
}
