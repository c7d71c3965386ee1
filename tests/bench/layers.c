/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Cost of the layers on top of visible speech: six minutes of speech with lips only, with life, with
 * expressions (a performative, an affect, an emphasis and a boundary per sentence), with both, and with
 * extremely dense markup (a mood, and two cues per word). Usage: layers MODELS-FOLDER FPS. */
#include "server/face/track.h"
#include "tests/unit/utter.h"
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

enum { RUNS = 9, SENTENCES = 75, CUES = 28, MAKES = 1000 };
enum what { LIPS, LIFE, EXPRESSIONS, BOTH, DENSE, WEIGHTED, WHATS };

static double cpu(void) {
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec + (double)t.tv_nsec / 1e9;
}

static struct cue cue(const char *kind, const char *name, double from, double to) {
    return (struct cue){(char *)kind,
                        (char *)name,
                        (uint32_t)(from * UTTER_RATE),
                        (uint32_t)(to * UTTER_RATE),
                        1,
                        -1,
                        0,
                        to - from,
                        -1,
                        -1,
                        false,
                        false};
}

static void mark_up(struct sentence_audio *u, bool dense, struct cue cues[CUES]) {
    static const char *const affects[] = {"joy", "anger", "hope", "shame"}, *const accents[] = {"hstar",
                                                                                                "lplushstar"};
    double end = (double)u->samples / u->sample_rate;
    size_t n = 0;
    u->cues = cues;
    cues[n++] = cue("performative", "warn", 0, end);
    if (!dense) {
        cues[n++] = cue("affect", "joy", 0, end);
        cues[n++] = cue("emphasis", "strong", 0.4 * end, 0.5 * end);
        cues[n++] = cue("boundary", "ll", end, end);
        u->cue_count = n;
        return;
    }
    cues[n++] = cue("certainty", "uncertain", 0, end / 2);
    for (int word = 0; word < 13; word++) {
        double from = end * word / 13, to = end * (word + 1) / 13;
        cues[n++] =
            word % 2 ? cue("affect", affects[word % 4], from, to) : cue("emphasis", "strong", from, to);
        cues[n++] =
            word % 3 ? cue("pitch-accent", accents[word % 2], from, to) : cue("boundary", "lh", to, to);
    }
    u->cue_count = n;
}

static double run(const struct speech_pack *pack, const struct sentence_audio *u,
                  const struct face_options *options, struct placement_options place, double fps) {
    long sum = 0; /* prevents optimising the work away */
    double before = cpu();
    for (int i = 0; i < SENTENCES; i++) {
        struct face_track *track = face_track_new(pack, u, options, NULL, NULL);
        struct face_placement *face = face_placement_new(track, u, &place);
        struct fap_frame frame;
        for (long k = 0; k < (long)(fps * u->samples / u->sample_rate); k++) {
            face_placement_sample(face, (double)k / fps, &frame);
            sum += frame.value[3];
        }
        face_placement_free(face);
        face_track_free(track);
        place.begin += (double)u->samples / u->sample_rate;
    }
    return cpu() - before + 0 * (double)sum;
}

/* Time that caching tracks would save: making a track and placing it, in microseconds. */
static void make(const struct speech_pack *pack, const struct sentence_audio *u,
                 const struct expressions *all) {
    const struct face_options options = {.expressions = all};
    const struct placement_options place = {.life = 1, .seed = 1};
    double making = 0, placing = 0;
    for (int i = 0; i < MAKES; i++) {
        double begin = cpu();
        struct face_track *track = face_track_new(pack, u, &options, NULL, NULL);
        double made = cpu();
        struct face_placement *face = face_placement_new(track, u, &place);
        placing += cpu() - made;
        making += made - begin;
        face_placement_free(face);
        face_track_free(track);
    }
    printf("a sentence of %.1f s: its track is made in %.0f us, and placed in %.0f us\n",
           (double)u->samples / u->sample_rate, making / MAKES * 1e6, placing / MAKES * 1e6);
}

static int by_size(const void *a, const void *b) {
    return (*(const double *)a > *(const double *)b) - (*(const double *)a < *(const double *)b);
}

int main(int argc, char **argv) {
    static const char *const names[WHATS] = {"lips alone", "with life",        "with expressions",
                                             "with both",  "with both, dense", "the same, weighted"};
    char path[4096];
    struct error e;
    if (argc != 3)
        return 2;
    snprintf(path, sizeof path, "%s/speech/it.json", argv[1]);
    struct speech_pack *pack = speech_pack_load(path, &e);
    snprintf(path, sizeof path, "%s/expressions.json", argv[1]);
    struct expressions *all = expressions_load(path, &e);
    if (!pack || !all)
        return 1;
    struct mood *mood = mood_new(all);
    mood_set(mood, (const char *const[]){"joy", "surprise"}, (const double[]){0.4, 0.2}, 2, 0, 1, &e);
    struct sentence_audio *u = utter(speech, 1);
    struct cue cues[CUES];
    double seconds[WHATS][RUNS];
    for (int r = 0; r < RUNS; r++) {
        for (int w = 0; w < WHATS; w++) {
            bool expresses = w != LIPS && w != LIFE;
            mark_up(u, w >= DENSE, cues);
            struct face_options options = {.still = w == LIPS,
                                           .blend = w == WEIGHTED ? BLEND_WEIGHTED : BLEND_REGIONS,
                                           .expressions = expresses ? all : NULL};
            const struct placement_options place = {
                .life = w == EXPRESSIONS ? 0 : 1, .seed = 1, .mood = w >= DENSE ? mood : NULL};
            seconds[w][r] = run(pack, u, &options, place, atof(argv[2]));
        }
    }
    double length = (double)u->samples / u->sample_rate * SENTENCES;
    for (int w = 0; w < WHATS; w++) {
        qsort(seconds[w], RUNS, sizeof(double), by_size);
        printf("%-20s %.0f s of speech at %s fps: %.4f s of CPU, %.2f of lips alone\n", names[w], length,
               argv[2], seconds[w][RUNS / 2], seconds[w][RUNS / 2] / seconds[LIPS][RUNS / 2]);
    }
    mark_up(u, false, cues);
    make(pack, u, all);
    mood_free(mood);
    expressions_free(all);
    speech_pack_free(pack);
    done(u);
    return 0;
}
