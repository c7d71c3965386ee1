/* SPDX-License-Identifier: GPL-3.0-or-later */
/* faccia hear: the face of anybody's voice, from the sound alone. */
#include "server/app/cli.h"
#include "server/app/cli_options.h"
#include "server/app/hear_write.h"
#include "server/base/mem.h"
#include "server/base/wav_file.h"
#include <errno.h>
#include <getopt.h>
#include <sndfile.h>
#include <stdlib.h>
#include <string.h>

static const char usage[] =
    "Usage: faccia hear [OPTION]... (SOUND | --raw RATE -)\n"
    "Moves the lips to a voice whose words nobody knows, as it goes on: SOUND is a recording (WAV, FLAC, "
    "Ogg, "
    "MP3); with\n"
    "--raw it is standard input, 16 bit samples as a microphone gives them:\n"
    "arecord -f S16_LE -r 16000 -t raw | faccia hear --raw 16000 -\n"
    "Where the text is known 'faccia align' is the better way. Without a file to write, lines of JSON go to "
    "standard output. In a room of a daemon: faccia-live.\n"
    "\n"
    "  -l, --lang TAG       whose lips: it, pt-BR, tr, en or any other (it)\n"
    "      --lookahead MS   what is heard after a moment before it is shown: 0, 40, 80 or 120 (80)\n"
    "      --raw RATE       of standard input, 8000 to 96000 samples a second\n"
    "      --channels N     of standard input, 1 to 8 (1)\n"
    "      --fps N          FAP frames per second, 1 to 120 (25)\n"
    "  -e, --engine NAME    what moves the mouth: network, or the engine dominance, cohen-massaro or table "
    "(network)\n"
    "      --fap FILE       the face, MPEG-4 FAPs as text (version 2.1)\n"
    "      --json FILE      the sounds by what is seen of them, with their times and how likely each was\n"
    "      --ndjson FILE    a line for each of them and each frame, as they come\n"
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

/* How many frames have been read; 0 at the end. */
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
        cli_complain("%s: there is no sound in it", h->sound);
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
        cli_complain("%s: %s", h->sound, sf_strerror(NULL));
        return -1;
    }
    h->raw = info.samplerate;
    h->channels = info.channels;
    return 0;
}

static int run(struct hear *h, const struct stages *stages, const struct settings *settings) {
    struct error e;
    char path[4096], text[400];
    const struct speech_pack *pack = speech_packs_find(&stages->packs, h->lang);
    if (!pack || !lip_face_speaks(h->engine, pack)) {
        cli_complain(pack ? "engine: no engine '%s'" : "lang: no language '%s'", pack ? h->engine : h->lang);
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
    cli_complain("--%s: the text '%s' is not used here: with a text 'faccia align SOUND --text FILE' is the "
                 "better way",
                 name, text);
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
        cli_complain(h.sound ? "--raw and - belong together" : "one sound is needed");
        return EXIT_USAGE;
    }
    struct stages stages;
    status = cli_load(&stages, settings, STAGES_SPEECH, NULL) ? EXIT_FAILED : run(&h, &stages, settings);
    stages_free(&stages);
    return status;
}
