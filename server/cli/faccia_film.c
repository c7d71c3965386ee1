/* SPDX-License-Identifier: GPL-3.0-or-later */
/* faccia film: speaks a text, or takes a recorded face, and films the head that the page would show. */
#include "protocol/say_options.h"
#include "server/base/mem.h"
#include "server/cli/cli.h"
#include "server/film/film_browser.h"
#include "server/film/film_coder.h"
#include "server/film/film_media.h"
#include "server/synthesis/recording.h"
#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <ftw.h>
#include <glob.h>
#include <jansson.h>
#include <libgen.h>
#include <limits.h>
#include <math.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static const char usage[] =
    "Usage: faccia film [OPTION]... -o FILE (TEXT | --file FILE | - | --from FILE.fap)\n"
    "Speaks TEXT, a file, or standard input (-), and films the head as the page draws it: frame by frame, "
    "as\n"
    "fast as this machine can. Needs ffmpeg and a browser without a window, such as "
    "chromium-headless-shell.\n"
    "\n"
    "  -o, --output FILE    the film: .mp4, .webm; without sound .gif, .webp; numbered pictures and\n"
    "                       a sound file: name-%05d.png\n"
    "  -m, --model NAME     a head that 'faccia models' lists (the first)\n"
    "      --size WxH       pixels (640x480)\n"
    "      --background COLOUR|IMAGE|transparent\n"
    "                       a colour as in CSS, or an image file (#dfe3e8); transparent: not .mp4\n"
    "      --view portrait|face|bust|mouth\n"
    "                       what is seen of the head (portrait)\n"
    "      --quality low|fine|high\n"
    "                       of drawing; high: soft edges, slower (fine)\n"
    "      --captions burn|track\n"
    "                       the words as captions: in the picture, or beside it (.mp4, .webm)\n"
    "      --lossless       keeps every pixel and every sample of the sound (.mp4; few players read it)\n"
    "      --at SECONDS     one picture (.png) of that moment\n"
    "      --from FILE.fap  films a recorded face\n"
    "      --audio FILE     its sound (default: a file of the same name beside it, or silence); for a text, "
    "the\n"
    "                       folder of sound files that it may refer to\n"
    "  -f, --file FILE      the text\n"
    "      --lexicon FILE   pronunciation lexicon (W3C PLS); may be repeated\n" SPEAK_HELP
    "  -h, --help           print this and exit\n"
    "Exit status: 0 filmed, 1 failed, 2 wrong usage.\n";

enum { SIDE_MIN = 16, SIDE_MAX = 4096, PIXELS_MAX = 3840 * 2160, SIGNALS = 3, GIF_BYTES_MAX = 1 << 30 };

struct film {
    const struct settings *settings;
    struct cli cli;
    struct cli_lexicons lexicons;
    /* options; NULL = not given */
    const char *output, *model, *background, *view, *level, *from, *audio;
    unsigned width, height;
    double at; /* negative: the whole */
    bool lossless, transparent;
    enum film_format format;
    enum film_captions captions;
    bool fps_given;
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
    char folder[64];         /* for what the programs need */
    char pictures[PATH_MAX]; /* folder of unfinished pictures, beside the finished ones; "": none */
    unsigned count, drawn;   /* pictures */
    uint64_t start, told;    /* loop time, ms */
    int signal;              /* that has ended the film; 0: none */
    bool finished, failed;
};

/* Options */

static int wrong(const char *what, const char *text, const char *expected) {
    cli_complain("%s: invalid value '%s': expected %s", what, text, expected);
    return EXIT_USAGE;
}

static int take_size(struct film *f, const char *text) {
    int used = 0;
    bool well = sscanf(text, "%4ux%4u%n", &f->width, &f->height, &used) == 2 && !text[used];
    if (!well || f->width < SIDE_MIN || f->height < SIDE_MIN || f->width > SIDE_MAX || f->height > SIDE_MAX ||
        f->width * f->height > PIXELS_MAX)
        return wrong("--size", text, "WxH, 16 to 4096 pixels each, at most those of 3840x2160");
    return -1;
}

/* Chooses one of the words; -1 after a message. */
static int choose(const char *option, const char *text, const char *const *words, const char *expected) {
    for (int i = 0; words[i]; i++)
        if (!strcmp(words[i], text))
            return i;
    wrong(option, text, expected);
    return -1;
}

static int take_view(struct film *f, const char *text) {
    static const char *const views[] = {"portrait", "face", "bust", "mouth", NULL};
    int i = choose("--view", text, views, "portrait, face, bust or mouth");
    f->view = i > 0 ? views[i] : NULL;
    return i < 0 ? EXIT_USAGE : -1;
}

static int take_quality(struct film *f, const char *text) {
    static const char *const levels[] = {"low", "fine", "high", NULL};
    int i = choose("--quality", text, levels, "low, fine or high");
    f->level = i < 0 ? NULL : levels[i];
    return i < 0 ? EXIT_USAGE : -1;
}

static int take_captions(struct film *f, const char *text) {
    static const char *const kinds[] = {"burn", "track", NULL};
    int i = choose("--captions", text, kinds, "burn or track");
    f->captions = i == 0 ? FILM_CAPTIONS_BURN : FILM_CAPTIONS_TRACK;
    return i < 0 ? EXIT_USAGE : -1;
}

static int take_at(struct film *f, const char *text) {
    char *end;
    f->at = strtod(text, &end);
    return end == text || *end || !(f->at >= 0 && f->at <= FILM_SECONDS_MAX)
               ? wrong("--at", text, "seconds from the beginning")
               : -1;
}

/* Returns the place of a pattern's "%d" or "%05d" if that is all it has of the kind, or NULL. */
static const char *numbered(const char *path, size_t *length) {
    const char *percent = strchr(path, '%'), *name = strrchr(path, '/');
    if (!percent || (name && percent < name))
        return NULL;
    *length = 1 + strspn(percent + 1, "0123456789");
    if (percent[(*length)++] != 'd' || *length > 4 || (percent[1] != '0' && *length > 2) ||
        strchr(percent + *length, '%'))
        return NULL;
    return percent;
}

static bool ends_in(const char *path, const char *suffix) {
    size_t size = strlen(path), length = strlen(suffix);
    return size > length && !strcmp(path + size - length, suffix);
}

static int take_output(struct film *f, const char *path) {
    size_t length;
    f->output = path;
    if (ends_in(path, ".mp4"))
        f->format = FILM_MP4;
    else if (ends_in(path, ".webm"))
        f->format = FILM_WEBM;
    else if (ends_in(path, ".gif"))
        f->format = FILM_GIF;
    else if (ends_in(path, ".webp"))
        f->format = FILM_WEBP;
    else if (ends_in(path, ".png"))
        f->format = numbered(path, &length) ? FILM_PICTURES : FILM_STILL;
    else
        return wrong("--output", path, "a name that ends in .mp4, .webm, .gif, .webp or .png");
    return -1;
}

enum { OUTPUT = 256, MODEL, SIZE, BACKGROUND, VIEW, QUALITY, CAPTIONS, LOSSLESS, AT, FROM, AUDIO, LEXICON };

/* Returns an exit code, or -1 to continue. */
static int take_own(struct film *f, int option, char *text) {
    switch (option) {
    case OUTPUT:
        return take_output(f, text);
    case MODEL:
        f->model = text;
        return -1;
    case SIZE:
        return take_size(f, text);
    case BACKGROUND:
        f->background = text;
        f->transparent = !strcmp(text, "transparent");
        return -1;
    case VIEW:
        return take_view(f, text);
    case QUALITY:
        return take_quality(f, text);
    case CAPTIONS:
        return take_captions(f, text);
    case LOSSLESS:
        f->lossless = true;
        return -1;
    case AT:
        return take_at(f, text);
    case FROM:
        f->from = text;
        return -1;
    case AUDIO:
        f->audio = text;
        return -1;
    default:
        cli_lexicons_add(&f->lexicons, text);
        return -1;
    }
}

static int refuse(const char *why) {
    cli_complain("%s", why);
    return EXIT_USAGE;
}

/* Checks that the options fit each other. Returns an exit code after a message, or -1. */
static int check(const struct film *f, const struct speech_request *request) {
    bool track = f->format == FILM_MP4 || f->format == FILM_WEBM;
    if (!f->output)
        return refuse("no output: give a file (-o film.mp4)");
    if (request->open)
        return refuse("--open: a film is made of a whole text");
    if (f->at >= 0 && f->format != FILM_STILL)
        return refuse("--at: one picture is a .png");
    if (f->at < 0 && f->format == FILM_STILL)
        return refuse("--output: give --at SECONDS for one picture, or a number for each (name-%05d.png)");
    if (f->transparent && f->format == FILM_MP4)
        return refuse("--background: .mp4 cannot be transparent; .webm, .gif, .webp and .png can");
    if (f->captions == FILM_CAPTIONS_TRACK && !track)
        return refuse(
            "--captions: only .mp4 and .webm have a track of captions; burn puts them in the picture");
    if (f->captions && f->from)
        return refuse("--captions: a recorded face has no words");
    if (f->lossless && f->format != FILM_MP4)
        return refuse("--lossless is for .mp4; .png is lossless anyway");
    if (track && !f->lossless && (f->width % 2 || f->height % 2))
        return refuse("--size: the sides of .mp4 and .webm must be even");
    if (f->format == FILM_GIF && fmod(100, request->fps) != 0)
        return refuse("--fps: a GIF counts hundredths of a second: choose 1, 2, 4, 5, 10, 20, 25 or 50");
    return -1;
}

/* Returns an exit code, or -1 to continue. */
static int parse(int argc, char **argv, struct film *f, struct speech_request *request, struct buf *text) {
    static const struct option options[] = {
        SPEAK_OPTIONS{"file", 1, NULL, 'f'},
        {"output", 1, NULL, OUTPUT},
        {"model", 1, NULL, MODEL},
        {"size", 1, NULL, SIZE},
        {"background", 1, NULL, BACKGROUND},
        {"view", 1, NULL, VIEW},
        {"quality", 1, NULL, QUALITY},
        {"captions", 1, NULL, CAPTIONS},
        {"lossless", 0, NULL, LOSSLESS},
        {"at", 1, NULL, AT},
        {"from", 1, NULL, FROM},
        {"audio", 1, NULL, AUDIO},
        {"lexicon", 1, NULL, LEXICON},
        {"help", 0, NULL, 'h'},
        {0},
    };
    static const char letters[] = SPEAK_LETTERS "f:o:m:h";
    const char *path = NULL;
    struct error e;
    char message[400];
    int most = cli_option_count(argc, argv, letters, options), status = -1;
    for (int c, at; status < 0 && (at = -1, c = getopt_long(most, argv, letters, options, &at)) != -1;) {
        for (int i = 0; at < 0 && options[i].name; i++)
            at = options[i].val == c ? i : -1;
        if (c == 'h' || c == '?') {
            fputs(c == 'h' ? usage : "Try 'faccia film --help'.\n", c == 'h' ? stdout : stderr);
            return c == 'h' ? EXIT_DONE : EXIT_USAGE;
        }
        if (c == 'f') {
            path = optarg;
        } else if (c >= OUTPUT || c == 'o' || c == 'm') {
            status = take_own(f, c == 'o' ? OUTPUT : c == 'm' ? MODEL : c, optarg);
        } else {
            const char *word = optarg ? optarg : "true";
            struct request_value value = {REQUEST_WORD, word, strlen(word), 0};
            f->fps_given |= !strcmp(options[at].name, "fps");
            if (request_set(request, options[at].name, value, &e)) {
                cli_complain("--%s", error_text(&e, message, sizeof message));
                status = EXIT_USAGE;
            }
        }
    }
    status = status < 0 ? check(f, request) : status;
    if (status >= 0)
        return status;
    if (f->from && (path || optind < argc))
        return refuse("--from films a recorded face: there can be no text");
    if (f->from)
        return -1;
    status = cli_text(argc, argv, path, text);
    if (status < 0)
        request_set(
            request, "text",
            (struct request_value){REQUEST_STRING, text->size ? (char *)text->data : "", text->size, 0}, &e);
    return status;
}

/* What is needed is there, or it is said how to get it. */
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

/* The head */

static json_t *head_at(const char *file) {
    json_t *head = json_load_file(file, 0, NULL);
    const char *format = json_string_value(json_object_get(head, "format"));
    if (format && !strcmp(format, "faccia-head"))
        return head;
    json_decref(head);
    return NULL;
}

/* Finds the file of the head, the first by rank if none is named. Returns the head, or NULL after a message.
 */
static json_t *find_head(const struct film *f, char file[PATH_MAX]) {
    char pattern[PATH_MAX];
    glob_t found;
    json_t *best = NULL;
    const char *name = f->model ? f->model : "*";
    snprintf(pattern, sizeof pattern, "%s/heads/%s.json", f->settings->models, name);
    if (strchr(name, '/') || (f->model && strpbrk(name, "*?[")) || glob(pattern, 0, NULL, &found)) {
        cli_complain("--model: unknown head '%s'; 'faccia models' lists them", name);
        return NULL;
    }
    for (size_t i = 0; i < found.gl_pathc; i++) {
        json_t *head = head_at(found.gl_pathv[i]), *rank = json_object_get(head, "rank");
        bool first =
            head && (!best || (json_is_number(rank) &&
                               json_number_value(rank) < json_number_value(json_object_get(best, "rank"))));
        if (first) {
            json_decref(best);
            best = json_incref(head);
            snprintf(file, PATH_MAX, "%s", found.gl_pathv[i]);
        }
        json_decref(head);
    }
    globfree(&found);
    if (!best)
        cli_complain("%s: this is not a head model", pattern);
    return best;
}

static bool is_given(const struct speech_request *request, const char *name) {
    struct request_value value;
    for (size_t i = 0; request_field(i); i++)
        if (!strcmp(request_field(i), name))
            return request_get(request, i, &value);
    return false;
}

/* Unless a voice is named: the voice that suits the head, as on the page. */
static void suit(struct speech_request *request, const json_t *head) {
    const char *name;
    json_t *value;
    struct error e;
    if (request->voice || request->gender != GENDER_ANY)
        return;
    json_object_foreach(json_object_get(head, "voice"), name, value) {
        char *word = json_is_string(value) ? mem_strdup(json_string_value(value))
                                           : json_dumps(value, JSON_ENCODE_ANY | JSON_REAL_PRECISION(9));
        if (!is_given(request, name))
            request_set(request, name, (struct request_value){REQUEST_WORD, word, strlen(word), 0}, &e);
        free(word);
    }
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
    cli_complain("%s%s%s", warning ? "warning: " : "", f->from ? "--from: " : "",
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
    if (cli_open(&f->cli, cli_lexicons_with(&f->lexicons, f->settings)))
        return EXIT_FAILED;
    if (f->audio)
        f->cli.components.pipeline.sounds = f->audio;
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

static int read_recording(struct film *f) {
    struct recording_source source = {.name = mem_strdup(f->from),
                                      .fap_path = mem_strdup(f->from),
                                      .sound_path = f->audio ? mem_strdup(f->audio) : NULL,
                                      .fap_bytes_max = (size_t)1 << 30};
    const struct export_source origin = {.play = f->from};
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
    return EXIT_DONE;
}

/* Folders */

static int remove_one(const char *path, const struct stat *status, int kind, struct FTW *place) {
    (void)status;
    (void)kind;
    (void)place;
    remove(path);
    return 0;
}

static void remove_folder(const char *path) {
    enum { TRIES = 20, PAUSE_US = 50000 };
    /* A browser that was killed may still write for a moment. */
    for (int i = 0; *path && i < TRIES && !access(path, F_OK); i++) {
        if (i)
            usleep(PAUSE_US);
        nftw(path, remove_one, 16, FTW_DEPTH | FTW_PHYS);
    }
}

static int write_file(const struct film *f, const char *name, const struct buf *bytes) {
    char path[PATH_MAX];
    snprintf(path, sizeof path, "%s/%s", f->folder, name);
    FILE *file = fopen(path, "wbx");
    bool well = file && fwrite(bytes->data, 1, bytes->size, file) == bytes->size;
    well = file && !fclose(file) && well;
    if (!well)
        cli_complain("%s: %s", path, strerror(errno));
    return well ? 0 : -1;
}

/* Numbered pictures appear together, when all are there. */
static int open_pictures(struct film *f) {
    char folder[PATH_MAX], place[PATH_MAX];
    snprintf(folder, sizeof folder, "%s", f->output);
    if (!realpath(dirname(folder), place) ||
        (size_t)snprintf(f->pictures, sizeof f->pictures, "%s/.faccia-film-XXXXXX", place) >=
            sizeof f->pictures ||
        !mkdtemp(f->pictures)) {
        cli_complain("%s: %s", f->output, strerror(errno));
        f->pictures[0] = '\0';
        return -1;
    }
    return 0;
}

static int publish_one(const struct film *f, const char *from, const char *to) {
    char path[2 * PATH_MAX];
    snprintf(path, sizeof path, "%s/%s", f->pictures, from);
    if (!rename(path, to))
        return 0;
    cli_complain("%s: %s", to, strerror(errno));
    return -1;
}

/* Names the sound after the pictures: hello.wav for hello-%05d.png. */
static void sound_name(const char *pattern, char out[PATH_MAX]) {
    size_t length;
    int before = (int)(numbered(pattern, &length) - pattern);
    while (before && strchr("-_. ", pattern[before - 1]))
        before--;
    bool named = before && pattern[before - 1] != '/';
    snprintf(out, PATH_MAX, "%.*s%s.wav", before, pattern, named ? "" : "sound");
}

static int publish_pictures(const struct film *f) {
    char name[32], to[PATH_MAX];
    size_t length;
    const char *number = numbered(f->output, &length);
    int width = atoi(number + 1);
    for (unsigned k = 1; k <= f->count; k++) {
        snprintf(name, sizeof name, "%u.png", k);
        snprintf(to, sizeof to, "%.*s%0*u%s", (int)(number - f->output), f->output, width, k,
                 number + length);
        if (publish_one(f, name, to))
            return -1;
    }
    sound_name(f->output, to);
    struct cli_file sound;
    if (cli_create(&sound, to))
        return -1;
    const struct buf *wav = &f->media.sound.out;
    return cli_finish(&sound, fwrite(wav->data, 1, wav->size, sound.file) == wav->size);
}

/* Filming */

static void tell(struct film *f) {
    enum { EVERY_MS = 200, PARTS = 10 };
    uint64_t now = uv_now(&f->cli.loop);
    unsigned part = f->count / PARTS ? f->count / PARTS : 1;
    if (f->count == 1 ||
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
    snprintf(f->folder, sizeof f->folder, "/tmp/faccia-film-XXXXXX");
    if (!mkdtemp(f->folder)) {
        cli_complain("%s: %s", f->folder, strerror(errno));
        f->folder[0] = '\0';
        return -1;
    }
    return write_file(f, "sound.wav", &f->media.sound.out) ||
                   write_file(f, "captions.vtt", &f->media.captions.out)
               ? -1
           : f->format == FILM_PICTURES ? open_pictures(f)
                                        : cli_create(&f->file, f->output);
}

static int start(struct film *f, const char *head, double fps) {
    static const struct film_browser_calls browser_calls = {on_picture, on_failed};
    static const struct film_coder_calls coder_calls = {on_taken, on_coded};
    bool file = f->background && !f->transparent && !access(f->background, R_OK);
    char pattern[PATH_MAX + 16];
    struct error e;
    snprintf(pattern, sizeof pattern, "%s/%%d.png", f->pictures);
    const struct film_coding coding = {.format = f->format,
                                       .width = f->width,
                                       .height = f->height,
                                       .fps = fps,
                                       .transparent = f->transparent,
                                       .lossless = f->lossless,
                                       .folder = f->folder,
                                       .sound = (f->format == FILM_MP4 || f->format == FILM_WEBM) &&
                                                f->media.sound.samples,
                                       .captions = f->captions,
                                       .file = f->file.file ? fileno(f->file.file) : -1,
                                       .pattern = pattern};
    const struct film_scene scene = {.web = f->settings->api.web,
                                     .head = head,
                                     .folder = f->folder,
                                     .width = f->width,
                                     .height = f->height,
                                     .level = f->level ? f->level : "fine",
                                     .view = f->view,
                                     .colour = f->transparent || file ? NULL
                                               : f->background        ? f->background
                                                                      : "#dfe3e8",
                                     .image = file ? f->background : NULL,
                                     .faces = &f->media.faces.out,
                                     .rate = f->media.faces.fps,
                                     .fps = fps,
                                     .start = f->at > 0 ? f->at : 0,
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
    if (f->at >= seconds) {
        cli_complain("--at: %g is after the end, at %g seconds", f->at, seconds);
        return 0;
    }
    unsigned count = f->at >= 0                  ? 1
                     : fps == f->media.faces.fps ? film_media_faces(&f->media)
                                                 : (unsigned)ceil(seconds * fps - 1e-9);
    if (f->format == FILM_GIF && (double)count * f->width * f->height * 4 > GIF_BYTES_MAX) {
        cli_complain("film: %u pictures of this size are too many for a GIF: make it smaller, or a .webm",
                     count);
        return 0;
    }
    return count;
}

static int shoot(struct film *f, const char *head, const struct speech_request *request) {
    double fps = f->from && !f->fps_given ? f->media.faces.fps : request->fps;
    f->count = count_pictures(f, fps);
    if (!f->count)
        return EXIT_FAILED;
    watch_signals(f);
    if (!write_files(f) && !start(f, head, fps)) {
        while (!f->finished && uv_run(&f->cli.loop, UV_RUN_ONCE))
            ;
        if (!f->failed && f->format == FILM_PICTURES)
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
    remove_folder(f->pictures);
    remove_folder(f->folder);
    return f->failed ? EXIT_FAILED : EXIT_DONE;
}

static int run(struct film *f, struct speech_request *request) {
    char head[PATH_MAX] = "";
    json_t *model = check_programs() ? NULL : find_head(f, head);
    if (!model)
        return EXIT_FAILED;
    suit(request, model);
    json_decref(model);
    int status = f->from ? read_recording(f) : speak(f, request);
    components_stop_voices(&f->cli.components);
    uv_run(&f->cli.loop, UV_RUN_DEFAULT);
    if (!status)
        status = f->failed ? EXIT_FAILED : shoot(f, head, request);
    if (f->begun)
        film_media_free(&f->media);
    uv_loop_close(&f->cli.loop);
    components_free(&f->cli.components);
    return status;
}

int film_main(int argc, char **argv, const struct settings *settings) {
    struct film f = {.settings = settings, .width = 640, .height = 480, .at = -1};
    struct speech_request request;
    struct buf text = {0};
    request_init(&request);
    int status = parse(argc, argv, &f, &request, &text);
    if (status < 0)
        status = run(&f, &request);
    cli_lexicons_free(&f.lexicons);
    request_free(&request);
    buf_free(&text);
    if (f.signal) {
        signal(f.signal, SIG_DFL);
        raise(f.signal);
    }
    return status;
}
