/* SPDX-License-Identifier: GPL-3.0-or-later */
/* faccia check: reports what in a text has no effect. */
#include "server/base/mem.h"
#include "server/base/options.h"
#include "server/base/utf8.h"
#include "server/cli/cli.h"
#include "server/expression/expressions.h"
#include "server/markup/markup.h"
#include "server/markup/score.h"
#include "server/normalize/normalizers.h"
#include "server/normalize/said_words.h"
#include <stdlib.h>

static const char usage[] =
    "Usage: faccia check [OPTION]... FILE...\n"
    "Reads each FILE (- = standard input) as it would be spoken, and reports what is wrong, ignored, or "
    "guessed:\n"
    "FILE:LINE:COLUMN: warning|error: message. The exit code is 1 when there is an error.\n"
    "\n"
    "  -m, --markup NAME  plain, apml, jsml, ssml, emotionml, bml, fml, or auto (auto): by the root element\n"
    "  -l, --lang TAG     language of the texts (the daemon's default)\n"
    "      --lexicon FILE pronunciation lexicon (W3C PLS), also checked; may be repeated\n"
    "  -s, --score        also print what was understood\n";

struct check {
    const struct markup_kind *kind;
    bool score;
    const struct expressions *expressions;
    const char *const *lexicons; /* names that texts may give */
    const struct normalizers *normalizers;
    const char *lang;  /* of a text that names none */
    const char *asked; /* the same if the user named it, so that the score does not repeat it; else NULL */
};

static void report(const char *path, const char *severity, const struct error *e, const struct buf *text) {
    struct lines lines = {0};
    size_t line = e->line, column = e->column, size = text->size;
    if (e->place != PLACE_LINE)
        lines_place(&lines, (const char *)text->data, e->place == PLACE_BYTE && e->byte < size ? e->byte : 0,
                    &line, &column);
    printf("%s:%zu:%zu: %s: %s\n", path, line, column, severity, e->message);
}

/* Decodes the text to UTF-8, in place. */
static int decode(struct buf *text, struct error *e) {
    char *decoded;
    size_t size;
    if (markup_decode((const char *)text->data, text->size, &decoded, &size, e))
        return -1;
    if (decoded) {
        buf_free(text);
        *text = (struct buf){(uint8_t *)decoded, size, size};
    }
    return 0;
}

static int by_place(const void *a, const void *b) {
    const struct error *x = a, *y = b;
    if (x->line != y->line)
        return x->line < y->line ? -1 : 1;
    return (x->column > y->column) - (x->column < y->column);
}

/* Warns of each reading that may have been meant otherwise. */
static void look_for_guesses(const struct check *c, struct score *score) {
    const char **langs = mem_alloc((score->item_count + 1) * sizeof *langs);
    bool *told = mem_alloc(score->item_count + 1); /* its author says how to read it: no guess */
    for (size_t i = 0; i < score->item_count; i++) {
        langs[i] = score->items[i].style->lang ? score->items[i].style->lang : c->lang;
        told[i] = score->items[i].style->say_as != NULL;
    }
    const size_t count = score->item_count;
    normalize_script(c->normalizers, score, langs);
    free(langs);
    for (size_t i = 0; i < score->item_count && i < count; i++) {
        const struct score_item *item = &score->items[i];
        for (size_t k = 0; item->parts && !told[i] && k < item->part_count; k++) {
            const struct score_part *p = &item->parts[k];
            struct buf words = {0};
            if (!p->guess)
                continue;
            said_words(item->text + p->offset, p->bytes, &words);
            score_warn(score, p->start, ERROR_GUESSED, "\"%.*s\" is read as \"%.*s\": a guess",
                       (int)(p->end - p->start < 60 ? p->end - p->start : 60), score->input + p->start,
                       (int)(words.size < 100 ? words.size : 100), words.size ? (char *)words.data : "");
            buf_free(&words);
        }
    }
    free(told);
}

/* Warns of unknown expressions, of what cannot be spoken, and of guesses, in order with the other warnings.
 */
static void look_further(const struct check *c, struct score *score) {
    expressions_direct(c->expressions, score);
    normalize_warn_unspoken(score, NULL);
    look_for_guesses(c, score);
    if (score->warning_count)
        qsort(score->warnings, score->warning_count, sizeof *score->warnings, by_place);
}

static int check(const struct check *c, const char *path) {
    struct buf text = {0}, dump = {0};
    struct score *document = NULL, *score = NULL;
    struct error e;
    buf_reserve(&text, 1);
    if (cli_read(path, &text)) {
        buf_free(&text);
        return -1;
    }
    bool read = !decode(&text, &e);
    /* A stream speaks malformed markup as plain text; an author wants its errors. */
    const struct markup_kind *kind =
        read ? markup_detect(c->kind, (const char *)text.data, text.size) : c->kind;
    if (kind == markup_by_name("plain"))
        kind = c->kind;
    struct markup_rules rules = {.lang = c->asked,
                                 .affects = expressions_affects(c->expressions),
                                 .lexicons = c->lexicons,
                                 .abbreviations = normalizers_abbreviations(c->normalizers, c->lang)};
    if (read)
        document = markup_read(kind, (const char *)text.data, text.size, &rules, &e);
    if (!document)
        report(path, "error", &e, &text);
    if (document && c->score)
        score_dump(document, &dump);
    if (document)
        look_further(c, score = score_script(document));
    for (size_t i = 0; score && i < score->warning_count; i++)
        report(path, "warning", &score->warnings[i], &text);
    if (dump.size)
        fwrite(dump.data, 1, dump.size, stdout);
    int failed = document ? 0 : -1;
    score_free(score);
    score_free(document);
    buf_free(&dump);
    buf_free(&text);
    return failed;
}

static int run(struct cli_lexicons *lexicons, int argc, char **argv, const struct settings *settings) {
    enum { HELP = 256 };
    static const struct option options[] = {{"markup", 1, NULL, 'm'},  {"score", 0, NULL, 's'},
                                            {"lexicon", 1, NULL, 'X'}, {"lang", 1, NULL, 'l'},
                                            {"help", 0, NULL, HELP},   {0}};
    struct check c = {.kind = markup_by_name("auto"), .lang = settings->lang};
    int most = cli_option_count(argc, argv, "m:sl:h", options);
    for (int o; (o = options_next(most, argv, "m:sl:h", options, NULL)) != -1;) {
        switch (o) {
        case 'm':
            c.kind = markup_by_name(optarg);
            if (c.kind)
                break;
            cli_complain("markup: unknown markup '%s'", optarg);
            return EXIT_USAGE;
        case 's':
            c.score = true;
            break;
        case 'l':
            c.lang = c.asked = optarg;
            break;
        case 'X':
            cli_lexicons_add(lexicons, optarg);
            break;
        case 'h':
        case HELP:
            fputs(usage, stdout);
            return EXIT_DONE;
        default:
            return EXIT_USAGE;
        }
    }
    if (optind == argc) {
        cli_complain("a file is needed, or - for standard input");
        return EXIT_USAGE;
    }
    struct components components;
    if (cli_load(&components, cli_lexicons_with(lexicons, settings),
                 COMPONENTS_EXPRESSIONS | COMPONENTS_NORMALIZATION, NULL)) {
        components_free(&components);
        return EXIT_FAILED;
    }
    c.expressions = components.pipeline.expressions;
    c.lexicons = components.named_lexicons.names;
    c.normalizers = &components.normalizers;
    struct cli_file out = {.file = stdout, .path = "standard output"};
    int result = EXIT_DONE;
    for (int i = optind; i < argc; i++)
        if (check(&c, argv[i]))
            result = EXIT_FAILED;
    components_free(&components);
    return cli_finish(&out, true) ? EXIT_FAILED : result;
}

int check_main(int argc, char **argv, const struct settings *settings) {
    struct cli_lexicons lexicons = {0};
    int result = run(&lexicons, argc, argv, settings);
    cli_lexicons_free(&lexicons);
    return result;
}
