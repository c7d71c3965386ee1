/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "protocol/fapfile.h"
#include "server/base/buf.h"
#include "server/base/json/error_json.h"
#include "server/base/mem.h"
#include "server/base/options.h"
#include "server/cli/cli.h"
#include "server/research/listening/stimuli_set.h"
#include <errno.h>
#include <sndfile.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include <unistd.h>

/* ---- files of a listening test, see models/stimuli/README.md ---- */

enum { KIT_FACES = 2 };

/* Stands for a face at rest, in place of an engine. */
extern const char kit_still[];

struct kit {
    const struct settings *settings;
    struct cli cli;
    struct stimuli_set set;
    struct speech_request request;
    struct synthesis *synthesis;
    const char *out, *set_path, *server;
    const char *faces[KIT_FACES]; /* engines, or kit_still */
    size_t face_count;
    struct stimuli_faces shown;
    json_t *items, *trials, *films; /* for the manifest; the films are for the page only */
    struct media_segment segment;   /* of the current item */
    const char *voice;
    bool finished, failed;
};

/* ---- the page: a template, its data, and the client that draws the face ---- */

/* Escapes "<" where "</" or "<!--" occur: in scripts and JSON that is only inside strings. */
static void add_script(struct buf *out, const struct buf *script) {
    for (size_t i = 0; i < script->size; i++) {
        const char *at = (const char *)script->data + i;
        size_t rest = script->size - i;
        if ((rest >= 8 && !strncasecmp(at, "</script", 8)) || (rest >= 4 && !memcmp(at, "<!--", 4)) ||
            (rest >= 7 && !strncasecmp(at, "<script", 7)))
            buf_add(out, "\\u003c", 6);
        else
            buf_add(out, at, 1);
    }
}

/* Appends the template with {{data}} and {{bundle}} replaced, so that neither ends its script element. */
static void stimuli_page(const struct buf *template, const struct buf *data, const struct buf *bundle,
                         struct buf *out) {
    static const char data_place[] = "{{data}}", bundle_place[] = "{{bundle}}";
    for (size_t i = 0; i < template->size;) {
        const char *at = (const char *)template->data + i;
        size_t rest = template->size - i;
        if (rest >= sizeof data_place - 1 && !memcmp(at, data_place, sizeof data_place - 1)) {
            add_script(out, data);
            i += sizeof data_place - 1;
        } else if (rest >= sizeof bundle_place - 1 && !memcmp(at, bundle_place, sizeof bundle_place - 1)) {
            add_script(out, bundle);
            i += sizeof bundle_place - 1;
        } else {
            buf_add(out, at, 1);
            i++;
        }
    }
}

enum { PATH_BYTES = 4096 };

const char kit_still[] = "still";

/* Sample range of the item: the phones of the last word. Cuts of words and phones differ slightly, so a
 * phone belongs to the word that contains its middle. */
static void item_range(const struct sentence_audio *u, size_t *from, size_t *to) {
    const struct word *last = u->word_count ? &u->words[u->word_count - 1] : NULL;
    *from = *to = 0;
    for (size_t i = 0; i < u->phone_count; i++) {
        const struct phone *p = &u->phones[i];
        size_t middle = p->start + (p->end - p->start) / 2;
        if (!p->ipa[0] || (last && (middle < last->start || middle >= last->end)))
            continue;
        *from = *to ? *from : p->start;
        *to = p->end;
    }
}

/* Joins folder and name. */
static const char *in_folder(const struct kit *kit, const char *name, char path[PATH_BYTES]) {
    snprintf(path, PATH_BYTES, "%s/%s", kit->out, name);
    return path;
}

static int write_file(const struct kit *kit, const char *name, const struct buf *content) {
    char path[PATH_BYTES];
    struct cli_file file;
    if (cli_create(&file, in_folder(kit, name, path)))
        return -1;
    fwrite(content->data, 1, content->size, file.file);
    return cli_finish(&file, true);
}

static int write_wav(const struct kit *kit, const char *name, const int16_t *pcm, size_t samples,
                     unsigned rate) {
    char path[PATH_BYTES];
    SF_INFO info = {.samplerate = (int)rate, .channels = 1, .format = SF_FORMAT_WAV | SF_FORMAT_PCM_16};
    struct cli_file file;
    if (cli_create(&file, in_folder(kit, name, path)))
        return -1;
    SNDFILE *sound = sf_open_fd(fileno(file.file), SFM_WRITE, &info, SF_FALSE);
    bool failed = !sound || sf_write_short(sound, pcm, (sf_count_t)samples) != (sf_count_t)samples;
    if (failed)
        cli_complain("%s: %s", path, sf_strerror(sound));
    failed |= sound && sf_close(sound) != 0;
    return cli_finish(&file, !failed);
}

/* A track of the item only: the lips rest during the carrier, so that they reveal nothing but the item. */
static struct face_track *item_track(const struct kit *kit, const char *engine, size_t from) {
    const struct sentence_audio *u = kit->segment.audio;
    struct sentence_audio alone = *u;
    struct face_options options = {.engine = engine, .still = true};
    alone.phones = mem_alloc((u->phone_count + 1) * sizeof *alone.phones);
    alone.phone_count = 0;
    if (from)
        alone.phones[alone.phone_count++] =
            (struct phone){.sampa = "_", .symbol = "_", .end = (uint32_t)from};
    for (size_t i = 0; i < u->phone_count; i++)
        if (u->phones[i].end > from)
            alone.phones[alone.phone_count++] = u->phones[i];
    if (u->word_count) { /* some engines need words */
        alone.words = &u->words[u->word_count - 1];
        alone.word_count = 1;
    }
    const struct speech_pack *pack =
        speech_packs_find(&kit->cli.components.packs, synthesis_lang(kit->synthesis));
    struct face_track *track = face_track_new(pack, &alone, &options, NULL, NULL);
    free(alone.phones);
    return track;
}

/* Encodes the frames for the page: the FAPs that move, and their values. */
static json_t *film_of(const struct fap_frame *frames, size_t count, double fps) {
    json_t *faps = json_array(), *rows = json_array();
    bool moves[FAP_COUNT + 1] = {false};
    for (int n = 3; n <= FAP_COUNT; n++) {
        for (size_t i = 0; i < count; i++)
            moves[n] |= frames[i].value[n] != 0;
        if (moves[n])
            json_array_append_new(faps, json_integer(n));
    }
    for (size_t i = 0; i < count; i++) {
        json_t *row = json_array();
        for (int n = 3; n <= FAP_COUNT; n++)
            if (moves[n])
                json_array_append_new(row, json_integer(frames[i].value[n]));
        json_array_append_new(rows, row);
    }
    return json_pack("{sf so so}", "fps", fps, "faps", faps, "frames", rows);
}

static int write_face(struct kit *kit, const char *name, const char *engine, size_t from) {
    const struct sentence_audio *u = kit->segment.audio;
    size_t count = frame_from_sample(u->samples, u->sample_rate, kit->request.fps), room = 2048;
    struct fap_frame *frames = mem_alloc((count + 1) * sizeof *frames);
    struct face_track *track = item_track(kit, engine, from);
    struct buf out = {0};
    out.size = fapfile_write_header("faccia", kit->request.fps, count, buf_reserve(&out, room), room);
    for (size_t i = 0; i < count; i++) {
        face_track_sample(track, (double)i / kit->request.fps, &frames[i]);
        size_t length = fapfile_write_frame(&frames[i], i, buf_reserve(&out, room), room);
        if (length >= room)
            fapfile_write_frame(&frames[i], i, buf_reserve(&out, length + 1), length + 1);
        out.size += length;
    }
    json_object_set_new(kit->films, name, film_of(frames, count, kit->request.fps));
    int failed = write_file(kit, name, &out);
    face_track_free(track);
    buf_free(&out);
    free(frames);
    return failed;
}

static json_t *phones_of(const struct sentence_audio *u, size_t from) {
    json_t *list = json_array();
    for (size_t i = 0; i < u->phone_count; i++)
        if (u->phones[i].end > from && u->phones[i].ipa[0])
            json_array_append_new(list, json_string(u->phones[i].ipa));
    return list;
}

/* First face that moves, which pictures show; NULL: none. */
static const char *pictured(const struct kit *kit, size_t *number) {
    for (*number = 0; *number < kit->face_count; ++*number)
        if (kit->faces[*number] != kit_still)
            return kit->faces[*number];
    return NULL;
}

static void add_trial(struct kit *kit, const char *item, const char *mode, double snr, const char *wav,
                      const char *key, const char *file) {
    json_t *trial = json_pack("{ss ss sf ss}", "item", item, "mode", mode, "snr", snr, "wav", wav);
    if (key)
        json_object_set_new(trial, key, json_string(file));
    json_array_append_new(kit->trials, trial);
}

static uint64_t seed_of(const struct kit *kit, size_t number, size_t ratio) {
    return (uint64_t)kit->request.seed * 1000003u + number * kit->set.snr_count + ratio;
}

static int copy_film(const struct kit *kit, const char *name, const char *file) {
    char path[PATH_BYTES];
    struct buf film = {0};
    snprintf(path, sizeof path, "%s/%s", kit->shown.films, file);
    int failed = cli_read(path, &film) || write_file(kit, name, &film);
    buf_free(&film);
    return failed;
}

/* Adds the film of an item, its sound at each ratio, and its trials. */
static int add_film(struct kit *kit, size_t number) {
    const char *item = kit->set.items[number].name;
    struct stimuli_film film;
    char wav[80], name[80];
    if (stimuli_film_load(&kit->shown, item, &film))
        return -1;
    snprintf(name, sizeof name, "video/%s", film.file);
    int16_t *mixed = mem_alloc((film.samples + 1) * sizeof *mixed);
    int failed = copy_film(kit, name, film.file);
    for (size_t i = 0; i < kit->set.snr_count && !failed; i++) {
        double snr = kit->set.snrs[i];
        snprintf(wav, sizeof wav, "wav/%s_video_%gdB.wav", item, snr);
        failed = !noise_mix(film.pcm, film.samples, film.from, film.to, snr, seed_of(kit, number, i), mixed);
        if (failed)
            cli_complain("%s/%s.wav: silent where the word should be", kit->shown.films, item);
        failed = failed || write_wav(kit, wav, mixed, film.samples, film.sample_rate);
        add_trial(kit, item, "video", snr, wav, "video", name);
    }
    free(mixed);
    free(film.pcm);
    return failed;
}

/* Writes the spoken item's faces and its sound at each ratio, and adds its trials. -1 after a message. */
static int kit_item(struct kit *kit, size_t number) {
    const struct stimuli_item *item = &kit->set.items[number];
    const struct sentence_audio *u = kit->segment.audio;
    int16_t *mixed = mem_alloc((u->samples + 1) * sizeof *mixed);
    char wav[80], fap[KIT_FACES][120];
    size_t from, to, first;
    int failed = 0;
    const char *moving = pictured(kit, &first);
    item_range(u, &from, &to);
    json_array_append_new(
        kit->items, json_pack("{ss ss so sf sf sf}", "name", item->name, "text", item->text, "phones",
                              phones_of(u, from), "start", (double)from / u->sample_rate, "end",
                              (double)to / u->sample_rate, "duration", (double)u->samples / u->sample_rate));
    for (size_t i = 0; i < kit->face_count && !failed; i++) {
        snprintf(fap[i], sizeof fap[i], "fap/%s_%s.fap", item->name, kit->faces[i]);
        if (kit->faces[i] != kit_still && (kit->shown.head || (kit->shown.pictures && i == first)))
            failed = write_face(kit, fap[i], kit->faces[i], from);
    }
    for (size_t i = 0; i < kit->set.snr_count && !failed; i++) {
        double snr = kit->set.snrs[i];
        snprintf(wav, sizeof wav, "wav/%s_%gdB.wav", item->name, snr);
        if (!noise_mix(u->pcm, u->samples, from, to, snr, seed_of(kit, number, i), mixed)) {
            cli_complain("%s: the voice produced no sound", item->name);
            failed = -1;
            break;
        }
        failed = write_wav(kit, wav, mixed, u->samples, u->sample_rate);
        add_trial(kit, item->name, "audio", snr, wav, NULL, NULL);
        for (size_t k = 0; k < kit->face_count && kit->shown.head; k++)
            add_trial(kit, item->name, kit->faces[k], snr, wav, kit->faces[k] == kit_still ? NULL : "fap",
                      fap[k]);
        if (kit->shown.pictures)
            add_trial(kit, item->name, "pictures", snr, wav, moving ? "fap" : NULL, fap[first]);
    }
    if (!failed && kit->shown.films)
        failed = add_film(kit, number);
    free(mixed);
    return failed;
}

static json_t *mode(const char *name, const char *kind) {
    return json_pack("{ss ss}", "name", name, "kind", kind);
}

static json_t *manifest_of(struct kit *kit) {
    json_t *modes = json_array();
    json_array_append_new(modes, mode("audio", "audio"));
    for (size_t i = 0; i < kit->face_count && kit->shown.head; i++)
        json_array_append_new(modes, mode(kit->faces[i], kit->faces[i] == kit_still ? "still" : "face"));
    if (kit->shown.pictures)
        json_array_append_new(modes, mode("pictures", "pictures"));
    if (kit->shown.films)
        json_array_append_new(modes, mode("video", "video"));
    return json_pack("{ss ss ss ss sf sf so sO sO sO sO}", "faccia", "stimuli 1", "lang", kit->set.lang,
                     "voice", kit->voice, "carrier", kit->set.carrier, "fps", kit->request.fps, "seed",
                     kit->request.seed, "modes", modes, "snrs", json_object_get(kit->set.json, "snrs"),
                     "items", kit->items, "trials", kit->trials, "page",
                     json_object_get(kit->set.json, "page"));
}

/* Writes manifest and page after the last item. -1 after a message. */
static int kit_page(struct kit *kit) {
    struct buf template = {0}, bundle = {0}, data = {0}, page = {0};
    char path[PATH_BYTES];
    json_t *manifest = manifest_of(kit);
    json_print(&data, manifest, JSON_INDENT(1) | JSON_REAL_PRECISION(7));
    int failed = write_file(kit, "manifest.json", &data);
    data.size = 0;
    json_object_set_new(manifest, "server", json_string(kit->server));
    json_object_set(manifest, "films", kit->films);
    if (kit->shown.set)
        json_object_set(manifest, "pictures", kit->shown.set);
    json_print(&data, manifest, JSON_COMPACT | JSON_REAL_PRECISION(7));
    json_decref(manifest);
    /* Without the client's bundle (built without Node.js) the page loads it from the daemon. */
    snprintf(path, sizeof path, "%s/talking-head.js", kit->settings->api.web);
    if (!access(path, R_OK))
        failed = failed || cli_read(path, &bundle);
    snprintf(path, sizeof path, "%s/stimuli/page.html", kit->settings->models);
    failed = failed || cli_read(path, &template);
    if (!failed) {
        stimuli_page(&template, &data, &bundle, &page);
        failed = write_file(kit, "index.html", &page);
    }
    buf_free(&template);
    buf_free(&bundle);
    buf_free(&data);
    buf_free(&page);
    return failed;
}

/* Creates a folder in the test's folder ("" = that folder itself). -1 after a message. */
static int kit_folder(const struct kit *kit, const char *name) {
    char path[PATH_BYTES];
    struct stat info;
    in_folder(kit, name, path);
    if (!mkdir(path, 0777) || (errno == EEXIST && !stat(path, &info) && S_ISDIR(info.st_mode)))
        return 0;
    cli_complain("%s: %s", path, strerror(errno));
    return -1;
}

/* faccia stimuli: makes a listening test, speech in noise with and without a face (after Costa, MSc
 * thesis, UNICAMP 2009, chapter 6). */

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
    "  -o, --out DIR        output folder, created if missing\n"
    "  -v, --voice ID       a voice listed by 'faccia voices' (the language's first)\n"
    "  -r, --rate WPM       words per minute, 40 to 500\n"
    "  -e, --engine NAME    of the second and, given again, of the third mode; 'still' is a face at rest "
    "(the first two\n"
    "                       engines there are)\n"
    "      --faces LIST     who is seen, with commas between: 'head'; 'pictures' or 'pictures:FILE', a set "
    "of pictures (the\n"
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
    kit->synthesis = synthesis_open(&kit->cli.components.pipeline, &kit->request, &callbacks, kit, &e);
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

/* Chooses the faces: those named, which must be able to speak the set, else the first engines that can and
 * the still face. */
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
        cli_complain("engine: unknown engine '%s'", name);
        return EXIT_USAGE;
    }
    if (kit->face_count == KIT_FACES || (kit->face_count && kit->faces[0] == face)) {
        cli_complain("--engine: at most %d, all different", KIT_FACES);
        return EXIT_USAGE;
    }
    kit->faces[kit->face_count++] = face;
    return -1;
}

/* Returns an exit code, or -1 to continue. */
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
    for (int c; status < 0 && (c = options_next(argc, argv, "o:v:r:e:h", options, NULL)) != -1;) {
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
        cli_complain(kit->out ? "unexpected '%s'" : "no output folder: give --out", argv[optind]);
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
