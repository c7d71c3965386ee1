/* SPDX-License-Identifier: GPL-3.0-or-later */
/* faccia stimuli: a listening test, speech in noise with and without a face (after Costa, MSc thesis, UNICAMP
 * 2009, chapter 6). */
#include "protocol/fapfile.h"
#include "server/app/stimuli_kit.h"
#include "server/base/mem.h"
#include <getopt.h>
#include <stdlib.h>
#include <string.h>

static const char usage[] =
    "Usage: faccia stimuli --out DIR [OPTION]...\n"
    "Makes a listening test in DIR: every word of a set, in a carrier sentence and in noise, as WAV; the "
    "face that speaks it,\n"
    "as FAPs; manifest.json, which lists all; and index.html, a page that presents them in random order and "
    "saves the\n"
    "answers as CSV for 'faccia anova'. The page needs a running facciad for the head model.\n"
    "Each word comes in three modes: sound alone, and with the face of two engines (or a still face) at the "
    "same sound.\n"
    "\n"
    "  -o, --out DIR        where to; made if it is not there\n"
    "  -v, --voice ID       a voice that 'faccia voices' lists (the language's first)\n"
    "  -r, --rate WPM       words per minute, 40 to 500\n"
    "  -e, --engine NAME    of the second and, given again, of the third mode; 'still' is a face at rest "
    "(the first two\n"
    "                       engines there are)\n"
    "      --faces LIST     who is seen, with commas between: 'head'; 'pictures' or 'pictures:FILE', a set "
    "of "
    "pictures (the\n"
    "                       daemon's, or a file) moved by the first engine; 'video:DIR', films of a real "
    "speaker with their\n"
    "                       own sound: DIR/WORD.mp4 or .webm, WORD.wav, and words.json, {\"WORD\": "
    "{\"start\": S, \"end\": S}} (head)\n"
    "      --fps N          FAP frames per second, 1 to 120 (50)\n"
    "      --seed N         another noise (0)\n"
    "      --set FILE       the words (models/stimuli/pt-BR.json: 27 words of two syllables, -12, -18, -24 "
    "dB)\n"
    "      --server URL     where the page looks for facciad (http://127.0.0.1:8080)\n"
    "  -h, --help           print this and exit\n"
    "Exit status: 0 made, 1 failed, 2 wrong usage.\n";

static void on_segment(void *ctx, struct media_segment segment) {
    struct kit *kit = ctx;
    media_segment_free(&kit->segment);
    kit->segment = segment;
    synthesis_release(kit->synthesis);
}

static void on_problem(void *ctx, const struct error *e, bool warning) {
    struct kit *kit = ctx;
    char text[400];
    cli_complain("%s%s", warning ? "warning: " : "", error_text(e, text, sizeof text));
    kit->failed |= !warning;
}

static void on_finished(void *ctx, size_t spoken) {
    struct kit *kit = ctx;
    kit->finished = true;
    if (spoken != 1 && !kit->failed) {
        cli_complain("carrier: must be one sentence");
        kit->failed = true;
    }
}

static int speak_item(struct kit *kit, size_t number) {
    static const struct synthesis_callbacks callbacks = {on_segment, on_problem, on_finished};
    struct error e;
    char message[400], *text = stimuli_sentence(&kit->set, &kit->set.items[number]);
    request_set(&kit->request, "text", (struct request_value){REQUEST_STRING, text, strlen(text), 0}, &e);
    free(text);
    kit->finished = false;
    kit->synthesis = synthesis_open(&kit->cli.stages.pipeline, &kit->request, &callbacks, kit, &e);
    if (!kit->synthesis) {
        cli_complain("%s", error_text(&e, message, sizeof message));
        return e.place == PLACE_FIELD ? EXIT_USAGE : EXIT_FAILED;
    }
    kit->voice = synthesis_voice(kit->synthesis)->id;
    synthesis_start(kit->synthesis);
    while (!kit->finished && uv_run(&kit->cli.loop, UV_RUN_ONCE))
        ;
    int status = kit->failed || kit_item(kit, number) ? EXIT_FAILED : EXIT_DONE;
    media_segment_free(&kit->segment);
    synthesis_free(kit->synthesis);
    return status;
}

/* Those named must be able to speak the set; the others are the first engines that can, then the still face.
 */
static int choose_faces(struct kit *kit) {
    char *text = stimuli_sentence(&kit->set, &kit->set.items[0]), message[400];
    struct error e;
    int status = EXIT_DONE;
    request_set(&kit->request, "text", (struct request_value){REQUEST_STRING, text, strlen(text), 0}, &e);
    free(text);
    for (size_t i = 0; !status && i < kit->face_count; i++) {
        if (kit->faces[i] == kit_still || !cli_try_engine(&kit->cli, &kit->request, kit->faces[i], &e))
            continue;
        cli_complain("%s", error_text(&e, message, sizeof message));
        status = e.place == PLACE_FIELD ? EXIT_USAGE : EXIT_FAILED;
    }
    for (const char *const *engine = face_engines(); *engine && kit->face_count < KIT_FACES; engine++)
        if ((!kit->face_count || kit->faces[0] != *engine) &&
            !cli_try_engine(&kit->cli, &kit->request, *engine, &e))
            kit->faces[kit->face_count++] = *engine;
    if (kit->face_count < KIT_FACES && (!kit->face_count || kit->faces[0] != kit_still))
        kit->faces[kit->face_count++] = kit_still;
    return status;
}

static int make(struct kit *kit) {
    char path[4096], text[400];
    struct error e;
    snprintf(path, sizeof path, "%s/stimuli/pt-BR.json", kit->settings->models);
    const char *set_path = kit->set_path ? kit->set_path : path;
    if (stimuli_set_load(&kit->set, set_path, &e)) {
        cli_complain("%s: %s", set_path, error_text(&e, text, sizeof text));
        return EXIT_FAILED;
    }
    if (!kit->request.voice)
        kit->request.lang = mem_strdup(kit->set.lang);
    int status = choose_faces(kit);
    if (status)
        return status;
    if (stimuli_faces_load(&kit->shown, &kit->set))
        return EXIT_FAILED;
    if (kit_folder(kit, "") || (kit->shown.films && kit_folder(kit, "video")) || kit_folder(kit, "wav") ||
        kit_folder(kit, "fap"))
        return EXIT_FAILED;
    kit->items = json_array();
    kit->trials = json_array();
    kit->films = json_object();
    for (size_t i = 0; !status && i < kit->set.item_count; i++)
        status = speak_item(kit, i);
    if (!status && kit_page(kit))
        status = EXIT_FAILED;
    if (!status)
        printf("%s/index.html: %zu trials\n", kit->out, json_array_size(kit->trials));
    return status;
}

static int add_face(struct kit *kit, const char *name) {
    const char *const *engine = face_engines();
    while (*engine && strcmp(*engine, name) != 0)
        engine++;
    const char *face = *engine ? *engine : !strcmp(name, kit_still) ? kit_still : NULL;
    if (!face) {
        cli_complain("engine: no engine '%s'", name);
        return EXIT_USAGE;
    }
    if (kit->face_count == KIT_FACES || (kit->face_count && kit->faces[0] == face)) {
        cli_complain("--engine: at most %d, and different ones", KIT_FACES);
        return EXIT_USAGE;
    }
    kit->faces[kit->face_count++] = face;
    return -1;
}

/* The exit code, or -1 to go on. */
static int parse(int argc, char **argv, struct kit *kit) {
    static const struct option options[] = {
        {"out", 1, NULL, 'o'},
        {"voice", 1, NULL, 'v'},
        {"rate", 1, NULL, 'r'},
        {"engine", 1, NULL, 'e'},
        {"fps", 1, NULL, 'p'},
        {"seed", 1, NULL, 's'},
        {"set", 1, NULL, 'S'},
        {"server", 1, NULL, 'u'},
        {"help", 0, NULL, 'h'},
        {"faces", 1, NULL, 'f'},
        {0},
    };
    struct error e;
    char message[400], *faces = NULL;
    int status = -1;
    for (int c; status < 0 && (c = getopt_long(argc, argv, "o:v:r:e:h", options, NULL)) != -1;) {
        const char *field = c == 'v'   ? "voice"
                            : c == 'r' ? "rate"
                            : c == 'p' ? "fps"
                            : c == 's' ? "seed"
                                       : NULL;
        if (field) {
            struct request_value value = {REQUEST_WORD, optarg, strlen(optarg), 0};
            if (!request_set(&kit->request, field, value, &e))
                continue;
            cli_complain("--%s", error_text(&e, message, sizeof message));
            return EXIT_USAGE;
        }
        switch (c) {
        case 'o':
            kit->out = optarg;
            break;
        case 'e':
            status = add_face(kit, optarg);
            break;
        case 'S':
            kit->set_path = optarg;
            break;
        case 'f':
            faces = optarg;
            break;
        case 'u':
            kit->server = optarg;
            break;
        case 'h':
            fputs(usage, stdout);
            return EXIT_DONE;
        default:
            fputs("Try 'faccia stimuli --help'.\n", stderr);
            return EXIT_USAGE;
        }
    }
    if (status < 0 && stimuli_faces_parse(&kit->shown, faces))
        status = EXIT_USAGE;
    if (status < 0 && (optind < argc || !kit->out)) {
        cli_complain(kit->out ? "unexpected '%s'" : "no folder: give --out", argv[optind]);
        status = EXIT_USAGE;
    }
    return status;
}

int stimuli_main(int argc, char **argv, const struct settings *settings) {
    struct kit kit = {.settings = settings, .server = "http://127.0.0.1:8080"};
    request_init(&kit.request);
    kit.request.seed = 0;
    kit.request.fps = 50;
    int status = parse(argc, argv, &kit);
    if (status < 0) {
        status = cli_open(&kit.cli, settings) ? EXIT_FAILED : make(&kit);
        cli_close(&kit.cli);
    }
    json_decref(kit.items);
    json_decref(kit.trials);
    json_decref(kit.films);
    stimuli_faces_free(&kit.shown);
    stimuli_set_free(&kit.set);
    request_free(&kit.request);
    return status;
}
