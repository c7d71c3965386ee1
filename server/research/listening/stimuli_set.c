/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/research/listening/stimuli_set.h"
#include "server/base/buf.h"
#include "server/base/mem.h"
#include "server/base/sound/mixdown.h"
#include "server/base/sound/wav_file.h"
#include "server/cli/cli.h"
#include <math.h>
#include <sndfile.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const char place[] = "{item}";

static const char *text_of(json_t *object, const char *key) {
    const char *text = json_string_value(json_object_get(object, key));
    return text && *text ? text : NULL;
}

static int read_items(struct stimuli_set *set, struct error *e) {
    static const char letters[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-";
    json_t *items = json_object_get(set->json, "items"), *snrs = json_object_get(set->json, "snrs"), *value;
    size_t i;
    char field[40];
    set->items = mem_alloc((json_array_size(items) + 1) * sizeof *set->items);
    set->snrs = mem_alloc((json_array_size(snrs) + 1) * sizeof *set->snrs);
    json_array_foreach(items, i, value) {
        struct stimuli_item item = {text_of(value, "name"), text_of(value, "text")};
        snprintf(field, sizeof field, "items[%zu]", i);
        if (!item.name || !item.text || strlen(item.name) > 32 || item.name[strspn(item.name, letters)])
            return error_in_field(e, ERROR_BAD_STIMULI, field,
                                  "needs a text, and a name of up to 32 letters, digits, - and _");
        for (size_t k = 0; k < i; k++)
            if (!strcmp(set->items[k].name, item.name))
                return error_in_field(e, ERROR_BAD_STIMULI, field, "the name '%s' occurs twice", item.name);
        set->items[set->item_count++] = item;
    }
    json_array_foreach(snrs, i, value) {
        snprintf(field, sizeof field, "snrs[%zu]", i);
        if (!json_is_number(value) || !(json_number_value(value) >= -60 && json_number_value(value) <= 60))
            return error_in_field(e, ERROR_BAD_STIMULI, field, "must be a number of dB from -60 to 60");
        set->snrs[set->snr_count++] = json_number_value(value);
    }
    if (!set->item_count || !set->snr_count)
        return error_in_field(e, ERROR_BAD_STIMULI, set->item_count ? "snrs" : "items", "there are none");
    return 0;
}

int stimuli_set_load(struct stimuli_set *set, const char *path, struct error *e) {
    json_error_t why;
    *set = (struct stimuli_set){.json = json_load_file(path, JSON_REJECT_DUPLICATES, &why)};
    if (!set->json)
        return why.line > 0
                   ? error_at_line(e, ERROR_BAD_STIMULI, (size_t)why.line, (size_t)why.column, "%s", why.text)
                   : error_set(e, ERROR_BAD_STIMULI, "%s", why.text);
    set->lang = text_of(set->json, "lang");
    set->carrier = text_of(set->json, "carrier");
    if (!set->lang)
        return error_in_field(e, ERROR_BAD_STIMULI, "lang", "must be a language tag");
    if (!set->carrier || !strstr(set->carrier, place))
        return error_in_field(e, ERROR_BAD_STIMULI, "carrier", "must be a sentence that contains %s", place);
    if (!json_is_object(json_object_get(set->json, "page")))
        return error_in_field(e, ERROR_BAD_STIMULI, "page", "must be the texts of the page");
    return read_items(set, e);
}

void stimuli_set_free(struct stimuli_set *set) {
    json_decref(set->json);
    free(set->items);
    free(set->snrs);
    *set = (struct stimuli_set){0};
}

char *stimuli_sentence(const struct stimuli_set *set, const struct stimuli_item *item) {
    struct buf out = {0};
    const char *at = strstr(set->carrier, place);
    buf_printf(&out, "%.*s%s%s", (int)(at - set->carrier), set->carrier, item->text, at + sizeof place - 1);
    return (char *)out.data;
}

enum { PATH_BYTES = 4096, MOST_SECONDS = 120, MOST_CHANNELS = 8 };

int stimuli_faces_parse(struct stimuli_faces *faces, char *list) {
    char *rest = list;
    *faces = (struct stimuli_faces){.head = !list};
    for (char *word; (word = strsep(&rest, ",")) != NULL;) {
        char *of = strchr(word, ':');
        if (of)
            *of++ = 0;
        if (!strcmp(word, "head") && !of && !faces->head)
            faces->head = true;
        else if (!strcmp(word, "pictures") && (!of || *of) && !faces->pictures) {
            faces->pictures = true;
            faces->set_path = of;
        } else if (!strcmp(word, "video") && of && *of && !faces->films)
            faces->films = of;
        else {
            cli_complain("--faces: '%s%s%s': must be 'head', 'pictures', 'pictures:FILE' or 'video:DIR', "
                         "each at most once",
                         word, of ? ":" : "", of ? of : "");
            return -1;
        }
    }
    return 0;
}

static json_t *read_json(const char *path) {
    json_error_t why;
    json_t *json = json_load_file(path, JSON_REJECT_DUPLICATES, &why);
    if (!json && why.line > 0)
        cli_complain("%s: %d:%d: %s", path, why.line, why.column, why.text);
    else if (!json)
        cli_complain("%s: %s", path, why.text);
    return json;
}

static int load_set(struct stimuli_faces *faces) {
    if (!faces->set_path)
        return 0;
    faces->set = read_json(faces->set_path);
    const char *format = json_string_value(json_object_get(faces->set, "format"));
    if (!faces->set)
        return -1;
    if (format && !strcmp(format, "faccia-pictures"))
        return 0;
    cli_complain("%s: format: this is not a set of pictures", faces->set_path);
    return -1;
}

static bool find_film(const struct stimuli_faces *faces, const char *item, char file[64]) {
    static const char *const kinds[] = {"mp4", "webm"};
    char path[PATH_BYTES];
    for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++) {
        snprintf(file, 64, "%s.%s", item, kinds[i]);
        snprintf(path, sizeof path, "%s/%s", faces->films, file);
        if (!access(path, R_OK))
            return true;
    }
    return false;
}

static int check_film(const struct stimuli_faces *faces, const char *words, const char *item) {
    char file[64];
    json_t *word = json_object_get(faces->words, item);
    json_t *start = json_object_get(word, "start"), *end = json_object_get(word, "end");
    if (!find_film(faces, item, file)) {
        cli_complain("%s: no film of '%s' (%s.mp4 or %s.webm)", faces->films, item, item, item);
        return -1;
    }
    if (json_is_number(start) && json_is_number(end) && json_number_value(start) >= 0 &&
        json_number_value(end) > json_number_value(start))
        return 0;
    cli_complain("%s: %s: needs 'start' and 'end' of the word, in seconds", words, item);
    return -1;
}

static int load_films(struct stimuli_faces *faces, const struct stimuli_set *set) {
    char path[PATH_BYTES];
    if (!faces->films)
        return 0;
    snprintf(path, sizeof path, "%s/words.json", faces->films);
    faces->words = read_json(path);
    if (!faces->words)
        return -1;
    for (size_t i = 0; i < set->item_count; i++)
        if (check_film(faces, path, set->items[i].name))
            return -1;
    return 0;
}

int stimuli_faces_load(struct stimuli_faces *faces, const struct stimuli_set *set) {
    return load_set(faces) || load_films(faces, set) ? -1 : 0;
}

void stimuli_faces_free(struct stimuli_faces *faces) {
    json_decref(faces->set);
    json_decref(faces->words);
}

/* Mixes all channels into one, in place. */
static void mix_down(int16_t *pcm, size_t frames, int channels) {
    struct mixdown mixdown = {0};
    float frame[MOST_CHANNELS];
    for (size_t i = 0; i < frames; i++) {
        for (int k = 0; k < channels; k++)
            frame[k] = (float)pcm[i * (size_t)channels + (size_t)k] / 32768;
        pcm[i] = (int16_t)fmin(32767, lrint(32768 * mixdown_frame(&mixdown, frame, (unsigned)channels)));
    }
}

static size_t sample_of(const json_t *word, const char *key, const struct stimuli_film *film) {
    double at = json_number_value(json_object_get(word, key)) * film->sample_rate;
    return at < (double)film->samples ? (size_t)at : film->samples;
}

int stimuli_film_load(const struct stimuli_faces *faces, const char *item, struct stimuli_film *film) {
    char path[PATH_BYTES];
    SF_INFO info = {0};
    *film = (struct stimuli_film){0};
    find_film(faces, item, film->file);
    snprintf(path, sizeof path, "%s/%s.wav", faces->films, item);
    SNDFILE *sound = wav_file_open(path, &info);
    if (!sound) {
        cli_complain("%s: %s", path, wav_file_error());
        return -1;
    }
    bool usable = info.frames > 0 && info.channels > 0 && info.channels <= MOST_CHANNELS &&
                  info.samplerate > 0 && info.frames <= (sf_count_t)MOST_SECONDS * info.samplerate;
    if (usable) {
        film->pcm = mem_alloc((size_t)info.frames * (size_t)info.channels * sizeof *film->pcm);
        film->samples = (size_t)sf_readf_short(sound, film->pcm, info.frames);
        film->sample_rate = (unsigned)info.samplerate;
        mix_down(film->pcm, film->samples, info.channels);
    } else
        cli_complain("%s: must last from a sample to %d s, in at most %d channels", path, MOST_SECONDS,
                     MOST_CHANNELS);
    sf_close(sound);
    json_t *word = json_object_get(faces->words, item);
    film->from = sample_of(word, "start", film);
    film->to = sample_of(word, "end", film);
    if (!usable)
        return -1;
    if (film->from < film->to)
        return 0;
    cli_complain("%s: the word's time in words.json is after its end", path);
    free(film->pcm);
    film->pcm = NULL;
    return -1;
}
