/* SPDX-License-Identifier: GPL-3.0-or-later */
/* faccia read: prints the words that would be spoken beside the written text. */
#include "server/base/mem.h"
#include "server/cli/cli.h"
#include "server/expression/expressions.h"
#include "server/markup/markup.h"
#include "server/normalize/lexicon.h"
#include "server/normalize/normalizers.h"
#include "server/normalize/said_words.h"
#include <getopt.h>
#include <stdlib.h>
#include <string.h>

static const char usage[] =
    "Usage: faccia read [OPTION]... TEXT...\n"
    "Shows how TEXT (- = standard input) is read aloud, without a voice: on each line a word or words, as\n"
    "they will be spoken, a tab, and the text that they stand for. A question mark follows words whose\n"
    "reading is a guess.\n"
    "\n"
    "  -l, --lang TAG         language of the text (the daemon's default)\n"
    "  -f, --file FILE        read the text from a file\n"
    "  -m, --markup NAME      plain, apml, jsml, ssml, emotionml, bml, fml, or auto (auto): by the root "
    "element\n"
    "  -n, --normalize WHICH  on, or off: leave numbers, signs and abbreviations to the voice (on)\n"
    "      --lexicon FILE     pronunciation lexicon (W3C PLS); may be repeated\n"
    "  -w, --words            print only the words, on one line\n";

struct read {
    const char *lang, *markup, *file, *normalize;
    bool words;
    struct cli_lexicons lexicons;
    struct components *components;
};

static const char **langs_of(const struct read *r, const struct score *script) {
    const char **langs = mem_alloc((script->item_count + 1) * sizeof *langs);
    for (size_t i = 0; i < script->item_count; i++)
        langs[i] = script->items[i].style->lang ? script->items[i].style->lang : r->lang;
    return langs;
}

static void show_item(const struct score *script, const struct score_item *item, bool words,
                      struct buf *out) {
    const struct score_part whole = {0, strlen(item->text), item->start, item->end, item->verbatim, false};
    const struct score_part *parts = item->parts ? item->parts : &whole;
    size_t count = item->parts ? item->part_count : 1;
    if (words) {
        said_words(item->text, strlen(item->text), out);
        return;
    }
    for (size_t i = 0; i < count; i++)
        said_words_beside(item->text + parts[i].offset, script->input, &parts[i], out);
}

/* True if the script has other items now. */
static bool say_by_lexicons(const struct read *r, struct score *script, const char *const *langs) {
    size_t *was = lexicons_apply(r->components->pipeline.lexicons, r->components->pipeline.named_lexicons,
                                 script, langs, NULL, NULL);
    free(was);
    return was != NULL;
}

static int read_text(const struct read *r, const struct buf *text, const struct markup_kind *kind) {
    struct error e;
    struct markup_rules rules = {.lang = r->lang,
                                 .lenient = true,
                                 .sign_said = lexicons_sign,
                                 .sign_lexicons = r->components->pipeline.lexicons,
                                 .lexicons = r->components->named_lexicons.names,
                                 .markdown_out = strcmp(r->normalize, "off") != 0,
                                 .abbreviations =
                                     normalizers_abbreviations(&r->components->normalizers, r->lang)};
    struct score *document = markup_read(kind, (const char *)text->data, text->size, &rules, &e);
    if (!document) {
        cli_complain_at(r->file, false, &e);
        return EXIT_FAILED;
    }
    struct score *script = score_script(document);
    const char **langs = langs_of(r, script);
    struct buf out = {0};
    script->input = (const char *)text->data;
    if (say_by_lexicons(r, script, langs)) {
        free(langs);
        langs = langs_of(r, script);
    }
    if (strcmp(r->normalize, "off"))
        normalize_script(r->components->pipeline.normalizers, script, langs);
    for (size_t i = 0; i < script->item_count; i++) {
        const struct score_item *item = &script->items[i];
        if (item->kind == SCORE_TEXT && item->text)
            show_item(script, item, r->words, &out);
    }
    if (r->words)
        buf_add(&out, "\n", 1);
    fwrite(out.data, 1, out.size, stdout);
    buf_free(&out);
    free(langs);
    score_free(script);
    score_free(document);
    return EXIT_DONE;
}

static int take_lexicon(void *ctx, const char *name, const char *text) {
    struct read *r = ctx;
    (void)name;
    cli_lexicons_add(&r->lexicons, (char *)text);
    return -1;
}

static int run(struct read *r, int argc, char **argv, const struct settings *settings) {
    const struct cli_option options[] = {
        {.name = "lang", .letter = 'l', .kind = CLI_TEXT, .out = &r->lang},
        {.name = "file", .letter = 'f', .kind = CLI_TEXT, .out = &r->file},
        {.name = "markup", .letter = 'm', .kind = CLI_TEXT, .out = &r->markup},
        {.name = "normalize", .letter = 'n', .kind = CLI_TEXT, .out = &r->normalize},
        {.name = "lexicon", .kind = CLI_CALL, .take = take_lexicon},
        {.name = "words", .letter = 'w', .kind = CLI_FLAG, .out = &r->words},
        {0},
    };
    struct buf text = {0};
    struct components stages;
    int result = cli_options(argc, argv, usage, options, r);
    if (result >= 0)
        return result;
    const struct markup_kind *kind = markup_by_name(r->markup);
    if (!kind || (strcmp(r->normalize, "on") && strcmp(r->normalize, "off"))) {
        cli_complain(kind ? "normalize: must be on or off" : "markup: unknown markup '%s'", r->markup);
        return EXIT_USAGE;
    }
    buf_reserve(&text, 1);
    result = cli_text(argc, argv, r->file, &text);
    if (result >= 0) {
        buf_free(&text);
        return result;
    }
    result = EXIT_FAILED;
    if (!cli_load(&stages, cli_lexicons_with(&r->lexicons, settings), COMPONENTS_NORMALIZATION, NULL)) {
        r->components = &stages;
        result = read_text(r, &text, markup_detect(kind, (const char *)text.data, text.size));
    }
    components_free(&stages);
    buf_free(&text);
    return result;
}

int read_main(int argc, char **argv, const struct settings *settings) {
    struct read r = {.lang = settings->lang, .markup = "auto", .normalize = "on"};
    int result = run(&r, argc, argv, settings);
    cli_lexicons_free(&r.lexicons);
    return result;
}
