/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/cli/film_options.h"
#include "protocol/say_options.h"
#include "server/base/options.h"
#include "server/film/film_media.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char usage[] =
    "Usage: faccia film [OPTION]... -o FILE (TEXT | --file FILE | - | --from FILE.fap | --library DIR "
    "--passage WORK | --visemes LANG | --expression NAME)\n"
    "Speaks TEXT, a file, or standard input (-), and films the head as the page draws it: frame by frame, "
    "as\n"
    "fast as this machine can. Needs ffmpeg and a browser without a window, such as "
    "chromium-headless-shell.\n"
    "\n"
    "  -o, --output FILE    the film: .mp4, .webm; without sound .gif, .webp; numbered pictures and\n"
    "                       a sound file: name-%05d.png\n"
    "  -m, --model NAME     a head that 'faccia models' lists (the first)\n"
    "      --partner NAME   a second head, to the right: of those who speak (in a play, with --dialogue "
    "voices),\n"
    "                       it shows the second; each listens to the other\n"
    "      --size WxH       pixels (640x480)\n"
    "      --background COLOUR|IMAGE|room|transparent\n"
    "                       a colour as in CSS, an image file, or a room out of focus (room; .gif and\n"
    "                       --visemes: #dfe3e8); transparent: not .mp4\n"
    "      --view portrait|face|bust|mouth\n"
    "                       what is seen of the head (portrait)\n"
    "      --quality low|fine|high|pictures\n"
    "                       of drawing; high: soft edges, slower (fine); pictures: the head's set of\n"
    "                       pictures, as on devices that cannot draw a head\n"
    "      --pictures FILE  films a set of pictures (models/tools/pictures makes them of photographs)\n"
    "      --show mesh,points,zone=FAP\n"
    "                       over the face: its triangles, MPEG-4's feature points, and what a FAP moves\n"
    "      --captions burn|track\n"
    "                       the words as captions: in the picture, or beside it (.mp4, .webm)\n"
    "      --lossless       keeps every pixel and every sample of the sound (.mp4; few players read it)\n"
    "      --at SECONDS     one picture (.png) of that moment\n"
    "      --visemes LANG   a sheet of the visemes of a language (.png); --size is that of each\n"
    "      --expression [KIND:]NAME[=INTENSITY]\n"
    "                       one picture (.png) of an expression that 'faccia expressions' lists\n"
    "      --library DIR    a folder of works, of which it films --passage WORK, WORK:SECTION or\n"
    "      --passage PLACE  WORK:SECTION:BLOCK, in the voices of the cast unless --voice names one\n"
    "      --from FILE.fap  films a recorded face\n"
    "      --audio FILE     its sound (default: a file of the same name beside it, or silence); for a text, "
    "the\n"
    "                       folder of sound files that it may refer to\n"
    "      --words FILE     its words (WebVTT), for --captions\n"
    "  -f, --file FILE      the text\n"
    "      --lexicon FILE   pronunciation lexicon (W3C PLS); may be repeated\n" SPEAK_HELP
    "  -h, --help           print this and exit\n"
    "Exit status: 0 filmed, 1 failed, 2 wrong usage.\n";

enum { SIDE_MIN = 16, SIDE_MAX = 4096, PIXELS_MAX = 3840 * 2160 };

static int wrong(const char *what, const char *text, const char *expected) {
    cli_complain("%s: invalid value '%s': expected %s", what, text, expected);
    return EXIT_USAGE;
}

static int take_size(struct film_options *f, const char *text) {
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

static int take_view(struct film_options *f, const char *text) {
    static const char *const views[] = {"portrait", "face", "bust", "mouth", NULL};
    int i = choose("--view", text, views, "portrait, face, bust or mouth");
    f->view = i > 0 ? views[i] : NULL;
    return i < 0 ? EXIT_USAGE : -1;
}

static int take_quality(struct film_options *f, const char *text) {
    static const char *const levels[] = {"low", "fine", "high", "pictures", NULL};
    int i = choose("--quality", text, levels, "low, fine, high or pictures");
    f->level = i < 0 ? NULL : levels[i];
    f->as_pictures = i >= 0 && !strcmp(levels[i], "pictures");
    return i < 0 ? EXIT_USAGE : -1;
}

/* Takes mesh, points and zone=FAP, with commas between. */
static int take_show(struct film_options *f, const char *text) {
    for (const char *word = text; *word;) {
        size_t length = strcspn(word, ",");
        unsigned fap = 0;
        int used = 0;
        if (length == 4 && !strncmp(word, "mesh", length))
            f->shows.mesh = true;
        else if (length == 6 && !strncmp(word, "points", length))
            f->shows.points = true;
        else if (sscanf(word, "zone=%2u%n", &fap, &used) == 1 && (size_t)used == length && fap >= 3 &&
                 fap <= FAP_COUNT)
            f->shows.zone = fap;
        else
            break;
        word += length;
        if (!*word)
            return -1;
        word++;
    }
    return wrong("--show", text, "mesh, points, or zone= and a FAP from 3 to 68, with commas between");
}

static int take_captions(struct film_options *f, const char *text) {
    static const char *const kinds[] = {"burn", "track", NULL};
    int i = choose("--captions", text, kinds, "burn or track");
    f->captions = i == 0 ? FILM_CAPTIONS_BURN : FILM_CAPTIONS_TRACK;
    return i < 0 ? EXIT_USAGE : -1;
}

static int take_at(struct film_options *f, const char *text) {
    char *end;
    f->at = strtod(text, &end);
    return end == text || *end || !(f->at >= 0 && f->at <= FILM_SECONDS_MAX)
               ? wrong("--at", text, "seconds from the beginning")
               : -1;
}

const char *film_numbered(const char *path, size_t *length) {
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

static int take_output(struct film_options *f, const char *path) {
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
        f->format = film_numbered(path, &length) ? FILM_PICTURES : FILM_STILL;
    else
        return wrong("--output", path, "a name that ends in .mp4, .webm, .gif, .webp or .png");
    return -1;
}

enum {
    OUTPUT = 256,
    MODEL,
    PARTNER,
    LIBRARY,
    PASSAGE,
    SIZE,
    BACKGROUND,
    VIEW,
    QUALITY,
    PICTURES,
    SHOW,
    CAPTIONS,
    LOSSLESS,
    AT,
    VISEMES,
    EXPRESSION,
    FROM,
    AUDIO,
    WORDS,
    LEXICON
};

/* Returns an exit code, or -1 to continue. */
static int take_own(struct film_options *f, int option, char *text) {
    switch (option) {
    case OUTPUT:
        return take_output(f, text);
    case MODEL:
        f->model = text;
        return -1;
    case PARTNER:
        f->partner = text;
        return -1;
    case LIBRARY:
        f->library = text;
        return -1;
    case PASSAGE:
        f->passage = text;
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
    case PICTURES:
        f->pictures = text;
        return -1;
    case SHOW:
        return take_show(f, text);
    case CAPTIONS:
        return take_captions(f, text);
    case LOSSLESS:
        f->lossless = true;
        return -1;
    case AT:
        return take_at(f, text);
    case VISEMES:
        f->visemes = text;
        return -1;
    case EXPRESSION:
        f->expression = text;
        return -1;
    case FROM:
        f->from = text;
        return -1;
    case AUDIO:
        f->audio = text;
        return -1;
    case WORDS:
        f->words = text;
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
static int check(const struct film_options *f, const struct speech_request *request) {
    bool track = f->format == FILM_MP4 || f->format == FILM_WEBM;
    if (!f->output)
        return refuse("no output: give a file (-o film.mp4)");
    if (request->open)
        return refuse("--open: a film is made of a whole text");
    if (f->at >= 0 && f->format != FILM_STILL)
        return refuse("--at: one picture is a .png");
#ifndef HAVE_LIBRARY
    if (f->library)
        return refuse("--library: this faccia was built without the library");
#endif
    if (!f->library != !f->passage)
        return refuse("--library: name the passage (--passage WORK), and its folder");
    if (f->library && f->from)
        return refuse("--passage: --from films a recorded face");
    if (f->pictures && (f->model || f->partner || (f->level && !f->as_pictures)))
        return refuse("--pictures: it takes the place of --model, and has one quality");
    if ((f->pictures || f->as_pictures) && film_shows_any(f->shows))
        return refuse("--show: pictures have nothing behind them; a head has");
    if (f->visemes &&
        (f->from || f->library || f->partner || f->at >= 0 || f->captions || f->format != FILM_STILL))
        return refuse("--visemes: a sheet is one .png, of nothing else");
    if (f->expression && (f->visemes || f->from || f->library || f->partner || f->at >= 0 || f->captions ||
                          f->format != FILM_STILL))
        return refuse("--expression: it is one .png, of nothing else");
    if (f->at < 0 && f->format == FILM_STILL && !f->visemes && !f->expression)
        return refuse("--output: give --at SECONDS for one picture, or a number for each (name-%05d.png)");
    if (f->transparent && f->format == FILM_MP4)
        return refuse("--background: .mp4 cannot be transparent; .webm, .gif, .webp and .png can");
    if (f->captions == FILM_CAPTIONS_TRACK && !track)
        return refuse(
            "--captions: only .mp4 and .webm have a track of captions; burn puts them in the picture");
    if (f->captions && f->from && !f->words)
        return refuse("--captions: a recorded face has no words; give them with --words FILE.vtt");
    if (f->partner && f->from && !f->words)
        return refuse("--partner: a recorded face does not say who speaks; --words FILE.vtt does");
    if (f->words && !f->from)
        return refuse("--words: a text has its own words");
    if (f->lossless && f->format != FILM_MP4)
        return refuse("--lossless is for .mp4; .png is lossless anyway");
    if (track && !f->lossless && (f->width % 2 || f->height % 2))
        return refuse("--size: the sides of .mp4 and .webm must be even");
    if (f->format == FILM_GIF && fmod(100, request->fps) != 0)
        return refuse("--fps: a GIF counts hundredths of a second: choose 1, 2, 4, 5, 10, 20, 25 or 50");
    return -1;
}

int film_options_read(int argc, char **argv, struct film_options *f, struct speech_request *request,
                      struct buf *text) {
    static const struct option options[] = {
        SPEAK_OPTIONS{"file", 1, NULL, 'f'},
        {"output", 1, NULL, OUTPUT},
        {"model", 1, NULL, MODEL},
        {"partner", 1, NULL, PARTNER},
        {"library", 1, NULL, LIBRARY},
        {"passage", 1, NULL, PASSAGE},
        {"size", 1, NULL, SIZE},
        {"background", 1, NULL, BACKGROUND},
        {"view", 1, NULL, VIEW},
        {"quality", 1, NULL, QUALITY},
        {"pictures", 1, NULL, PICTURES},
        {"show", 1, NULL, SHOW},
        {"captions", 1, NULL, CAPTIONS},
        {"lossless", 0, NULL, LOSSLESS},
        {"at", 1, NULL, AT},
        {"visemes", 1, NULL, VISEMES},
        {"expression", 1, NULL, EXPRESSION},
        {"from", 1, NULL, FROM},
        {"audio", 1, NULL, AUDIO},
        {"words", 1, NULL, WORDS},
        {"lexicon", 1, NULL, LEXICON},
        {"help", 0, NULL, 'h'},
        {0},
    };
    static const char letters[] = SPEAK_LETTERS "f:o:m:h";
    const char *path = NULL;
    struct error e;
    char message[400];
    int most = cli_option_count(argc, argv, letters, options), status = -1;
    for (int c, at; status < 0 && (at = -1, c = options_next(most, argv, letters, options, &at)) != -1;) {
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
    bool textless = f->from || f->visemes || f->expression || f->library;
    if (textless && (path || optind < argc))
        return refuse(f->from      ? "--from films a recorded face: there can be no text"
                      : f->library ? "--passage films a part of the library: there can be no text"
                      : f->visemes ? "--visemes: there can be no text"
                                   : "--expression: there can be no text");
    if (textless)
        return -1;
    status = cli_text(argc, argv, path, text);
    if (status < 0)
        request_set(
            request, "text",
            (struct request_value){REQUEST_STRING, text->size ? (char *)text->data : "", text->size, 0}, &e);
    return status;
}
