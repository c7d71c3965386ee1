/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "protocol/say_options.h"
#include "server/base/mem.h"
#include "server/base/options.h"
#include "server/base/suggest.h"
#include "server/base/utf8.h"
#include "server/cli/cli.h"
#include "server/export/export.h"
#include "server/library/align/aligned_recording.h"
#include "server/library/align/text_reading.h"
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* ---- output: timing, face and sound, by segment as times become known ---- */

/* Sentences below this confidence are reported. */
#define ALIGN_UNSURE 0.15

enum { WAV, FAP, JSON, OUTPUTS };

struct output {
    const char *path; /* NULL = not requested */
    struct cli_file file;
    struct export export;
};

struct align {
    const char *sound, *text, *timing, *names, *tier, *word_tier, *gender;
    struct speech_request request; /* lang, engine, fps, still, seed */
    struct output outputs[OUTPUTS];
    bool progress, certain;
    struct cli_lexicons lexicons;
    const struct components *components;
    const struct speech_packs *packs;
    const struct speech_pack *pack;
    struct aligned_recording *reading;
    uint64_t at;                         /* sample up to which segments are written */
    size_t phone;                        /* first phone that ends after it */
    size_t sentence, told, line, column; /* last sentence reported; its byte, line and column in the text */
};

/* ---- reports where the recording differs from its text ---- */

/* Shorter unmatched sound, in seconds, may be a breath. */
#define PASSED_LEAST 0.8
enum { SHOWN_CHARACTERS = 40 };

/* Advances line and column to that byte of the text. */
static void go_to(struct align *a, size_t byte) {
    const char *text = a->reading->text;
    for (; a->told < byte; a->told++) {
        a->column += (text[a->told] & 0xC0) != 0x80;
        if (text[a->told] == '\n') {
            a->line++;
            a->column = 0;
        }
    }
}

/* Length of the beginning of a sentence that messages quote. */
static int shown(const char *text, size_t size) {
    size_t at = 0;
    uint32_t cp;
    for (int i = 0; i < SHOWN_CHARACTERS && at < size && text[at] != '\n'; i++)
        at += utf8_next(text + at, size - at, &cp);
    while (at && text[at - 1] == ' ')
        at--;
    return (int)at;
}

static void tell(struct align *a, const struct aligned_recording_sentence *s) {
    const char *text = a->reading->text;
    size_t from = s->from;
    int minutes = (int)(s->start / 60);
    while (from < s->to && (text[from] == ' ' || text[from] == '\n' || text[from] == '\r'))
        from++;
    go_to(a, from);
    if (s->passed >= PASSED_LEAST)
        cli_complain("warning: before %d:%04.1f, %.1f s of speech are not in the text", minutes,
                     s->start - 60 * minutes, s->passed);
    if (!s->found)
        cli_complain("warning: %s:%zu:%zu: not in the recording: \"%.*s\"", a->text, a->line + 1,
                     a->column + 1, shown(text + from, s->to - from), text + from);
    else if (s->confidence < ALIGN_UNSURE)
        cli_complain(
            "warning: %s:%zu:%zu: may differ from the speech at %d:%04.1f (confidence %.2f): \"%.*s\"",
            a->text, a->line + 1, a->column + 1, minutes, s->start - 60 * minutes, s->confidence,
            shown(text + from, s->to - from), text + from);
}

/* Reports new sentences that are missing or read differently, on standard error and in the JSON. */
static void align_tell(struct align *a) {
    for (; a->sentence < a->reading->sentence_count; a->sentence++) {
        const struct aligned_recording_sentence *s = &a->reading->sentences[a->sentence];
        tell(a, s);
        if (a->outputs[JSON].path)
            export_json_sentence(&a->outputs[JSON].export, aligned_recording_sentence_json(s));
    }
}

/* Segments end in a pause of at least SCENE_PAUSE seconds after a minimum length, or at any phone when
 * they are too long. */
#define SCENE_PAUSE 0.15
#define SCENE_LEAST 3.0
#define SCENE_MOST 20.0

static int write_out(struct output *o) {
    struct buf *out = &o->export.out;
    bool well = !out->size || fwrite(out->data, 1, out->size, o->file.file) == out->size;
    out->size = 0;
    if (!well)
        cli_complain("%s: %s", o->path, strerror(errno));
    return well ? 0 : -1;
}

static void on_warning(void *ctx, const char *message) {
    (void)ctx;
    cli_complain("warning: %s", message);
}

static int write_segment(struct align *a, uint64_t to) {
    struct sentence_audio *u = aligned_recording_audio(a->reading, a->at, to);
    const struct face_options options = {
        .engine = a->request.engine, .contacts = a->request.contacts, .still = a->request.still};
    struct media_segment segment = {.audio = u,
                                    .track = face_track_new(a->pack, u, &options, on_warning, NULL),
                                    .start = (int64_t)a->at,
                                    .alone = {.life = a->request.life < 0 ? 1 : a->request.life,
                                              .seed = a->request.seed < 0 ? 0 : (uint64_t)a->request.seed,
                                              .begin = (double)a->at / u->sample_rate}};
    int result = 0;
    for (struct output *o = a->outputs; o < a->outputs + OUTPUTS && !result; o++) {
        if (!o->path)
            continue;
        export_segment(&o->export, &segment);
        result = write_out(o);
    }
    media_segment_free(&segment);
    a->at = to;
    return result;
}

/* End of the segment that begins at a->at, at most at `known` seconds. 0 = not known yet. */
static uint64_t segment_end(struct align *a, double known) {
    const struct aligned_recording *r = a->reading;
    double rate = r->sound->rate, start = (double)a->at / rate, total = (double)r->sound->samples / rate;
    while (a->phone < r->phone_count && r->phones[a->phone].end <= start)
        a->phone++;
    for (size_t i = a->phone; i < r->phone_count && r->phones[i].end < known; i++) {
        double end = r->phones[i].end, next = i + 1 < r->phone_count ? r->phones[i + 1].start : total;
        if (next - start > SCENE_MOST && end - start < SCENE_MOST && next - end > SCENE_PAUSE)
            return (uint64_t)(fmin((end + next) / 2, start + SCENE_MOST) * rate);
        if ((end - start >= SCENE_LEAST && next - end >= SCENE_PAUSE && next < known) ||
            end - start >= SCENE_MOST)
            return (uint64_t)(fmin((end + next) / 2, end + 1) * rate);
    }
    if (known < total)
        return 0;
    uint64_t most = a->at + (uint64_t)(SCENE_MOST * rate);
    return most < r->sound->samples ? most : r->sound->samples;
}

static void show_progress(const struct align *a, double share) {
    enum { WIDTH = 40 };
    static const char bar[WIDTH + 1] = "########################################";
    int done = (int)(share * WIDTH);
    if (a->progress)
        fprintf(stderr, "\r[%-*.*s] %3.0f %%", WIDTH, done, bar, share * 100);
}

/* Writes the segments before `known` seconds; INFINITY = the rest. -1 after a message. */
static int align_write(struct align *a, double known) {
    for (uint64_t to; a->at < a->reading->sound->samples && (to = segment_end(a, known)) > a->at;) {
        show_progress(a, (double)to / (double)a->reading->sound->samples);
        if (write_segment(a, to))
            return -1;
    }
    return 0;
}

/* -1 after a message. */
static int align_open_outputs(struct align *a) {
    static const char *const names[OUTPUTS] = {"wav", "fap", "json"};
    const struct export_source source = {
        .text = a->reading->text,
        .lang = a->request.lang,
        .voice = a->sound,
        .engine = a->request.engine ? a->request.engine : face_engines()[0],
        .fps = a->request.fps,
        .aligned = a->text != NULL,
        .frames = frame_from_sample(a->reading->sound->samples, a->reading->sound->rate, a->request.fps)};
    for (int i = 0; i < OUTPUTS; i++) {
        struct output *o = &a->outputs[i];
        if (!o->path)
            continue;
        if (cli_create(&o->file, o->path))
            return -1;
        export_begin(&o->export, export_by_name(names[i]), &source);
    }
    return 0;
}

/* Sets the true length of a seekable WAV file. Discards the file unless `well`. -1 after a message. */
static int align_close_output(struct output *o, bool wav, bool well) {
    uint8_t header[WAV_HEADER_BYTES];
    if (wav && o->file.file && o->export.sample_rate && !fseek(o->file.file, 0, SEEK_SET)) {
        wav_header(header, o->export.sample_rate, o->export.samples);
        fwrite(header, 1, sizeof header, o->file.file);
    }
    return cli_finish(&o->file, well);
}

/* Completes the files. -1 after a message. */
static int align_end_outputs(struct align *a) {
    for (struct output *o = a->outputs; o < a->outputs + OUTPUTS; o++)
        if (o->path) {
            export_end(&o->export);
            if (write_out(o))
                return -1;
        }
    return 0;
}

/* faccia align: finds when a recording says its text, and makes the face for it. */

static const char usage[] =
    "Usage: faccia align [OPTION]... SOUND [--text FILE] [--timing FILE]\n"
    "Finds when each word and phone of its transcript is spoken in the recording SOUND (WAV, FLAC, Ogg, "
    "MP3, M4A), itself or\n"
    "from a file of times, and writes timing, face and sound. Without --json, --fap or --wav the timing goes "
    "to\n"
    "standard output.\n"
    "\n"
    "  -t, --text FILE      the transcript, plain text, UTF-8\n"
    "      --timing FILE    times of the phones: Festival or HTK .lab, .mlf, Praat TextGrid, faccia's JSON, "
    "byte offsets\n"
    "      --names FILE     JSON object: the IPA of each phone name in the timing\n"
    "      --tier NAME      tier of a TextGrid with the phones (default: found by its name)\n"
    "      --word-tier NAME tier with the words\n"
    "  -l, --lang TAG       it, pt-BR, tr, en, or any other that a voice speaks (it)\n"
    "      --gender WORD    of the speaker: female or male (default: detected)\n"
    "      --certain        align even if the recording does not sound like the words: they are known to be "
    "right\n"
    "      --lexicon FILE   pronunciations used in the recording (W3C PLS); may be repeated\n" SPEAK_HELP_FPS
        SPEAK_HELP_ENGINE SPEAK_HELP_CONTACTS SPEAK_HELP_STILL /* made of protocol/messages.json */
    "      --seed N         random seed of the face's idle motion (0)\n"
    "      --json FILE      phones and words with their times\n"
    "      --fap FILE       the face, as MPEG-4 FAPs (text, version 2.1)\n"
    "      --wav FILE       the sound, mono, 16 bits\n"
    "  -q, --quiet          no progress\n"
    "  -h, --help           print this and exit\n"
    "FILE - is standard input or output. Exit status: 0 done, 1 failed, 2 wrong usage.\n";

static int work(struct align *a) {
    struct error e;
    char text[400];
    int found = 1;
    while (found > 0 && (found = aligned_recording_advance(a->reading, &e)) > 0) {
        align_tell(a);
        if (align_write(a, a->reading->until))
            return -1;
    }
    if (found < 0) {
        cli_complain("%s%s%s", a->text ? a->text : "", a->text ? ":" : "", error_text(&e, text, sizeof text));
        return -1;
    }
    if (a->reading->rest > 3)
        cli_complain("warning: the recording continues for %.0f s after its text", a->reading->rest);
    return align_write(a, INFINITY) ? -1 : align_end_outputs(a);
}

/* Reads --timing, with --names. -1 after a message. */
static int read_timing(struct align *a, struct times *times) {
    struct buf data = {0};
    json_error_t why;
    json_t *names = a->names ? json_load_file(a->names, 0, &why) : NULL;
    const struct times_options options = {
        .format = TIMES_GUESS, .tier = a->tier, .word_tier = a->word_tier, .names = names, .pack = a->pack};
    struct error e;
    char text[400];
    int result = -1;
    if (a->names && !json_is_object(names))
        cli_complain("%s:%d:%d: %s", a->names, names ? 1 : why.line, names ? 1 : why.column,
                     names ? "must be an object" : why.text);
    else if (!cli_read(a->timing, &data)) {
        result = times_read(times, &options, data.data ? (char *)data.data : "", data.size, &e);
        if (result)
            cli_complain("%s:%s", a->timing, error_text(&e, text, sizeof text));
        else if (*times->unnamed)
            cli_complain("warning: the table has no IPA for the phone \"%s\"", times->unnamed);
    }
    json_decref(names);
    buf_free(&data);
    return result;
}

static int run(struct align *a, const struct settings *settings) {
    const struct text_reading reading = {&a->components->normalizers, a->components->pipeline.lexicons,
                                         a->request.lang};
    struct reference_slot reference = {.read = text_reading_read, .read_ctx = &reading};
    struct buf script = {0};
    struct times times = {0};
    struct error e;
    int result = -1;
    snprintf(reference.worker, sizeof reference.worker, "%s", settings->voices.worker);
    reference.unconfined = settings->voices.unconfined;
    snprintf(reference.path, sizeof reference.path, "%s/espeak.so", settings->voices.plugin_dir);
    if ((!a->text || !cli_read(a->text, &script)) && (!a->timing || !read_timing(a, &times))) {
        size_t skip = script.size >= 3 && !memcmp(script.data, "\xEF\xBB\xBF", 3) ? 3 : 0;
        const struct aligned_recording_options options = {
            .sound = a->sound,
            .text = a->text && script.size ? (char *)script.data + skip : NULL,
            .text_size = script.size - skip,
            .lang = a->request.lang,
            .gender = a->gender,
            .certain = a->certain,
            .times = a->timing ? &times : NULL,
            .reference = &reference};
        a->reading = aligned_recording_open(&options, &e);
        if (!a->reading)
            cli_complain_at(a->text, false, &e); /* only the text's errors have a place */
        else if (!a->reading->tokens.count && !a->timing)
            cli_complain("%s: contains no words", a->text);
        else
            result = align_open_outputs(a) ? -1 : work(a);
    }
    if (a->progress)
        fputs("\r\033[K", stderr);
    for (int i = 0; i < OUTPUTS; i++) {
        if (align_close_output(&a->outputs[i], i == WAV, !result))
            result = -1;
        export_free(&a->outputs[i].export);
    }
    aligned_recording_free(a->reading);
    reference_close(reference.reference);
    times_free(&times);
    buf_free(&script);
    return result ? EXIT_FAILED : EXIT_DONE;
}

/* Returns an exit code, or -1 to continue. */
static int parse(int argc, char **argv, struct align *a) {
    static const struct option options[] = {
        {"text", 1, NULL, 't'},    {"timing", 1, NULL, 'T'},
        {"names", 1, NULL, 'N'},   {"lang", 1, NULL, 'l'},
        {"gender", 1, NULL, 'g'},  {"fps", 1, NULL, 1},
        {"engine", 1, NULL, 'e'},  {"contacts", 1, NULL, 1},
        {"still", 0, NULL, 1},     {"seed", 1, NULL, 1},
        {"json", 1, NULL, 'J'},    {"fap", 1, NULL, 'F'},
        {"wav", 1, NULL, 'W'},     {"quiet", 0, NULL, 'q'},
        {"tier", 1, NULL, 'P'},    {"word-tier", 1, NULL, 'O'},
        {"help", 0, NULL, 'h'},    {"lexicon", 1, NULL, 'X'},
        {"certain", 0, NULL, 'C'}, {0},
    };
    struct error e;
    char message[400];
    for (int c, at; (at = -1, c = options_next(argc, argv, "t:l:e:qh", options, &at)) != -1;) {
        const char **const texts[] = {['t'] = &a->text,
                                      ['T'] = &a->timing,
                                      ['N'] = &a->names,
                                      ['P'] = &a->tier,
                                      ['O'] = &a->word_tier,
                                      ['g'] = &a->gender,
                                      ['J'] = &a->outputs[JSON].path,
                                      ['F'] = &a->outputs[FAP].path,
                                      ['W'] = &a->outputs[WAV].path};
        const char *name = c == 'l' ? "lang" : c == 'e' ? "engine" : at >= 0 ? options[at].name : "";
        const char *word = optarg ? optarg : "true";
        struct request_value value = {REQUEST_WORD, word, strlen(word), 0};
        if (c == 'h') {
            fputs(usage, stdout);
            return EXIT_DONE;
        }
        if (c == '?') {
            fputs("Try 'faccia align --help'.\n", stderr);
            return EXIT_USAGE;
        }
        if (c == 'X') {
            cli_lexicons_add(&a->lexicons, optarg);
        } else if (c == 'q') {
            a->progress = false;
        } else if (c == 'C') {
            a->certain = true;
        } else if ((size_t)c < sizeof texts / sizeof *texts && texts[c]) {
            *texts[c] = optarg;
        } else if (request_set(&a->request, name, value, &e)) {
            cli_complain("--%s", error_text(&e, message, sizeof message));
            return EXIT_USAGE;
        }
    }
    if (a->gender && strcmp(a->gender, "female") != 0 && strcmp(a->gender, "male") != 0) {
        cli_complain("--gender: must be female or male");
        return EXIT_USAGE;
    }
    if (optind + 1 != argc || (!a->text && !a->timing)) {
        cli_complain(optind + 1 != argc ? "exactly one sound file is needed"
                                        : "a --text or a --timing is needed");
        return EXIT_USAGE;
    }
    a->sound = argv[optind];
    return -1;
}

/* Chooses language and engine. Returns an exit code, or -1 to continue. */
static int choose(struct align *a) {
    if (!a->request.lang)
        a->request.lang = mem_strdup("it");
    a->pack = speech_packs_find(a->packs, a->request.lang);
    char text[SUGGESTIONS_TEXT];
    if (!a->pack) {
        struct suggestions near = suggestions_for(a->request.lang);
        for (size_t i = 0; i < a->packs->count; i++)
            suggest_name(&near, speech_pack_lang(a->packs->packs[i]), speech_pack_lang(a->packs->packs[i]));
        cli_complain("lang: unknown language '%s'%s", a->request.lang, suggestions_text(&near, text));
        return EXIT_USAGE;
    }
    if (!face_engine_speaks(a->request.engine, a->pack)) {
        struct suggestions near = suggestions_for(a->request.engine);
        suggest_names(&near, face_engines());
        cli_complain("engine: unknown engine '%s' for '%s'%s", a->request.engine, a->request.lang,
                     suggestions_text(&near, text));
        return EXIT_USAGE;
    }
    return -1;
}

int align_main(int argc, char **argv, const struct settings *settings) {
    struct align a = {.progress = isatty(STDERR_FILENO)};
    struct components components;
    request_init(&a.request);
    int status = parse(argc, argv, &a);
    if (status < 0) {
        if (!a.outputs[WAV].path && !a.outputs[FAP].path && !a.outputs[JSON].path)
            a.outputs[JSON].path = "-";
        if (cli_load(&components, cli_lexicons_with(&a.lexicons, settings),
                     COMPONENTS_SPEECH | COMPONENTS_NORMALIZATION, NULL)) {
            status = EXIT_FAILED;
        } else {
            a.packs = &components.packs;
            a.components = &components;
            status = choose(&a);
            status = status < 0 ? run(&a, settings) : status;
        }
        components_free(&components);
    }
    request_free(&a.request);
    cli_lexicons_free(&a.lexicons);
    return status;
}
