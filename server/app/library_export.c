/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/app/library_export.h"
#include "server/app/cli_options.h"
#include "server/app/library_export_files.h"
#include "server/app/library_place.h"
#include "server/base/mem.h"
#include "server/library/library_files.h"
#include <getopt.h>
#include <jansson.h>
#include <stdlib.h>
#include <string.h>

static const char usage[] =
    "Usage: faccia library export [OPTION]... DIR WORK\n"
    "Speaks a work of the folder DIR, and writes it down. WORK is its id, as 'faccia library DIR' tells it, "
    "or "
    "its file.\n"
    "\n"
    "      --epub FILE      a book that is heard and marked while it is read (EPUB 3 with media overlays)\n"
    "      --vtt FILE       captions with the times of their words (WebVTT)\n"
    "      --textgrid FILE  sentences, words and phones, for Praat\n"
    "      --fap FILE       the face, MPEG-4 FAPs as text (version 2.1)\n"
    "      --wav FILE       the sound, mono 16 bit\n"
    "      --ogg FILE       the sound as Opus in Ogg\n"
    "  -v, --voice ID       a voice that 'faccia voices' lists, or 'recording': the one beside the work\n"
    "  -r, --rate WPM       words per minute, 40 to 500\n"
    "      --fps N          FAP frames per second, 1 to 120 (25)\n"
    "      --sentences      the book marks sentences and lines, not words\n"
    "      --silent         the book has no sound\n"
    "      --progress       tells on standard error how far it is\n"
    "  -h, --help           print this and exit\n"
    "Exit status: 0 done, 1 something could not be spoken or written, 2 wrong usage.\n";

struct exporting {
    struct library_export_files files;
    struct recital recital;
    struct speech_request request;
    const char *folder, *work, *voice;
    bool silent, progress, failed;
    char *file, name[64], hash[65]; /* of the work */
    struct work_meta meta;
    unsigned sections, done;
};

static int on_segment(void *ctx, const struct media_segment *segment, const char *text, const char *markup) {
    struct exporting *x = ctx;
    return library_export_segment(&x->files, &x->recital, segment, text, markup);
}

static void on_problem(void *ctx, const struct error *e, bool warning) {
    struct exporting *x = ctx;
    char text[400];
    cli_complain("%s%s", warning ? "warning: " : "", error_text(e, text, sizeof text));
    x->failed |= !warning;
}

static int on_section(void *ctx, const struct section *section) {
    struct exporting *x = ctx;
    struct recital_part part = {0};
    if (!x->silent)
        recital_section(&x->recital, section, &part);
    int stop = x->recital.stopped || library_export_section(&x->files, section, &part, x->recital.rate);
    recital_part_free(&part);
    x->done++;
    if (x->progress)
        fprintf(stderr, "%u of %u sections, %.0f s\n", x->done, x->sections,
                x->recital.rate ? (double)x->recital.samples / x->recital.rate : 0);
    return stop;
}

static int count_section(void *ctx, const struct section *section) {
    (void)section;
    ((struct exporting *)ctx)->sections++;
    return 0;
}

static void pass_over(void *ctx, const struct error *e, bool serious) {
    (void)ctx;
    (void)e;
    (void)serious;
}

static void tell(void *ctx, const struct error *e, bool serious) {
    struct exporting *x = ctx;
    if (e->place == PLACE_LINE)
        cli_complain("%s:%zu:%zu: %s (%s)", x->file, e->line, e->column, e->message, error_name(e->code));
    else
        cli_complain("%s: %s (%s)", x->file, e->message, error_name(e->code));
    x->failed |= serious;
}

/* The first reading: what is known of the work, and how long it is. -1 after a message. */
static int look(struct exporting *x, const struct settings *settings) {
    const struct work_sink sink = {x, count_section, tell};
    struct library_files files = {0};
    struct error e;
    if (library_files_list(&files, x->folder, &e)) {
        cli_complain_of(&e);
        library_files_free(&files);
        return -1;
    }
    for (size_t i = 0; i < files.count && !x->file; i++) {
        char name[64];
        library_file_name(files.list[i].path, false, name);
        if (!strcmp(name, x->work) || !strcmp(files.list[i].path, x->work)) {
            x->file = mem_strdup(files.list[i].path);
            memcpy(x->name, name, sizeof name);
        }
    }
    library_files_free(&files);
    if (!x->file) {
        cli_complain("there is no work '%s' in %s", x->work, x->folder);
        return -1;
    }
    x->meta.lang = mem_strdup(settings->lang);
    if (work_read(x->folder, x->file, &x->meta, &sink, &e)) {
        tell(x, &e, true);
        return -1;
    }
    if (!x->meta.title)
        x->meta.title = mem_strdup(x->name);
    return library_file_hash(x->folder, x->file, x->hash) ? 0 : -1;
}

/* The recording as a voice; it is aligned as long as that takes. NULL after a message. To be freed. */
static char *with_recording(struct exporting *x, const struct settings *settings) {
    struct settings of_library = *settings;
    struct error e;
    char *config = NULL, *text = NULL;
    of_library.library = x->folder;
    if (!library_file_has_sound(x->folder, x->file)) {
        cli_complain("%s: there is no recording beside it", x->file);
        return NULL;
    }
    if (library_place_voices(&of_library, &config, &e)) {
        cli_complain_of(&e);
        return NULL;
    }
    json_t *all = config ? json_loads(config, 0, NULL) : NULL;
    if (all && !json_object_set_new(json_object_get(all, "recording"), "seconds", json_integer(3600)))
        text = json_dumps(all, JSON_COMPACT);
    json_decref(all);
    free(config);
    if (!text)
        cli_complain("the plugin 'recording' is set up for another folder");
    return text;
}

static int speak(struct exporting *x, const struct settings *settings) {
    const struct work_sink sink = {x, on_section, pass_over};
    struct settings own = *settings;
    struct cli cli = {0};
    struct error e;
    char *config = NULL, voice[80];
    bool recorded = x->voice && !strcmp(x->voice, "recording");
    if (recorded && !(config = with_recording(x, settings)))
        return EXIT_FAILED;
    if (config) {
        own.voices.config = config;
        snprintf(voice, sizeof voice, "recording:%s", x->name);
    }
    if (x->voice)
        x->request.voice = mem_strdup(recorded ? voice : x->voice);
    x->failed |= !x->silent && cli_open(&cli, &own);
    if (!x->failed && !library_export_open(&x->files, &x->meta, x->hash, x->request.fps)) {
        x->recital = (struct recital){.pipeline = &cli.stages.pipeline,
                                      .request = &x->request,
                                      .lang = x->meta.lang,
                                      .any_lang = recorded,
                                      .sentences = x->recital.sentences,
                                      .segment = on_segment,
                                      .problem = on_problem,
                                      .ctx = x};
        struct work_meta again = {.lang = mem_strdup(settings->lang)};
        if (work_read(x->folder, x->file, &again, &sink, &e))
            x->failed = true;
        work_meta_free(&again);
        if (!x->silent && !x->recital.samples) {
            cli_complain("%s: nothing of it could be spoken", x->file);
            x->failed = true;
        }
        x->failed |= library_export_close(&x->files, &x->recital, x->silent || x->recital.samples) != 0;
    } else {
        x->failed = true;
        library_export_close(&x->files, &x->recital, false);
    }
    if (!x->silent)
        cli_close(&cli);
    free(config);
    return x->failed ? EXIT_FAILED : EXIT_DONE;
}

int library_export_main(int argc, char **argv, const struct settings *settings) {
    struct exporting x = {0};
    double rate = 0, fps = 25;
    const struct cli_option options[] = {
        {.name = "epub", .kind = CLI_TEXT, .out = &x.files.epub},
        {.name = "vtt", .kind = CLI_TEXT, .out = &x.files.outputs[EXPORT_VTT].path},
        {.name = "textgrid", .kind = CLI_TEXT, .out = &x.files.outputs[EXPORT_TEXTGRID].path},
        {.name = "fap", .kind = CLI_TEXT, .out = &x.files.outputs[EXPORT_FAP].path},
        {.name = "wav", .kind = CLI_TEXT, .out = &x.files.outputs[EXPORT_WAV].path},
        {.name = "ogg", .kind = CLI_TEXT, .out = &x.files.outputs[EXPORT_OGG].path},
        {.name = "voice", .letter = 'v', .kind = CLI_TEXT, .out = &x.voice},
        {.name = "rate", .letter = 'r', .kind = CLI_NUMBER, .out = &rate, .min = 40, .max = 500},
        {.name = "fps", .kind = CLI_NUMBER, .out = &fps, .min = 1, .max = 120},
        {.name = "sentences", .kind = CLI_FLAG, .out = &x.recital.sentences},
        {.name = "silent", .kind = CLI_FLAG, .out = &x.silent},
        {.name = "progress", .kind = CLI_FLAG, .out = &x.progress},
        {0}};
    int status = cli_options(argc, argv, usage, options, NULL);
    if (status >= 0)
        return status;
    request_init(&x.request);
    x.request.rate = rate;
    x.request.fps = fps;
    x.folder = argc - optind == 2 ? argv[optind] : NULL;
    x.work = x.folder ? argv[optind + 1] : NULL;
    if (!x.folder) {
        cli_complain("library export: a folder and a work are needed");
        status = EXIT_USAGE;
    } else if (!library_export_wanted(&x.files) || (x.silent && !x.files.epub)) {
        cli_complain("library export: say what is to be written, for example --epub FILE");
        status = EXIT_USAGE;
    } else {
        status = look(&x, settings) ? EXIT_FAILED : speak(&x, settings);
    }
    work_meta_free(&x.meta);
    request_free(&x.request);
    free(x.file);
    return status;
}
