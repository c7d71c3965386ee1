/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/files.h"
#include "server/base/mem.h"
#include "server/cli/cli.h"
#include "server/daemon/library_setup.h"
#include "server/export/export.h"
#include "server/library/directions.h"
#include "server/library/faccia_cast.h"
#include "server/library/library_files.h"
#include "server/library/publish/audiobook.h"
#include "server/library/publish/epub_book.h"
#include "server/library/work_lexicons.h"
#include "server/library/works/work.h"
#include <errno.h>
#include <getopt.h>
#include <jansson.h>
#include <stdlib.h>
#include <string.h>

/* ---- faccia library export: output files, written in one pass ---- */

enum { EXPORT_WAV, EXPORT_OGG, EXPORT_FAP, EXPORT_VTT, EXPORT_SRT, EXPORT_TEXTGRID, EXPORT_OUTPUTS };
enum { AUDIOBOOKS = AUDIOBOOK_MP3 + 1 };

/* The caller sets the paths. */
struct library_export_files {
    const char *epub; /* NULL = not requested */
    struct epub_book *book;
    struct library_export_output {
        const char *path; /* NULL = not requested */
        struct cli_file file;
        struct export export;
    } outputs[EXPORT_OUTPUTS];
    struct audiobook *audio; /* of all forms; NULL = not requested */
    struct {
        const char *path; /* NULL = not requested */
        struct cli_file file;
    } audiobooks[AUDIOBOOKS];
};

static bool library_export_wanted(const struct library_export_files *files) {
    bool wanted = files->epub != NULL;
    for (size_t i = 0; i < EXPORT_OUTPUTS; i++)
        wanted |= files->outputs[i].path != NULL;
    for (size_t i = 0; i < AUDIOBOOKS; i++)
        wanted |= files->audiobooks[i].path != NULL;
    return wanted;
}

static int complain(const char *path) {
    cli_complain("%s: %s", path, strerror(errno));
    return -1;
}

/* This and the functions below return nonzero after a message. */
static int library_export_open(struct library_export_files *files, const struct work_meta *meta,
                               const char *hash, double fps) {
    static const char *const names[EXPORT_OUTPUTS] = {"wav", "ogg", "fap", "vtt", "srt", "textgrid"};
    const struct export_source source = {.lang = meta->lang, .fps = fps};
    if (files->epub && !(files->book = epub_book_open(files->epub, meta, hash)))
        return complain(files->epub);
    for (size_t i = 0; i < EXPORT_OUTPUTS; i++) {
        struct library_export_output *o = &files->outputs[i];
        if (o->path && cli_create(&o->file, o->path))
            return -1;
        if (o->path)
            export_begin(&o->export, export_by_name(names[i]), &source);
    }
    for (size_t i = 0; i < AUDIOBOOKS; i++) {
        const char *path = files->audiobooks[i].path;
        if (path && !files->audio && !audiobook_possible()) {
            cli_complain("library export: no ffmpeg in PATH: install Debian's ffmpeg (apt-get install, or sh "
                         "server/run.sh --with film)");
            return -1;
        }
        if (path && !files->audio && !(files->audio = audiobook_open(path)))
            return complain(path);
        if (path && cli_create(&files->audiobooks[i].file, path))
            return -1;
    }
    return 0;
}

static int flush(struct library_export_output *o) {
    struct buf *out = &o->export.out;
    bool well = !out->size || fwrite(out->data, 1, out->size, o->file.file) == out->size;
    out->size = 0;
    return well ? 0 : complain(o->path);
}

static int library_export_segment(struct library_export_files *files, const struct narration *narration,
                                  const struct media_segment *segment, const struct synthesis *speech) {
    if (narration->samples + segment->audio->samples >= UINT32_MAX) {
        cli_complain("this takes more than %.0f hours", (double)UINT32_MAX / narration->rate / 3600);
        return -1;
    }
    if (files->book && epub_book_sound(files->book, segment->audio))
        return complain(files->epub);
    if (files->audio && audiobook_sound(files->audio, segment->audio))
        return complain("the sound");
    for (size_t i = 0; i < EXPORT_OUTPUTS; i++) {
        struct library_export_output *o = &files->outputs[i];
        if (!o->path)
            continue;
        o->export.source.text = synthesis_request(speech)->text;
        o->export.source.markup = synthesis_markup(speech);
        o->export.source.speech = synthesis_has_speakers(speech) ? speech : NULL;
        export_segment(&o->export, segment);
        if (o->export.format->streams && flush(o))
            return -1;
    }
    return 0;
}

static int library_export_section(struct library_export_files *files, const struct section *section,
                                  const struct narration_part *part, uint32_t rate) {
    if (files->audio)
        audiobook_chapter(files->audio, section->title);
    return files->book && epub_book_section(files->book, section, part, rate) ? complain(files->epub) : 0;
}

/* Sets the true length of a seekable file. */
static void finish_wav(struct library_export_output *o) {
    uint8_t header[WAV_HEADER_BYTES];
    if (!o->export.sample_rate || fseek(o->file.file, 0, SEEK_SET))
        return;
    wav_header(header, o->export.sample_rate, o->export.samples);
    fwrite(header, 1, sizeof header, o->file.file);
}

/* Completes the files, or discards them unless `well`. */
static int library_export_close(struct library_export_files *files, const struct narration *narration,
                                const struct work_meta *meta, bool well) {
    char why[200];
    int result = well ? 0 : -1;
    for (size_t i = 0; i < EXPORT_OUTPUTS; i++) {
        struct library_export_output *o = &files->outputs[i];
        bool spoken = well && o->file.file;
        if (spoken) {
            export_end(&o->export);
            spoken = !flush(o);
        }
        if (spoken && i == EXPORT_WAV)
            finish_wav(o);
        if (cli_finish(&o->file, spoken) && well)
            result = -1;
        export_free(&o->export);
    }
    for (size_t i = 0; i < AUDIOBOOKS; i++) {
        struct cli_file *file = &files->audiobooks[i].file;
        bool coded = well && file->file;
        int failed =
            coded ? audiobook_write(files->audio, (enum audiobook_form)i, meta, fileno(file->file)) : 0;
        if (failed < 0)
            complain(files->audiobooks[i].path);
        else if (failed)
            cli_complain("%s: ffmpeg could not write it", files->audiobooks[i].path);
        if (failed || (cli_finish(file, coded) && well))
            result = -1;
    }
    audiobook_free(files->audio);
    files->audio = NULL;
    if (!well) {
        epub_book_free(files->book);
    } else if (files->book && epub_book_close(files->book, narration->voice, why)) {
        cli_complain("%s: %s", files->epub, why);
        result = -1;
    }
    files->book = NULL;
    return result;
}

static const char usage[] =
    "Usage: faccia library export [OPTION]... DIR WORK\n"
    "Speaks a work of the folder DIR, and writes the result to files. WORK is its id, as listed by 'faccia "
    "library DIR', or its file.\n"
    "\n"
    "      --epub FILE      a read-aloud book (EPUB 3 with media overlays)\n"
    "      --vtt FILE       captions with word times (WebVTT)\n"
    "      --srt FILE       captions without word times (SubRip)\n"
    "      --textgrid FILE  sentences, words and phones, for Praat\n"
    "      --fap FILE       the face, as MPEG-4 FAPs (text, version 2.1)\n"
    "      --wav FILE       the sound, mono, 16 bits\n"
    "      --ogg FILE       the sound, as Opus in Ogg\n"
    "      --m4b FILE       an audiobook with chapters (AAC); --mp3 FILE as MP3; both need ffmpeg\n"
    "  -v, --voice ID       a voice listed by 'faccia voices', or 'recording': the one beside the work (of "
    "a\n"
    "                       play: the voices that 'faccia library cast' shows)\n"
    "  -r, --rate WPM       words per minute, 40 to 500\n"
    "      --fps N          FAP frames per second, 1 to 120 (25)\n"
    "      --dialogue       who is named, or two in turn, speaks what prose has in quotation marks\n"
    "      --sentences      highlight sentences and lines in the book instead of words\n"
    "      --silent         make a book without sound\n"
    "      --progress       report progress on standard error\n"
    "  -h, --help           print this and exit\n"
    "Exit status: 0 done, 1 something could not be spoken or written, 2 wrong usage.\n";

struct exporting {
    struct library_export_files files;
    struct narration narration;
    struct speech_request request;
    const char *folder, *work, *voice;
    bool silent, progress, failed;
    char *file, name[64], hash[65];
    struct work_meta meta;
    unsigned sections, done;
};

static int on_segment(void *ctx, const struct media_segment *segment, const struct synthesis *speech) {
    struct exporting *x = ctx;
    return library_export_segment(&x->files, &x->narration, segment, speech);
}

static void on_problem(void *ctx, const struct error *e, bool warning) {
    struct exporting *x = ctx;
    char text[400];
    cli_complain("%s%s", warning ? "warning: " : "", error_text(e, text, sizeof text));
    x->failed |= !warning;
}

static int on_section(void *ctx, const struct section *section) {
    struct exporting *x = ctx;
    struct narration_part part = {0};
    if (x->silent)
        narration_find_speeches(&x->narration, section, &part);
    else
        narration_section(&x->narration, section, &part);
    int stop = x->narration.stopped || library_export_section(&x->files, section, &part, x->narration.rate);
    narration_part_free(&part);
    x->done++;
    if (x->progress)
        fprintf(stderr, "%u of %u sections, %.0f s\n", x->done, x->sections,
                x->narration.rate ? (double)x->narration.samples / x->narration.rate : 0);
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

/* First pass: reads metadata and length of the work. -1 after a message. */
static int look(struct exporting *x, const struct settings *settings) {
    const struct work_sink sink = {x, count_section, tell};
    struct library_files files = {0};
    struct error e;
    if (library_files_list(&files, x->folder, &e)) {
        cli_complain_of(&e);
        library_files_free(&files);
        return -1;
    }
    const char *file = library_files_work(&files, x->work);
    if (file) {
        x->file = mem_strdup(file);
        library_file_name(file, false, x->name);
    }
    library_files_free(&files);
    if (!x->file) {
        cli_complain("unknown work '%s' in %s", x->work, x->folder);
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

/* Makes the recording a voice, and waits for its alignment. NULL after a message. Free it. */
static char *with_recording(struct exporting *x, const struct settings *settings) {
    struct settings of_library = *settings;
    struct error e;
    char *config = NULL, *text = NULL;
    of_library.library = x->folder;
    if (!library_file_has_sound(x->folder, x->file)) {
        cli_complain("%s: there is no recording beside it", x->file);
        return NULL;
    }
    if (library_setup_voices(&of_library, &config, &e)) {
        cli_complain_of(&e);
        return NULL;
    }
    json_t *all = config ? json_loads(config, 0, NULL) : NULL;
    if (all && !json_object_set_new(json_object_get(all, "recording"), "seconds", json_integer(3600)))
        text = json_dumps(all, JSON_COMPACT);
    json_decref(all);
    free(config);
    if (!text)
        cli_complain("the plugin 'recording' is configured for another folder");
    return text;
}

static int speak(struct exporting *x, const struct settings *settings) {
    const struct work_sink sink = {x, on_section, pass_over};
    struct settings own = *settings;
    struct cli cli = {0};
    struct error e;
    struct lexicons lexicons = {0};
    struct cast cast = {0};
    struct directions *directions = NULL;
    char *config = NULL, voice[80], moods[4200];
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
    if (!x->failed && library_lexicons_beside(x->folder, x->file, &lexicons, &e)) {
        cli_complain_of(&e);
        x->failed = true;
    }
    if (!x->failed && !x->silent && cast_of_file(x->folder, x->file, &cli, settings, &cast, &e)) {
        cli_complain_of(&e);
        x->failed = true;
    }
    snprintf(moods, sizeof moods, "%s/directions", settings->models);
    if (!x->failed && !x->silent && !(directions = directions_load(moods, &e))) {
        cli_complain_of(&e);
        x->failed = true;
    }
    if (!x->failed && !library_export_open(&x->files, &x->meta, x->hash, x->request.fps)) {
        x->narration = (struct narration){.pipeline = &cli.components.pipeline,
                                          .request = &x->request,
                                          .lexicons = &lexicons,
                                          .lang = x->meta.lang,
                                          .cast = &cast,
                                          .cast_voices = !x->voice,
                                          .directions = directions,
                                          .any_lang = recorded,
                                          .sentences = x->narration.sentences,
                                          .segment = on_segment,
                                          .problem = on_problem,
                                          .ctx = x};
        struct work_meta again = {.lang = mem_strdup(settings->lang)};
        if (work_read(x->folder, x->file, &again, &sink, &e))
            x->failed = true;
        work_meta_free(&again);
        if (!x->silent && !x->narration.samples) {
            cli_complain("%s: nothing of it could be spoken", x->file);
            x->failed = true;
        }
        x->failed |=
            library_export_close(&x->files, &x->narration, &x->meta, x->silent || x->narration.samples) != 0;
    } else {
        x->failed = true;
        library_export_close(&x->files, &x->narration, &x->meta, false);
    }
    if (!x->silent)
        cli_close(&cli);
    cast_free(&cast);
    directions_free(directions);
    lexicons_free(&lexicons);
    free(config);
    return x->failed ? EXIT_FAILED : EXIT_DONE;
}

/* faccia library export: writes a work with its sound to files. argv[0] is "export". Returns an exit code. */
static int library_export_main(int argc, char **argv, const struct settings *settings) {
    struct exporting x = {0};
    double rate = 0, fps = 25;
    bool dialogue = false;
    const struct cli_option options[] = {
        {.name = "epub", .kind = CLI_TEXT, .out = &x.files.epub},
        {.name = "vtt", .kind = CLI_TEXT, .out = &x.files.outputs[EXPORT_VTT].path},
        {.name = "srt", .kind = CLI_TEXT, .out = &x.files.outputs[EXPORT_SRT].path},
        {.name = "m4b", .kind = CLI_TEXT, .out = &x.files.audiobooks[AUDIOBOOK_M4B].path},
        {.name = "mp3", .kind = CLI_TEXT, .out = &x.files.audiobooks[AUDIOBOOK_MP3].path},
        {.name = "textgrid", .kind = CLI_TEXT, .out = &x.files.outputs[EXPORT_TEXTGRID].path},
        {.name = "fap", .kind = CLI_TEXT, .out = &x.files.outputs[EXPORT_FAP].path},
        {.name = "wav", .kind = CLI_TEXT, .out = &x.files.outputs[EXPORT_WAV].path},
        {.name = "ogg", .kind = CLI_TEXT, .out = &x.files.outputs[EXPORT_OGG].path},
        {.name = "voice", .letter = 'v', .kind = CLI_TEXT, .out = &x.voice},
        {.name = "rate", .letter = 'r', .kind = CLI_NUMBER, .out = &rate, .min = 40, .max = 500},
        {.name = "fps", .kind = CLI_NUMBER, .out = &fps, .min = 1, .max = 120},
        {.name = "dialogue", .kind = CLI_FLAG, .out = &dialogue},
        {.name = "sentences", .kind = CLI_FLAG, .out = &x.narration.sentences},
        {.name = "silent", .kind = CLI_FLAG, .out = &x.silent},
        {.name = "progress", .kind = CLI_FLAG, .out = &x.progress},
        {0}};
    int status = cli_options(argc, argv, usage, options, NULL);
    if (status >= 0)
        return status;
    request_init(&x.request);
    x.request.rate = rate;
    x.request.fps = fps;
    x.request.dialogue = dialogue ? DIALOGUE_VOICES : DIALOGUE_ONE_VOICE;
    x.folder = argc - optind == 2 ? argv[optind] : NULL;
    x.work = x.folder ? argv[optind + 1] : NULL;
    if (!x.folder) {
        cli_complain("library export: a folder and a work are needed");
        status = EXIT_USAGE;
    } else if (!library_export_wanted(&x.files) || (x.silent && !x.files.epub)) {
        cli_complain("library export: name an output, for example --epub FILE");
        status = EXIT_USAGE;
    } else {
        status = look(&x, settings) ? EXIT_FAILED : speak(&x, settings);
    }
    work_meta_free(&x.meta);
    request_free(&x.request);
    free(x.file);
    return status;
}

/* faccia library: reads a folder of works as the daemon would, and reports the result. */

struct checking {
    const char *path;
    size_t sections, passages, characters, serious, light;
    bool words;                  /* compare the words read with those of the source */
    struct words_report counted; /* sums */
};

static int add_section(void *ctx, const struct section *section) {
    struct checking *c = ctx;
    c->sections++;
    c->passages += section->passages;
    c->characters += section->characters;
    return 0;
}

/* FILE:LINE:COLUMN: message (code), as compilers print it. */
static void print_problem(const char *path, const struct error *e) {
    if (e->place == PLACE_LINE)
        printf("%s:%zu:%zu: %s (%s)\n", path, e->line, e->column, e->message, error_name(e->code));
    else
        printf("%s: %s (%s)\n", path, e->message, error_name(e->code));
}

static void report_problem(void *ctx, const struct error *e, bool serious) {
    struct checking *c = ctx;
    c->serious += serious;
    c->light += !serious;
    print_problem(c->path, e);
}

static void report_word(void *ctx, const char *what, size_t line, const char *word, const char *next) {
    const struct checking *c = ctx;
    if (line)
        printf("%s:%zu: %s: \"%s\" before \"%s\"\n", c->path, line, what, word, next);
    else
        printf("%s: %s: \"%s\" before \"%s\"\n", c->path, what, word, next);
}

static void print_words(const char *name, const struct words_report *w) {
    printf(
        "%s: %zu words in the source, %zu read, %zu left out on purpose: %zu lost, %zu doubled, %zu glued, "
        "%zu divided\n",
        name, w->source, w->read, w->left_out, w->lost, w->doubled, w->glued, w->divided);
}

/* Compares the words of a work with those of its source, except for texts in a markup of speech. */
static void check_words(struct checking *all, struct checking *c, const char *folder, const char *format) {
    struct words_report w = {.tell = report_word, .ctx = c}, *sum = &all->counted;
    struct error e;
    if (format && strcmp(format, "tei") != 0 && strcmp(format, "epub") != 0 &&
        strcmp(format, "markdown") != 0 && strcmp(format, "text") != 0)
        return;
    if (words_check(folder, c->path, &w, &e)) {
        c->serious++;
        print_problem(c->path, &e);
        return;
    }
    print_words(c->path, &w);
    sum->source += w.source;
    sum->read += w.read;
    sum->left_out += w.left_out;
    sum->lost += w.lost;
    sum->doubled += w.doubled;
    sum->glued += w.glued;
    sum->divided += w.divided;
    c->serious += w.lost || w.doubled || w.glued || w.divided;
}

static void check(struct checking *all, const char *folder, const char *path, const char *lang) {
    struct checking c = {.path = path};
    const struct work_sink sink = {&c, add_section, report_problem};
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
    if (all->words && c.sections)
        check_words(all, &c, folder, meta.format);
    all->sections += c.sections > 0;
    all->passages += c.passages;
    all->characters += c.characters;
    all->serious += c.serious;
    all->light += c.light;
    work_meta_free(&meta);
}

static void check_cast(struct checking *all, const char *folder, const char *path) {
    FILE *file = open_file_below(folder, path);
    struct buf text = {0};
    struct error e;
    int bad = file ? buf_add_stream(&text, file, CAST_FILE_BYTES) : errno;
    if (bad)
        error_set(&e, ERROR_BAD_CAST, "%s", strerror(bad));
    if (bad || cast_check(text.data, text.size, &e)) {
        char said[400];
        printf("%s: %s (%s)\n", path, error_text(&e, said, sizeof said), error_name(e.code));
        all->serious++;
    }
    buf_free(&text);
    if (file)
        fclose(file);
}

int library_main(int argc, char **argv, const struct settings *settings) {
    static const char usage[] =
        "Usage: faccia library [check] [--words] DIR\n"
        "       faccia library cast [--json] FILE\n"
        "       faccia library export [OPTION]... DIR WORK\n"
        "Reads the works of a folder (TEI, EPUB, Markdown, text, APML, JSML, SSML), and prints their "
        "contents and\n"
        "problems, with file, line and column. Exits with 1 if something could not be read.\n"
        "\n"
        "      --words  compare the words read with the words of the source, which a second reader counts\n"
        "               independently; report those that are lost, doubled, glued to the next, or divided\n"
        "\n"
        "cast shows who speaks in a play or a dialogue, and how: see faccia library cast --help\n"
        "export writes a work as a read-aloud book, captions, and more: see faccia library export --help\n";
    struct checking all = {0};
    const struct cli_option options[] = {{.name = "words", .kind = CLI_FLAG, .out = &all.words}, {0}};
    struct library_files files = {0};
    struct error e;
    if (argc > 1 && !strcmp(argv[1], "export"))
        return library_export_main(argc - 1, argv + 1, settings);
    if (argc > 1 && !strcmp(argv[1], "cast"))
        return library_cast_main(argc - 1, argv + 1, settings);
    if (argc > 1 && !strcmp(argv[1], "check")) {
        argc--;
        argv++;
    }
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
    for (size_t i = 0; i < files.cast_count; i++)
        check_cast(&all, argv[optind], files.casts[i].path);
    if (all.words)
        print_words("all", &all.counted);
    printf("%zu works, %zu passages, %zu bytes; %zu problems, %zu hints\n", all.sections, all.passages,
           all.characters, all.serious, all.light);
    library_files_free(&files);
    return all.serious ? EXIT_FAILED : EXIT_DONE;
}
