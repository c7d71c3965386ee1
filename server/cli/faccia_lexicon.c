/* SPDX-License-Identifier: GPL-3.0-or-later */
/* faccia lexicon: checks files of pronunciations. */
#include "server/cli/cli.h"
#include "server/normalize/lexicon.h"
#include <stdlib.h>
#include <string.h>

static const char usage[] =
    "Usage: faccia lexicon check FILE...\n"
    "Reads each FILE as a lexicon (W3C PLS 1.0), and prints how many spellings of which language\n"
    "it has, and what is wrong or ignored: FILE:LINE:COLUMN: warning|error: message.\n"
    "The exit code is 1 if a file, or a lexeme in it, cannot be used.\n";

/* Returns -1 if something in the file cannot be used. */
static int check(const char *path) {
    struct buf text = {0};
    struct error e;
    buf_reserve(&text, 1);
    if (cli_read(path, &text)) {
        buf_free(&text);
        return -1;
    }
    size_t warnings = 0;
    struct lexicon *lexicon = lexicon_read((const char *)text.data, text.size, &e);
    if (!lexicon) {
        char message[320];
        printf("%s:%zu:%zu: error: %s\n", path, e.place == PLACE_LINE ? e.line : 1,
               e.place == PLACE_LINE ? e.column : 1,
               e.place == PLACE_LINE ? e.message : error_text(&e, message, sizeof message));
        buf_free(&text);
        return -1;
    }
    const struct error *faults = lexicon_warnings(lexicon, &warnings);
    size_t left_out = lexicon_left_out(lexicon);
    for (size_t i = 0; i < warnings; i++)
        printf("%s:%zu:%zu: warning: %s\n", path, faults[i].line, faults[i].column, faults[i].message);
    printf("%s: %zu spellings (%s), %zu ignored\n", path, lexicon_count(lexicon), lexicon_lang(lexicon),
           left_out);
    lexicon_free(lexicon);
    buf_free(&text);
    return left_out ? -1 : 0;
}

int lexicon_main(int argc, char **argv, const struct settings *settings) {
    const struct cli_option options[] = {{0}};
    (void)settings;
    int result = cli_options(argc, argv, usage, options, NULL);
    if (result >= 0)
        return result;
    if (argc - optind < 2 || strcmp(argv[optind], "check") != 0) {
        cli_complain(optind < argc && strcmp(argv[optind], "check")
                         ? "the only command is 'faccia lexicon check'"
                         : "check: a file is needed");
        return EXIT_USAGE;
    }
    struct cli_file out = {.file = stdout, .path = "standard output"};
    result = EXIT_DONE;
    for (int i = optind + 1; i < argc; i++)
        if (check(argv[i]))
            result = EXIT_FAILED;
    return cli_finish(&out, true) ? EXIT_FAILED : result;
}
