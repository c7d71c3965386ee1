/* SPDX-License-Identifier: GPL-3.0-or-later */
/* faccia film: speaks a text, or takes a recorded face, and films the head that the page would show. */
#include "server/base/mem.h"
#include "server/base/program.h"
#include "server/cli/cli_head.h"
#include "server/cli/film_options.h"
#include "server/face/high_level.h"
#include "server/film/film_browser.h"
#include "server/film/film_folder.h"
#include "server/film/film_jobs.h"
#include "server/film/film_media.h"
#ifdef HAVE_LIBRARY
#include "server/library/faccia_passage.h"
#endif
#include "server/synthesis/recording.h"
#include <errno.h>
#include <jansson.h>
#include <libgen.h>
#include <limits.h>
#include <math.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { SIGNALS = 3, GIF_BYTES_MAX = 1 << 30 };

struct film {
    const struct settings *settings;
    struct cli cli;
    struct film_options o;
    /* speaking */
    struct synthesis *synthesis;
    struct recording *recording;
    struct film_media media;
    bool begun, spoken, too_long;
    /* filming */
    struct film_browser *browser;
    struct film_coder *coder;
    struct cli_file file;
    uv_signal_t signals[SIGNALS];
    struct buf sheet;            /* filter that makes one picture of all */
    struct film_folder folder;   /* for what the programs need */
    struct film_folder pictures; /* unfinished ones, beside the finished ones */
    unsigned count, drawn;       /* pictures */
    uint64_t start, told;        /* loop time, ms */
    int signal;                  /* that has ended the film; 0: none */
    bool finished, failed;
};

/* Looks for a browser and ffmpeg. If one is missing, prints how to install it. */
static int check_programs(void) {
    bool browser = film_browser_found(), coder = film_coder_found();
    if (browser && coder)
        return 0;
    cli_complain(
        "film: no %s in PATH: install Debian's %s%s%s (apt-get install, or sh server/run.sh --with film)",
        browser ? "ffmpeg"
        : coder ? "browser"
                : "browser and no ffmpeg",
        browser ? "" : "chromium-headless-shell", browser || coder ? "" : " and ", coder ? "" : "ffmpeg");
    return -1;
}

/* Speaking */

static void on_segment(void *ctx, struct media_segment segment) {
    struct film *f = ctx;
    if (f->synthesis)
        f->media.captions.source.text = synthesis_request(f->synthesis)->text;
    f->too_long |= !film_media_add(&f->media, &segment,
                                   f->recording ? recording_fps(f->recording) : f->media.faces.source.fps);
    media_segment_free(&segment);
    if (f->too_long)
        f->spoken = true; /* no more is wanted */
    else if (f->recording)
        recording_release(f->recording);
    else
        synthesis_release(f->synthesis);
}

static void on_problem(void *ctx, const struct error *e, bool warning) {
    struct film *f = ctx;
    char text[400];
    cli_complain("%s%s%s", warning ? "warning: " : "", f->o.from ? "--from: " : "",
                 error_text(e, text, sizeof text));
    f->failed |= !warning;
}

static void on_finished(void *ctx, size_t spoken) {
    struct film *f = ctx;
    f->spoken = true;
    f->failed |= !spoken;
}

static const struct synthesis_callbacks callbacks = {on_segment, on_problem, on_finished};

static int speak(struct film *f, const struct speech_request *request) {
    struct error e;
    char message[400];
    if (cli_open(&f->cli, cli_lexicons_with(&f->o.lexicons, f->settings)))
        return EXIT_FAILED;
    if (f->o.audio)
        f->cli.components.pipeline.sounds = f->o.audio;
    f->synthesis = synthesis_open(&f->cli.components.pipeline, request, &callbacks, f, &e);
    if (!f->synthesis) {
        cli_complain("%s", error_text(&e, message, sizeof message));
        return e.place == PLACE_FIELD ? EXIT_USAGE : EXIT_FAILED;
    }
    const struct export_source source = export_source_of(f->synthesis);
    film_media_begin(&f->media, &source);
    f->begun = true;
    synthesis_start(f->synthesis);
    while (!f->spoken && uv_run(&f->cli.loop, UV_RUN_ONCE))
        ;
    film_media_end(&f->media);
    synthesis_free(f->synthesis);
    f->synthesis = NULL;
    return EXIT_DONE;
}

#ifdef HAVE_LIBRARY

static int on_passage(void *ctx, const struct media_segment *segment, const struct synthesis *speech) {
    struct film *f = ctx;
    struct export_source *words = &f->media.captions.source;
    words->text = synthesis_request(speech)->text;
    words->markup = synthesis_markup(speech);
    words->speech = synthesis_has_speakers(speech) ? speech : NULL;
    f->too_long |= !film_media_add(&f->media, segment, f->media.faces.source.fps);
    return f->too_long;
}

static int speak_passage(struct film *f, struct speech_request *request) {
    const struct export_source source = {.text = "", .fps = request->fps};
    const struct passage_speaking speaking = {.folder = f->o.library,
                                              .passage = f->o.passage,
                                              .request = request,
                                              .segment = on_passage,
                                              .problem = on_problem,
                                              .ctx = f};
    if (cli_open(&f->cli, cli_lexicons_with(&f->o.lexicons, f->settings)))
        return EXIT_FAILED;
    film_media_begin(&f->media, &source);
    f->begun = true;
    int failed = passage_speak(&speaking, &f->cli, f->settings);
    film_media_end(&f->media);
    if (!failed && !f->failed && !film_media_faces(&f->media)) {
        cli_complain("--passage: nothing of '%s' could be spoken", f->o.passage);
        return EXIT_FAILED;
    }
    return failed ? EXIT_FAILED : EXIT_DONE;
}

#else

static int speak_passage(struct film *f, struct speech_request *request) {
    (void)f, (void)request; /* film_options_read refuses it */
    return EXIT_USAGE;
}

#endif

static int read_recording(struct film *f) {
    struct recording_source source = {.name = mem_strdup(f->o.from),
                                      .fap_path = mem_strdup(f->o.from),
                                      .sound_path = f->o.audio ? mem_strdup(f->o.audio) : NULL,
                                      .fap_bytes_max = (size_t)1 << 30};
    const struct export_source origin = {.play = f->o.from};
    uv_loop_init(&f->cli.loop);
    if (cli_load(&f->cli.components, f->settings, COMPONENTS_SPEECH | COMPONENTS_EXPRESSIONS, &f->cli.loop)) {
        recording_source_free(&source);
        return EXIT_FAILED;
    }
    film_media_begin(&f->media, &origin);
    f->begun = true;
    f->recording = recording_open(&f->cli.loop, f->cli.components.pipeline.high_level, NULL, NULL, &source,
                                  &callbacks, f);
    recording_start(f->recording);
    while (!f->spoken && uv_run(&f->cli.loop, UV_RUN_ONCE))
        ;
    film_media_end(&f->media);
    recording_free(f->recording);
    f->recording = NULL;
    return f->o.words && cli_read(f->o.words, &f->media.captions.out) ? EXIT_FAILED : EXIT_DONE;
}

/* A face for each viseme of FAP 1 that the language has, and the filter that labels and arranges them. */
static int pose_visemes(struct film *f) {
    enum { VISEMES = 15, ACROSS = 5 };
    const struct export_source source = {.fps = 1};
    uv_loop_init(&f->cli.loop);
    if (cli_load(&f->cli.components, f->settings, COMPONENTS_SPEECH | COMPONENTS_EXPRESSIONS, &f->cli.loop))
        return EXIT_FAILED;
    const struct speech_pack *pack = speech_packs_find(&f->cli.components.packs, f->o.visemes);
    if (!pack || (speech_pack_is_general(pack) && strcmp(f->o.visemes, SPEECH_PACK_GENERAL) != 0)) {
        cli_complain("--visemes: no mouth shapes for the language '%s'", f->o.visemes);
        return EXIT_FAILED;
    }
    struct face_high_level *high = face_high_level_new(pack, f->cli.components.pipeline.expressions);
    film_media_begin(&f->media, &source);
    f->begun = true;
    for (uint8_t i = 0; i < VISEMES; i++) {
        const struct fap_frame alone = {.mask = {1}, .viseme = {.select1 = i, .blend = 63}};
        struct fap_frame frame = alone;
        face_high_level_expand(high, &frame, 1);
        if (i && !memcmp(frame.mask, alone.mask, sizeof alone.mask))
            continue; /* the language has no such sound */
        buf_printf(&f->sheet, "drawtext=font=sans:fontsize=h/10:x=h/20:y=h/20:text=%s:enable=eq(n\\,%u),",
                   export_viseme_names[i], film_media_faces(&f->media));
        film_media_add_face(&f->media, &frame);
    }
    face_high_level_free(high);
    unsigned count = film_media_faces(&f->media), across = count < ACROSS ? count : ACROSS;
    buf_printf(&f->sheet, "tile=%ux%u", across, (count + across - 1) / across);
    buf_add(&f->sheet, "", 1);
    return EXIT_DONE;
}

static int pose_expression(struct film *f) {
    const struct export_source source = {.fps = 1};
    struct fap_frame frame = {0};
    uv_loop_init(&f->cli.loop);
    if (cli_load(&f->cli.components, f->settings, COMPONENTS_EXPRESSIONS, &f->cli.loop) ||
        cli_pose(f->cli.components.pipeline.expressions, "--expression", f->o.expression, &frame))
        return EXIT_FAILED;
    film_media_begin(&f->media, &source);
    f->begun = true;
    film_media_add_face(&f->media, &frame);
    return EXIT_DONE;
}

/* Files */

static int write_file(const struct film *f, const char *name, const struct buf *bytes) {
    char path[PATH_MAX];
    if (!bytes->size)
        return 0;
    snprintf(path, sizeof path, "%s/%s", f->folder.path, name);
    FILE *file = fopen(path, "wbx");
    bool well = file && fwrite(bytes->data, 1, bytes->size, file) == bytes->size;
    well = file && !fclose(file) && well;
    if (!well)
        cli_complain("%s: %s", path, strerror(errno));
    return well ? 0 : -1;
}

/* Numbered pictures appear together, when all are there. */
static int open_pictures(struct film *f) {
    char folder[PATH_MAX], place[PATH_MAX], prefix[PATH_MAX + 32];
    snprintf(folder, sizeof folder, "%s", f->o.output);
    if (realpath(dirname(folder), place)) {
        snprintf(prefix, sizeof prefix, "%s/.faccia-film", place);
        if (!film_folder_make(&f->pictures, prefix))
            return 0;
    }
    cli_complain("%s: %s", f->o.output, strerror(errno));
    return -1;
}

static int publish_one(const struct film *f, const char *from, const char *to) {
    char path[2 * PATH_MAX];
    snprintf(path, sizeof path, "%s/%s", f->pictures.path, from);
    if (!rename(path, to))
        return 0;
    cli_complain("%s: %s", to, strerror(errno));
    return -1;
}

/* Names the sound after the pictures: hello.wav for hello-%05d.png. */
static void sound_name(const char *pattern, char out[PATH_MAX]) {
    size_t length;
    int before = (int)(film_numbered(pattern, &length) - pattern);
    while (before && strchr("-_. ", pattern[before - 1]))
        before--;
    bool named = before && pattern[before - 1] != '/';
    snprintf(out, PATH_MAX, "%.*s%s.wav", before, pattern, named ? "" : "sound");
}

static int publish_pictures(const struct film *f) {
    char name[32], to[PATH_MAX];
    size_t length;
    const char *number = film_numbered(f->o.output, &length);
    int width = atoi(number + 1);
    for (unsigned k = 1; k <= f->count; k++) {
        snprintf(name, sizeof name, "%u.png", k);
        snprintf(to, sizeof to, "%.*s%0*u%s", (int)(number - f->o.output), f->o.output, width, k,
                 number + length);
        if (publish_one(f, name, to))
            return -1;
    }
    if (!f->media.sound.out.size)
        return 0;
    sound_name(f->o.output, to);
    struct cli_file sound;
    if (cli_create(&sound, to))
        return -1;
    const struct buf *wav = &f->media.sound.out;
    return cli_finish(&sound, fwrite(wav->data, 1, wav->size, sound.file) == wav->size);
}

/* Filming */

static void tell(struct film *f) {
    enum { EVERY_MS = 200, PARTS = 10, LEAST = 20 };
    uint64_t now = uv_now(&f->cli.loop);
    unsigned part = f->count / PARTS ? f->count / PARTS : 1;
    if (f->count < LEAST ||
        (isatty(STDERR_FILENO) ? now < f->told + EVERY_MS && f->drawn < f->count : f->drawn % part))
        return;
    f->told = now;
    fprintf(stderr,
            isatty(STDERR_FILENO) ? "\r  %3u %%  picture %u of %u%s" : "  %u %%: picture %u of %u\n%s",
            100 * f->drawn / f->count, f->drawn, f->count,
            isatty(STDERR_FILENO) && f->drawn == f->count ? "\n" : "");
}

static void fail(struct film *f, const struct error *e) {
    char text[400];
    if (isatty(STDERR_FILENO) && f->drawn && f->drawn < f->count)
        fputc('\n', stderr);
    cli_complain("film: %s", error_text(e, text, sizeof text));
    f->failed = f->finished = true;
}

static void on_picture(void *ctx, struct buf *pixels) {
    struct film *f = ctx;
    film_coder_add(f->coder, pixels);
    f->drawn++;
    tell(f);
    if (f->drawn == f->count)
        film_coder_finish(f->coder);
}

static void on_failed(void *ctx, const struct error *e) {
    fail(ctx, e);
}

static void on_taken(void *ctx) {
    struct film *f = ctx;
    film_browser_taken(f->browser);
}

static void on_coded(void *ctx, const struct error *problem) {
    struct film *f = ctx;
    if (problem)
        fail(f, problem);
    f->finished = true;
}

static void on_signal(uv_signal_t *signal, int number) {
    struct film *f = signal->data;
    f->signal = number;
    f->finished = f->failed = true;
}

static void watch_signals(struct film *f) {
    static const int numbers[SIGNALS] = {SIGINT, SIGTERM, SIGHUP};
    for (int i = 0; i < SIGNALS; i++) {
        uv_signal_init(&f->cli.loop, &f->signals[i]);
        f->signals[i].data = f;
        uv_signal_start(&f->signals[i], on_signal, numbers[i]);
    }
}

static int write_files(struct film *f) {
    static const char prefix[] = "/tmp/faccia-film";
    if (film_folder_make(&f->folder, prefix)) {
        cli_complain("%s: %s", prefix, strerror(errno));
        return -1;
    }
    return write_file(f, "sound.wav", &f->media.sound.out) ||
                   write_file(f, "captions.vtt", &f->media.captions.out)
               ? -1
           : f->o.format == FILM_PICTURES ? open_pictures(f)
                                          : cli_create(&f->file, f->o.output);
}

static int start(struct film *f, const char *head, const char *partner, double fps,
                 const struct speech_request *request) {
    static const struct film_browser_calls browser_calls = {on_picture, on_failed};
    static const struct film_coder_calls coder_calls = {on_taken, on_coded};
    bool plain = f->o.format == FILM_GIF || f->o.visemes; /* few colours; many small faces */
    bool file = f->o.background && !f->o.transparent && !access(f->o.background, R_OK);
    char pattern[PATH_MAX + 16];
    struct error e;
    snprintf(pattern, sizeof pattern, "%s/%%d.png", f->pictures.path ? f->pictures.path : "");
    const struct film_coding coding = {.format = f->o.format,
                                       .width = f->o.width,
                                       .height = f->o.height,
                                       .fps = fps,
                                       .transparent = f->o.transparent,
                                       .lossless = f->o.lossless,
                                       .folder = f->folder.path,
                                       .sound = (f->o.format == FILM_MP4 || f->o.format == FILM_WEBM) &&
                                                f->media.sound.samples,
                                       .captions = f->o.captions,
                                       .file = f->file.file ? fileno(f->file.file) : -1,
                                       .pattern = pattern,
                                       .filter = (char *)f->sheet.data};
    const struct film_scene scene = {.web = f->settings->api.web,
                                     .head = head,
                                     .partner = partner,
                                     .folder = f->folder.path,
                                     .width = f->o.width,
                                     .height = f->o.height,
                                     .level = f->o.level ? f->o.level : "fine",
                                     .view = f->o.view,
                                     .colour = f->o.transparent || file ? NULL
                                               : f->o.background        ? f->o.background
                                               : plain                  ? "#dfe3e8"
                                                                        : "room",
                                     .image = file ? f->o.background : NULL,
                                     .faces = &f->media.faces.out,
                                     .words = &f->media.captions.out,
                                     .still = request->still || f->o.visemes || f->o.expression,
                                     .shows = f->o.shows,
                                     .life = request->life < 0 ? 1 : fmin(1, request->life),
                                     .rate = f->media.faces.fps,
                                     .fps = fps,
                                     .start = f->o.at > 0 ? f->o.at : 0,
                                     .count = f->count};
    f->coder = film_coder_new(&f->cli.loop, &coder_calls, f);
    f->browser = film_browser_new(&f->cli.loop, &browser_calls, f);
    if (!film_coder_start(f->coder, &coding, &e) && !film_browser_start(f->browser, &scene, &e))
        return 0;
    fail(f, &e);
    return -1;
}

/* Number of pictures; 0 after a message. */
static unsigned count_pictures(const struct film *f, double fps) {
    double seconds = film_media_faces(&f->media) / f->media.faces.fps;
    if (f->too_long) {
        cli_complain("film: the text takes longer than %d minutes", FILM_SECONDS_MAX / 60);
        return 0;
    }
    if (f->o.at >= seconds) {
        cli_complain("--at: %g is after the end, at %g seconds", f->o.at, seconds);
        return 0;
    }
    unsigned count = f->o.at >= 0                ? 1
                     : fps == f->media.faces.fps ? film_media_faces(&f->media)
                                                 : (unsigned)ceil(seconds * fps - 1e-9);
    if (f->o.format == FILM_GIF && (double)count * f->o.width * f->o.height * 4 > GIF_BYTES_MAX) {
        cli_complain("film: %u pictures of this size are too many for a GIF: make it smaller, or a .webm",
                     count);
        return 0;
    }
    return count;
}

static int shoot(struct film *f, const char *head, const char *partner,
                 const struct speech_request *request) {
    bool sheet = f->o.visemes != NULL;
    f->o.width = f->o.width ? f->o.width : sheet ? 240 : 640;
    f->o.height = f->o.height ? f->o.height : sheet ? 240 : 480;
    double fps = sheet || f->o.expression       ? f->media.faces.fps
                 : f->o.from && !f->o.fps_given ? f->media.faces.fps
                                                : request->fps;
    f->count = count_pictures(f, fps);
    if (!f->count)
        return EXIT_FAILED;
    watch_signals(f);
    if (!write_files(f) && !start(f, head, partner, fps, request)) {
        while (!f->finished && uv_run(&f->cli.loop, UV_RUN_ONCE))
            ;
        if (!f->failed && f->o.format == FILM_PICTURES)
            f->failed = publish_pictures(f) != 0;
    } else {
        f->failed = true;
    }
    film_browser_close(f->browser);
    film_coder_close(f->coder);
    for (int i = 0; i < SIGNALS; i++)
        uv_close((uv_handle_t *)&f->signals[i], NULL);
    uv_run(&f->cli.loop, UV_RUN_DEFAULT);
    film_browser_free(f->browser);
    film_coder_free(f->coder);
    f->failed |= cli_finish(&f->file, !f->failed) != 0;
    film_folder_remove(&f->pictures);
    film_folder_remove(&f->folder);
    return f->failed ? EXIT_FAILED : EXIT_DONE;
}

/* Finds what is filmed, and the voice that suits it. -1 after a message. */
static int cast(struct film *f, struct speech_request *request, char head[PATH_MAX], char partner[PATH_MAX]) {
    if (f->o.pictures) {
        snprintf(head, PATH_MAX, "%s", f->o.pictures);
        return cli_pictures_check("--pictures", head);
    }
    json_t *model = cli_head_find(f->settings, "--model", f->o.model, head);
    json_t *other =
        model && f->o.partner ? cli_head_find(f->settings, "--partner", f->o.partner, partner) : NULL;
    bool found = model && (other || !f->o.partner);
    if (found)
        cli_head_suit(request, model);
    if (found && f->o.as_pictures)
        found = !cli_head_pictures(f->settings, model, head) &&
                (!other || !cli_head_pictures(f->settings, other, partner));
    json_decref(model);
    json_decref(other);
    return found ? 0 : -1;
}

static int run(struct film *f, struct speech_request *request) {
    char head[PATH_MAX] = "", partner[PATH_MAX] = "";
    if (check_programs() || cast(f, request, head, partner))
        return EXIT_FAILED;
    int status = f->o.visemes      ? pose_visemes(f)
                 : f->o.expression ? pose_expression(f)
                 : f->o.from       ? read_recording(f)
                 : f->o.library    ? speak_passage(f, request)
                                   : speak(f, request);
    components_stop_voices(&f->cli.components);
    uv_run(&f->cli.loop, UV_RUN_DEFAULT);
    if (!status)
        status = f->failed ? EXIT_FAILED : shoot(f, head, f->o.partner ? partner : NULL, request);
    if (f->begun)
        film_media_free(&f->media);
    buf_free(&f->sheet);
    uv_loop_close(&f->cli.loop);
    components_free(&f->cli.components);
    return status;
}

int film_main(int argc, char **argv, const struct settings *settings) {
    struct film f = {.settings = settings, .o.at = -1};
    struct speech_request request;
    struct buf text = {0};
    if (getenv(FILM_JOB_VARIABLE))
        program_end_with_parent(STDIN_FILENO, SIGTERM); /* as a user ends it, so that nothing is left */
    request_init(&request);
    int status = film_options_read(argc, argv, &f.o, &request, &text);
    if (status < 0)
        status = run(&f, &request);
    cli_lexicons_free(&f.o.lexicons);
    request_free(&request);
    buf_free(&text);
    if (f.signal) {
        signal(f.signal, SIG_DFL);
        raise(f.signal);
    }
    return status;
}
