/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/app/cli.h"
#include "server/base/mem.h"
#include "server/base/utf8.h"
#include <errno.h>
#include <getopt.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

void cli_complain(const char *format, ...) {
    char text[4096];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    utf8_mend(text); /* it quotes names of files and texts of others */
    fprintf(stderr, "faccia: %s\n", text);
}

void cli_complain_of(const struct error *e) {
    char text[400];
    cli_complain("%s (%s)", error_text(e, text, sizeof text), error_name(e->code));
}

int cli_load(struct stages *stages, const struct settings *settings, unsigned wanted, uv_loop_t *loop) {
    struct error e;
    int result = stages_load(stages, settings, wanted, loop, &e);
    if (result)
        cli_complain_of(&e);
    return result;
}

static void on_ready(void *ctx) {
    *(bool *)ctx = true;
}

/* For a single text: nothing is kept, and nobody waits besides. */
static int start_voices(struct cli *cli, const struct settings *settings) {
    struct voice_pool_options voices = settings->voices;
    struct error e;
    bool ready = false;
    size_t count;
    voices.workers = 1;
    voices.spare_workers = 0;
    voices.cache = (struct cache_options){0};
    voices.quiet = true;
    if (stages_start_voices(&cli->stages, &voices, on_ready, &ready, &e)) {
        cli_complain_of(&e);
        return -1;
    }
    while (!ready && uv_run(&cli->loop, UV_RUN_ONCE))
        ;
    voice_pool_voices(cli->stages.pipeline.voices, &count);
    if (!count)
        cli_complain("no voice plugin could be started");
    return count ? 0 : -1;
}

int cli_open(struct cli *cli, const struct settings *settings) {
    *cli = (struct cli){0};
    uv_loop_init(&cli->loop);
    /* nobody is heard: faccia hear reads the network itself */
    return cli_load(&cli->stages, settings, STAGES_ALL & ~STAGES_HEARING, &cli->loop) ||
                   start_voices(cli, settings)
               ? -1
               : 0;
}

void cli_close(struct cli *cli) {
    stages_stop_voices(&cli->stages);
    uv_run(&cli->loop, UV_RUN_DEFAULT);
    uv_loop_close(&cli->loop);
    stages_free(&cli->stages);
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
    struct synthesis *synthesis = synthesis_open(&cli->stages.pipeline, &copy, &none, NULL, e);
    request_free(&copy);
    synthesis_free(synthesis);
    return synthesis ? 0 : -1;
}
