/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/app/cli.h"
#include "server/base/mem.h"
#include "server/voice/voice_config.h"
#include <errno.h>
#include <getopt.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

void cli_complain(const char *format, ...) {
    va_list args;
    va_start(args, format);
    fputs("faccia: ", stderr);
    vfprintf(stderr, format, args);
    fputc('\n', stderr);
    va_end(args);
}

static void on_ready(void *ctx) {
    *(bool *)ctx = true;
}

static int load_expressions(struct cli *cli, struct error *e) {
    char path[4096];
    snprintf(path, sizeof path, "%s/expressions.json", cli->paths.models);
    cli->pipeline.expressions = cli->expressions = expressions_load(path, e);
    return cli->expressions ? 0 : -1;
}

static int load_readings(struct cli *cli, struct error *e) {
    char path[4096];
    snprintf(path, sizeof path, "%s/normalization", cli->paths.models);
    cli->pipeline.normalizers = &cli->normalizers;
    return normalizers_load(&cli->normalizers, path, e);
}

/* The daemon's settings of voices that concern a single text, from the environment as there. */
static int read_environment(struct voice_pool_options *options, struct error *e) {
    double megabytes = 0;
    const struct {
        const char *name;
        double *value, least, most;
    } limits[] = {
        {"FACCIA_DEADLINE_BASE", &options->deadline_base, 0.1, 3600},
        {"FACCIA_DEADLINE_PER_BYTE", &options->deadline_per_byte, 0, 10},
        {"FACCIA_DEADLINE_MOST", &options->deadline_most, 1, 1000},
        {"FACCIA_WORKER_PROCESSOR", &options->processor, 0.01, 1000},
        {"FACCIA_WORKER_MEMORY", &megabytes, 64, 1048576},
    };
    for (size_t i = 0; i < sizeof limits / sizeof *limits; i++) {
        const char *text = getenv(limits[i].name);
        char *end;
        if (!text || !*text)
            continue;
        *limits[i].value = strtod(text, &end);
        if (*end || !(*limits[i].value >= limits[i].least && *limits[i].value <= limits[i].most))
            return error_in_field(e, ERROR_BAD_FIELD, limits[i].name,
                                  "'%s' is not a number from %.12g to %.12g", text, limits[i].least,
                                  limits[i].most);
    }
    const char *sandbox = getenv("FACCIA_SANDBOX");
    options->unconfined = sandbox && !strcmp(sandbox, "off");
    options->megabytes = (unsigned)megabytes;
    return 0;
}

int cli_open(struct cli *cli) {
    struct error e;
    char text[400];
    bool ready = false;
    *cli = (struct cli){0};
    paths_find(&cli->paths);
    uv_loop_init(&cli->loop);
    cli->pipeline = (struct pipeline){.loop = &cli->loop, .packs = &cli->packs, .default_lang = "it"};
    struct voice_pool_options options = {
        .worker = cli->paths.worker, .plugin_dir = cli->paths.plugins, .quiet = true};
    bool fit = !read_environment(&options, &e), configured = *cli->paths.voice_config;
    char *config = fit && configured ? voice_config_read(cli->paths.voice_config, &e) : NULL;
    options.config = config;
    snprintf(text, sizeof text, "%s/speech", cli->paths.models);
    if (!fit || (configured && !config) || speech_packs_load(&cli->packs, text, &e) ||
        load_expressions(cli, &e) || load_readings(cli, &e) ||
        !(cli->pipeline.voices = voice_pool_open(&cli->loop, &options, on_ready, &ready, &e))) {
        cli_complain("%s", error_text(&e, text, sizeof text));
        free(config);
        return -1;
    }
    free(config);
    while (!ready && uv_run(&cli->loop, UV_RUN_ONCE))
        ;
    size_t count;
    voice_pool_voices(cli->pipeline.voices, &count);
    if (!count)
        cli_complain("no voice plugin could be started");
    return count ? 0 : -1;
}

void cli_close(struct cli *cli) {
    if (cli->pipeline.voices)
        voice_pool_close(cli->pipeline.voices, NULL, NULL);
    uv_run(&cli->loop, UV_RUN_DEFAULT);
    uv_loop_close(&cli->loop);
    speech_packs_free(&cli->packs);
    expressions_free(cli->expressions);
    normalizers_free(&cli->normalizers);
    paths_free(&cli->paths);
}

int cli_read(const char *path, struct buf *text) {
    enum { BYTES_MAX = 256 << 20 }; /* some devices have no end */
    FILE *file = !strcmp(path, "-") ? stdin : fopen(path, "rb");
    size_t got = 1;
    while (file && got && text->size <= BYTES_MAX) {
        got = fread(buf_reserve(text, 65536), 1, 65536, file);
        text->size += got;
    }
    bool large = text->size > BYTES_MAX, failed = !file || ferror(file) || large;
    if (failed)
        cli_complain("%s: %s", path, large ? "larger than 256 MiB" : strerror(errno));
    if (file && file != stdin)
        fclose(file);
    return failed ? -1 : 0;
}

int cli_text(int argc, char **argv, const char *path, struct buf *text) {
    if (!path && optind + 1 == argc && !strcmp(argv[optind], "-"))
        path = argv[optind++];
    if (!path == (optind == argc)) {
        cli_complain(path ? "unexpected '%s': the text is in a file"
                          : "no text: give it, a --file, or - for standard input",
                     argv[optind]);
        return EXIT_USAGE;
    }
    if (path && cli_read(path, text))
        return EXIT_FAILED;
    for (int i = optind; i < argc; i++)
        buf_printf(text, "%s%s", i > optind ? " " : "", argv[i]);
    return -1;
}

int cli_try_engine(const struct cli *cli, const struct speech_request *request, const char *engine,
                   struct error *e) {
    static const struct synthesis_callbacks none;
    struct speech_request copy;
    request_copy(&copy, request);
    free(copy.engine);
    copy.engine = mem_strdup(engine);
    struct synthesis *synthesis = synthesis_open(&cli->pipeline, &copy, &none, NULL, e);
    request_free(&copy);
    synthesis_free(synthesis);
    return synthesis ? 0 : -1;
}
