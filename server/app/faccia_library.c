/* SPDX-License-Identifier: GPL-3.0-or-later */
/* faccia library: reads a folder of works as the daemon would, and tells what it found. */
#include "server/app/cli.h"
#include "server/app/cli_options.h"
#include "server/app/library_export.h"
#include "server/base/mem.h"
#include "server/library/library_files.h"
#include "server/library/work.h"
#include <getopt.h>
#include <stdlib.h>
#include <string.h>

struct checking {
    const char *path;
    size_t sections, passages, characters, serious, light;
};

static int on_section(void *ctx, const struct section *section) {
    struct checking *c = ctx;
    c->sections++;
    c->passages += section->passages;
    c->characters += section->characters;
    return 0;
}

/* FILE:LINE:COLUMN: message (code), as compilers have it. */
static void print_problem(const char *path, const struct error *e) {
    if (e->place == PLACE_LINE)
        printf("%s:%zu:%zu: %s (%s)\n", path, e->line, e->column, e->message, error_name(e->code));
    else
        printf("%s: %s (%s)\n", path, e->message, error_name(e->code));
}

static void on_problem(void *ctx, const struct error *e, bool serious) {
    struct checking *c = ctx;
    c->serious += serious;
    c->light += !serious;
    print_problem(c->path, e);
}

static void check(struct checking *all, const char *folder, const char *path, const char *lang) {
    struct checking c = {.path = path};
    const struct work_sink sink = {&c, on_section, on_problem};
    struct work_meta meta = {.lang = mem_strdup(lang)};
    struct error e;
    char name[64];
    if (work_read(folder, path, &meta, &sink, &e)) {
        c.serious++;
        print_problem(path, &e);
    }
    library_file_name(path, false, name);
    if (c.sections)
        printf("%-24s %-6s %-8s %4zu sections %6zu passages %9zu bytes%s  %s%s%s\n", name, meta.lang,
               meta.format, c.sections, c.passages, c.characters,
               library_file_has_sound(folder, path) ? "  recorded" : "", meta.author ? meta.author : "",
               meta.author ? ": " : "", meta.title ? meta.title : path);
    all->sections += c.sections > 0;
    all->passages += c.passages;
    all->characters += c.characters;
    all->serious += c.serious;
    all->light += c.light;
    work_meta_free(&meta);
}

int library_main(int argc, char **argv, const struct settings *settings) {
    static const char usage[] =
        "Usage: faccia library DIR\n"
        "       faccia library export [OPTION]... DIR WORK\n"
        "Reads the works of a folder (TEI, EPUB, Markdown, text, APML, JSML, SSML) and tells what is in them "
        "and\n"
        "what is wrong, with file, line and column. Exits with 1 when something could not be read.\n"
        "export writes a work down as a book that is heard, captions, and more: faccia library export "
        "--help\n";
    static const struct cli_option options[] = {{0}};
    struct library_files files = {0};
    struct checking all = {0};
    struct error e;
    if (argc > 1 && !strcmp(argv[1], "export"))
        return library_export_main(argc - 1, argv + 1, settings);
    int status = cli_options(argc, argv, usage, options, NULL);
    if (status >= 0)
        return status;
    if (argc - optind != 1) {
        cli_complain("library: a folder is needed");
        return EXIT_USAGE;
    }
    if (library_files_list(&files, argv[optind], &e)) {
        cli_complain_of(&e);
        library_files_free(&files);
        return EXIT_FAILED;
    }
    for (size_t i = 0; i < files.count; i++)
        check(&all, argv[optind], files.list[i].path, settings->lang);
    printf("%zu works, %zu passages, %zu bytes; %zu problems, %zu hints\n", all.sections, all.passages,
           all.characters, all.serious, all.light);
    library_files_free(&files);
    return all.serious ? EXIT_FAILED : EXIT_DONE;
}
