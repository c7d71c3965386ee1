/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "protocol/fapfile.h"
#include "server/base/mem.h"
#include "server/base/sound/wav_file.h"
#include "server/cli/cli.h"
#include "server/live/lip_features.h"
#include "server/live/lip_recogniser.h"
#include <errno.h>
#include <getopt.h>
#include <sndfile.h>
#include <stdlib.h>
#include <string.h>

/* ---- output, while the sound is heard ---- */

struct lip_output {
    const char *path; /* NULL: not requested */
    struct cli_file file;
};

/* The caller sets the paths. */
struct hear_write {
    struct lip_output fap, json, lines;
    FILE *frames; /* frames of the .fap, whose first line needs their number */
    uint32_t frame_count;
    double fps;
    size_t phones;
};

/* Less likely classes of a sound are omitted. */
#define LEAST_LIKELY 0.005

static struct lip_output *const *outputs_of(struct hear_write *w, struct lip_output *list[3]) {
    list[0] = &w->fap;
    list[1] = &w->json;
    list[2] = &w->lines;
    return list;
}

/* Without any path the lines go to standard output. -1 after a message, as for the functions below. */
static int hear_write_begin(struct hear_write *w, const char *lang, double fps, int lookahead) {
    struct lip_output *list[3];
    int standard = 0;
    if (!w->fap.path && !w->json.path && !w->lines.path)
        w->lines.path = "-";
    outputs_of(w, list);
    for (int i = 0; i < 3; i++) {
        standard += list[i]->path && !strcmp(list[i]->path, "-");
        if (list[i]->path && cli_create(&list[i]->file, list[i]->path))
            return -1;
    }
    if (standard > 1) {
        cli_complain("only one file can go to standard output");
        return -1;
    }
    w->fps = fps;
    if (w->fap.path && !(w->frames = tmpfile())) {
        cli_complain("a temporary file: %s", strerror(errno));
        return -1;
    }
    if (w->json.path)
        fprintf(w->json.file.file, "{\"lang\":\"%s\",\"fps\":%g,\"lookahead\":%g,\n \"phones\":[", lang, fps,
                lookahead / 1000.0);
    return 0;
}

/* Callback of a hearing; ctx is the hear_write. */
static void hear_write_frame(void *ctx, uint32_t k, const struct fap_frame *frame) {
    struct hear_write *w = ctx;
    char text[4096];
    w->frame_count = k + 1;
    if (w->frames) {
        fapfile_write_frame(frame, k, text, sizeof text);
        fputs(text, w->frames);
    }
    if (!w->lines.path)
        return;
    FILE *out = w->lines.file.file;
    const char *comma = "";
    fprintf(out, "{\"type\":\"frame\",\"frame\":%u,\"time\":%.6g,\"faps\":{", k, k / w->fps);
    for (int n = 3; n <= FAP_COUNT; n++)
        if (fap_frame_has(frame, n) && frame->value[n]) {
            fprintf(out, "%s\"%d\":%d", comma, n, (int)frame->value[n]);
            comma = ",";
        }
    fputs("}}\n", out);
}

static void hear_write_phone(void *ctx, const struct lip_phone *p) {
    struct hear_write *w = ctx;
    char text[600];
    int size =
        snprintf(text, sizeof text,
                 "\"class\":\"%s\",\"ipa\":\"%s\",\"start\":%.4f,\"end\":%.4f,\"sure\":%.2f,\"likely\":{",
                 lip_classes[p->class].name, lip_classes[p->class].ipa, hear_seconds(p->start),
                 hear_seconds(p->end), p->likely[p->class] / (p->end - p->start));
    for (int i = 0, any = 0; i < LIP_CLASSES; i++) {
        double mean = p->likely[i] / (p->end - p->start);
        if (mean >= LEAST_LIKELY)
            size += snprintf(text + size, sizeof text - (size_t)size, "%s\"%s\":%.2f", any++ ? "," : "",
                             lip_classes[i].name, mean);
    }
    snprintf(text + size, sizeof text - (size_t)size, "}}");
    if (w->json.path)
        fprintf(w->json.file.file, "%s\n  {%s", w->phones ? "," : "", text);
    if (w->lines.path)
        fprintf(w->lines.file.file, "{\"type\":\"phone\",%s\n", text);
    w->phones++;
}

static int hear_write_flush(struct hear_write *w) {
    struct lip_output *list[3];
    outputs_of(w, list);
    for (int i = 0; i < 3; i++)
        if (list[i]->path && (fflush(list[i]->file.file) || ferror(list[i]->file.file))) {
            cli_complain("%s: %s", list[i]->path, strerror(errno));
            return -1;
        }
    return 0;
}

/* Writes the header, then the buffered frames. */
static int write_fap(struct hear_write *w) {
    char text[4096];
    fapfile_write_header("faccia", w->fps, w->frame_count, text, sizeof text);
    fputs(text, w->fap.file.file);
    rewind(w->frames);
    for (size_t n; (n = fread(text, 1, sizeof text, w->frames));)
        fwrite(text, 1, n, w->fap.file.file);
    if (!ferror(w->frames))
        return 0;
    cli_complain("a temporary file: %s", strerror(errno));
    return -1;
}

static int hear_write_end(struct hear_write *w) {
    if (w->json.path)
        fputs("\n ]}\n", w->json.file.file);
    return (w->fap.path && write_fap(w)) || hear_write_flush(w) ? -1 : 0;
}

static int hear_write_close(struct hear_write *w, bool well) {
    struct lip_output *list[3];
    int status = 0;
    outputs_of(w, list);
    for (int i = 0; i < 3; i++)
        status |= cli_finish(&list[i]->file, well && list[i]->path);
    if (w->frames)
        fclose(w->frames);
    return status;
}

/* faccia hear: makes the face for any voice from its sound alone. */

static const char usage[] =
    "Usage: faccia hear [OPTION]... (SOUND | --raw RATE -)\n"
    "Moves the lips to speech without a transcript, as it arrives: SOUND is a recording (WAV, FLAC, Ogg, "
    "MP3); with\n"
    "--raw, 16-bit samples from standard input, for example from a microphone:\n"
    "arecord -f S16_LE -r 16000 -t raw | faccia hear --raw 16000 -\n"
    "With a transcript, 'faccia align' is more accurate. Without an output file, lines of JSON go to "
    "standard output. For a room of a daemon see faccia-live.\n"
    "\n"
    "  -l, --lang TAG       language of the lip movements: it, pt-BR, tr, en or any other (it)\n"
    "      --lookahead MS   sound heard beyond a moment before its lips are shown: 0, 40, 80 or 120 (80)\n"
    "      --raw RATE       sample rate of standard input, 8000 to 96000 Hz\n"
    "      --channels N     channels of standard input, 1 to 8 (1)\n"
    "      --fps N          FAP frames per second, 1 to 120 (25)\n"
    "  -e, --engine NAME    what moves the mouth: network, or the engine dominance, cohen-massaro or table "
    "(network)\n"
    "      --fap FILE       the face, as MPEG-4 FAPs (text, version 2.1)\n"
    "      --json FILE      the recognised visible sounds, with their times and probabilities\n"
    "      --ndjson FILE    a line for each sound and each frame, as they arrive\n"
    "  -h, --help           print this and exit\n"
    "FILE - is standard output. Exit status: 0 done, 1 failed, 2 wrong usage.\n";

enum { BLOCK = 1024, CHANNELS_READ = 16 };

struct hear {
    const char *lang, *engine, *sound;
    int lookahead, raw, channels;
    double fps;
    SNDFILE *file; /* NULL: standard input */
    struct hear_write write;
};

/* Returns the number of frames read; 0 at the end. */
static size_t read_block(const struct hear *h, float *samples) {
    int16_t raw[BLOCK * LIP_CHANNELS_MOST];
    if (h->file) {
        sf_count_t got = sf_readf_float(h->file, samples, BLOCK);
        return got > 0 ? (size_t)got : 0;
    }
    size_t channels = (size_t)h->channels, got = fread(raw, sizeof *raw * channels, BLOCK / 8, stdin);
    for (size_t i = 0; i < got * channels; i++)
        samples[i] = (float)raw[i] / 32768;
    return got;
}

static int hear_all(struct hear *h, struct lip_recogniser *recogniser) {
    float *samples = mem_alloc(sizeof *samples * BLOCK * CHANNELS_READ);
    size_t heard = 0;
    int status = 0;
    for (size_t got; !status && (got = read_block(h, samples)); heard += got) {
        lip_recogniser_write(recogniser, samples, got);
        status = hear_write_flush(&h->write);
    }
    free(samples);
    if (!heard) {
        cli_complain("%s: contains no sound", h->sound);
        return -1;
    }
    lip_recogniser_end(recogniser);
    return status ? status : hear_write_end(&h->write);
}

static int open_sound(struct hear *h) {
    SF_INFO info = {0};
    if (h->raw)
        return 0;
    h->file = wav_file_open(h->sound, &info);
    if (!h->file) {
        cli_complain("%s: %s", h->sound, wav_file_error());
        return -1;
    }
    h->raw = info.samplerate;
    h->channels = info.channels;
    return 0;
}

static int run(struct hear *h, const struct components *components, const struct settings *settings) {
    struct error e;
    char path[4096], text[400];
    const struct speech_pack *pack = speech_packs_find(&components->packs, h->lang);
    if (!pack || !lip_face_speaks(h->engine, pack)) {
        cli_complain(pack ? "engine: unknown engine '%s'" : "lang: unknown language '%s'",
                     pack ? h->engine : h->lang);
        return EXIT_USAGE;
    }
    snprintf(path, sizeof path, "%s/hear/network.bin", settings->models);
    struct lip_network *network = lip_network_load(path, &e);
    if (!network) {
        cli_complain("%s: %s", path, error_text(&e, text, sizeof text));
        return EXIT_FAILED;
    }
    int status = EXIT_FAILED;
    if (!open_sound(h)) {
        const struct lip_recogniser_options options = {.network = network,
                                                       .pack = pack,
                                                       .engine = h->engine,
                                                       .rate = (unsigned)h->raw,
                                                       .channels = (unsigned)h->channels,
                                                       .lookahead = (unsigned)h->lookahead,
                                                       .fps = h->fps,
                                                       .frame = hear_write_frame,
                                                       .phone = hear_write_phone,
                                                       .ctx = &h->write};
        struct lip_recogniser *recogniser = lip_recogniser_new(&options, &e);
        bool well = false;
        if (!recogniser) {
            cli_complain("%s: %s", h->sound, error_text(&e, text, sizeof text));
            status = e.code == ERROR_BAD_FIELD ? EXIT_USAGE : EXIT_FAILED;
        } else if (!hear_write_begin(&h->write, speech_pack_lang(pack), h->fps, h->lookahead)) {
            well = !hear_all(h, recogniser);
        }
        if (!hear_write_close(&h->write, well) && well)
            status = EXIT_DONE;
        lip_recogniser_free(recogniser);
    }
    if (h->file)
        sf_close(h->file);
    lip_network_free(network);
    return status;
}

static int on_text(void *ctx, const char *name, const char *text) {
    (void)ctx;
    cli_complain(
        "--%s: the text '%s' is not used here: with a transcript, use 'faccia align SOUND --text FILE'", name,
        text);
    return EXIT_USAGE;
}

int hear_main(int argc, char **argv, const struct settings *settings) {
    struct hear h = {.lang = "it", .lookahead = 80, .channels = 1, .fps = 25};
    const struct cli_option options[] = {{"lang", 'l', CLI_TEXT, .out = &h.lang},
                                         {"lookahead", 0, CLI_WHOLE, &h.lookahead, 0, 1000, NULL},
                                         {"raw", 0, CLI_WHOLE, &h.raw, LIP_RATE_LEAST, LIP_RATE_MOST, NULL},
                                         {"channels", 0, CLI_WHOLE, &h.channels, 1, LIP_CHANNELS_MOST, NULL},
                                         {"fps", 0, CLI_NUMBER, &h.fps, 1, 120, NULL},
                                         {"engine", 'e', CLI_TEXT, .out = &h.engine},
                                         {"fap", 0, CLI_TEXT, .out = &h.write.fap.path},
                                         {"json", 0, CLI_TEXT, .out = &h.write.json.path},
                                         {"ndjson", 0, CLI_TEXT, .out = &h.write.lines.path},
                                         {"text", 0, CLI_CALL, .take = on_text},
                                         {"voice-file", 0, CLI_TEXT, .out = &h.sound},
                                         {0}};
    int status = cli_options(argc, argv, usage, options, NULL);
    if (status >= 0)
        return status;
    if (h.sound && optind < argc)
        return on_text(NULL, "voice-file", argv[optind]);
    if (!h.sound && optind + 1 == argc)
        h.sound = argv[optind];
    if (!h.sound || (!strcmp(h.sound, "-") != !!h.raw)) {
        cli_complain(h.sound ? "--raw and - belong together" : "exactly one sound file is needed");
        return EXIT_USAGE;
    }
    struct components components;
    status = cli_load(&components, settings, COMPONENTS_SPEECH, NULL) ? EXIT_FAILED
                                                                      : run(&h, &components, settings);
    components_free(&components);
    return status;
}
