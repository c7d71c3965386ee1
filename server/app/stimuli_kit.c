/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/app/stimuli_kit.h"
#include "protocol/fapfile.h"
#include "server/app/cli_file.h"
#include "server/app/stimuli_page.h"
#include "server/base/mem.h"
#include "server/eval/noise.h"
#include <errno.h>
#include <sndfile.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { PATH_BYTES = 4096 };

const char kit_still[] = "still";

/* The item's samples in its sentence: those of the last word's phones. Words and phones are cut at slightly
 * different places, so a phone belongs to the word that its middle lies in. */
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

/* The name, with the folder before it. */
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

/* The track of the item alone: the lips rest while the carrier is heard, so that they give nothing away but
 * the item. */
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
    if (u->word_count) { /* some engines go by words */
        alone.words = &u->words[u->word_count - 1];
        alone.word_count = 1;
    }
    const struct speech_pack *pack =
        speech_packs_find(&kit->cli.stages.packs, synthesis_lang(kit->synthesis));
    struct face_track *track = face_track_new(pack, &alone, &options, NULL, NULL);
    free(alone.phones);
    return track;
}

/* The frames as the page plays them: the FAPs that move, and their values. */
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

/* The face that pictures show: the first that moves. NULL: none does. */
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

/* The film of an item, its own sound at each ratio, its trials. */
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
            cli_complain("%s/%s.wav: nothing is heard where the word should be", kit->shown.films, item);
        failed = failed || write_wav(kit, wav, mixed, film.samples, film.sample_rate);
        add_trial(kit, item, "video", snr, wav, "video", name);
    }
    free(mixed);
    free(film.pcm);
    return failed;
}

/* One item, spoken: its faces, its sound at each ratio, its trials. */
int kit_item(struct kit *kit, size_t number) {
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
            cli_complain("%s: the voice said nothing", item->name);
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

static int append(const char *text, size_t size, void *buf) {
    buf_add(buf, text, size);
    return 0;
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

int kit_page(struct kit *kit) {
    struct buf template = {0}, bundle = {0}, data = {0}, page = {0};
    char path[PATH_BYTES];
    json_t *manifest = manifest_of(kit);
    json_dump_callback(manifest, append, &data, JSON_INDENT(1) | JSON_REAL_PRECISION(7));
    int failed = write_file(kit, "manifest.json", &data);
    data.size = 0;
    json_object_set_new(manifest, "server", json_string(kit->server));
    json_object_set(manifest, "films", kit->films);
    if (kit->shown.set)
        json_object_set(manifest, "pictures", kit->shown.set);
    json_dump_callback(manifest, append, &data, JSON_COMPACT | JSON_REAL_PRECISION(7));
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

int kit_folder(const struct kit *kit, const char *name) {
    char path[PATH_BYTES];
    struct stat info;
    in_folder(kit, name, path);
    if (!mkdir(path, 0777) || (errno == EEXIST && !stat(path, &info) && S_ISDIR(info.st_mode)))
        return 0;
    cli_complain("%s: %s", path, strerror(errno));
    return -1;
}
