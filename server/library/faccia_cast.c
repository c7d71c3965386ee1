/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/library/faccia_cast.h"
#include "server/base/json/error_json.h"
#include "server/base/mem.h"
#include "server/cli/cli.h"
#include "server/library/library_files.h"
#include <getopt.h>
#include <glob.h>
#include <stdlib.h>
#include <string.h>

/* Heads and what their files say of them. */
struct heads_read {
    json_t **files;
    struct cast_head *list;
    size_t count;
};

static double rank_of(const json_t *head) {
    return json_number_value(json_object_get(head, "rank"));
}

static int by_rank(const void *a, const void *b) {
    double x = rank_of(*(json_t *const *)a), y = rank_of(*(json_t *const *)b);
    return (x > y) - (x < y);
}

static const char *text_of(const json_t *object, const char *key) {
    const char *text = json_string_value(json_object_get(object, key));
    return text ? text : "";
}

static void heads_read(struct heads_read *heads, const char *models) {
    char pattern[4096];
    glob_t found = {0};
    snprintf(pattern, sizeof pattern, "%s/heads/*.json", models);
    size_t most = glob(pattern, 0, NULL, &found) ? 0 : found.gl_pathc;
    heads->files = mem_alloc((most + 1) * sizeof *heads->files);
    heads->list = mem_alloc((most + 1) * sizeof *heads->list);
    for (size_t i = 0; i < most; i++) {
        json_t *head = json_load_file(found.gl_pathv[i], 0, NULL);
        if (json_is_string(json_object_get(head, "name")))
            heads->files[heads->count++] = head;
        else
            json_decref(head);
    }
    globfree(&found);
    qsort(heads->files, heads->count, sizeof *heads->files, by_rank);
    for (size_t i = 0; i < heads->count; i++) {
        const json_t *voice = json_object_get(heads->files[i], "voice");
        heads->list[i] = (struct cast_head){text_of(heads->files[i], "name"), text_of(voice, "gender"),
                                            text_of(voice, "age")};
    }
}

static void heads_free(struct heads_read *heads) {
    for (size_t i = 0; i < heads->count; i++)
        json_decref(heads->files[i]);
    free(heads->files);
    free(heads->list);
}

struct counting {
    struct cast_tally speakers, told;
    const struct work_meta *meta;
};

static int tally(void *ctx, const struct section *section) {
    struct counting *c = ctx;
    cast_tally_section(&c->speakers, section);
    if (!c->speakers.count)
        cast_dialogue_section(&c->told, section, c->meta->lang);
    return 0;
}

static void pass_over(void *ctx, const struct error *e, bool serious) {
    (void)ctx, (void)e, (void)serious;
}

int cast_of_file(const char *folder, const char *path, const struct cli *cli, const struct settings *settings,
                 struct cast *cast, struct error *e) {
    struct work_meta meta = {.lang = mem_strdup(settings->lang)};
    struct counting counting = {.meta = &meta};
    const struct work_sink sink = {&counting, tally, pass_over};
    struct heads_read heads = {0};
    *cast = (struct cast){0};
    int result = work_read(folder, path, &meta, &sink, e);
    cast->told = !counting.speakers.count;
    cast_tally_take(cast->told ? &counting.told : &counting.speakers, &meta, cast);
    cast_tally_free(&counting.told);
    result = result || library_cast_beside(folder, path, cast, e) ? -1 : 0;
    if (!result) {
        size_t count = 0;
        const struct voice *voices = voice_pool_voices(cli->components.pipeline.voices, &count);
        struct cast_voice *list = mem_alloc((count + 1) * sizeof *list);
        for (size_t i = 0; i < count; i++)
            list[i] = (struct cast_voice){voices[i].id, voices[i].lang, voices[i].gender, voices[i].quality};
        heads_read(&heads, settings->models);
        const struct cast_offer offer = {list, count, heads.list, heads.count};
        cast_choose(cast, meta.lang, &offer);
        heads_free(&heads);
        free(list);
    }
    work_meta_free(&meta);
    return result;
}

static void print_member(const json_t *m) {
    const char *from = text_of(m, "sex_from");
    printf("%-20s %-24s %-6s %-13s %-6s %-16s %-8s pitch %.2f rate %.2f %5lld passages\n", text_of(m, "id"),
           text_of(m, "name"), *text_of(m, "sex") ? text_of(m, "sex") : "-", *from ? from : "-",
           *text_of(m, "age") ? text_of(m, "age") : "-", *text_of(m, "voice") ? text_of(m, "voice") : "-",
           *text_of(m, "head") ? text_of(m, "head") : "-", json_number_value(json_object_get(m, "pitch")),
           json_number_value(json_object_get(m, "rate")),
           (long long)json_integer_value(json_object_get(m, "passages")));
}

/* FILE: message, with the place that the error names. */
static void print_error(const char *file, const struct error *e) {
    char text[400];
    printf("%s: %s (%s)\n", file, error_text(e, text, sizeof text), error_name(e->code));
}

static void print(const struct cast *cast, const char *file, bool as_json) {
    json_t *all = cast_json(cast), *m;
    size_t i;
    if (as_json) {
        struct buf out = {0};
        json_write(&out, json_incref(all));
        printf("%.*s\n", (int)out.size, (const char *)out.data);
        buf_free(&out);
    } else {
        json_array_foreach(json_object_get(all, "cast"), i, m) {
            print_member(m);
        }
        for (i = 0; i < cast->problem_count; i++)
            print_error(file, &cast->problems[i]);
        printf("%zu speakers\n", cast->count);
    }
    json_decref(all);
}

int library_cast_main(int argc, char **argv, const struct settings *settings) {
    static const char usage[] =
        "Usage: faccia library cast [--json] FILE\n"
        "Shows who speaks in a play, and with which voice and head: by the persons that the text lists, and\n"
        "by WORK.cast.json beside it, which may decide otherwise. Exits with 1 if one of them is faulty.\n"
        "\n"
        "      --json  as GET /v1/library/works/WORK/cast answers\n"
        "  -h, --help  print this and exit\n";
    bool as_json = false;
    const struct cli_option options[] = {{.name = "json", .kind = CLI_FLAG, .out = &as_json}, {0}};
    struct cli cli = {0};
    struct cast cast = {0};
    struct error e;
    int status = cli_options(argc, argv, usage, options, NULL);
    if (status >= 0)
        return status;
    if (argc - optind != 1) {
        cli_complain("library cast: a file is needed");
        return EXIT_USAGE;
    }
    const char *file = argv[optind], *slash = strrchr(file, '/');
    char *folder = slash ? mem_strndup(file, slash == file ? 1 : (size_t)(slash - file)) : mem_strdup(".");
    status = cli_open(&cli, settings) ? EXIT_FAILED : EXIT_DONE;
    if (!status && cast_of_file(folder, slash ? slash + 1 : file, &cli, settings, &cast, &e)) {
        print_error(file, &e);
        status = EXIT_FAILED;
    } else if (!status) {
        print(&cast, file, as_json);
        status = cast.problem_count ? EXIT_FAILED : EXIT_DONE;
    }
    cast_free(&cast);
    cli_close(&cli);
    free(folder);
    return status;
}
