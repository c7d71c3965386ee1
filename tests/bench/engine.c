/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Engine and sampling only, on ten minutes of speech: seconds of speech per second of CPU, beside the
 * synthesis of the same speech in the same run. Usage: engine TEXT-FILE LANG FPS [ENGINE]. */
#include "server/base/buf.h"
#include "server/cli/cli.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

struct bench {
    struct cli cli;
    struct synthesis *synthesis;
    struct sentence_audio **utterances;
    size_t count, cap;
    double seconds;
    bool finished;
};

static double cpu(void) {
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec + (double)t.tv_nsec / 1e9;
}

static void on_segment(void *ctx, struct media_segment segment) {
    struct bench *b = ctx;
    b->utterances = realloc(b->utterances, (b->count + 1) * sizeof(struct sentence_audio *));
    b->utterances[b->count++] = segment.audio;
    b->seconds += (double)segment.audio->samples / segment.audio->sample_rate;
    face_track_free(segment.track);
    synthesis_release(b->synthesis);
}

static void on_problem(void *ctx, const struct error *e, bool warning) {
    (void)ctx;
    fprintf(stderr, "%s: %s\n", warning ? "warning" : "error", e->message);
}

static void on_finished(void *ctx, size_t spoken) {
    (void)spoken;
    ((struct bench *)ctx)->finished = true;
}

static long run(const struct bench *b, const struct speech_pack *pack, double fps, const char *engine) {
    long sum = 0; /* prevents optimising the work away */
    struct face_options options = {.engine = engine};
    const struct placement_options place = {.seed = 1, .life = 1};
    for (size_t i = 0; i < b->count; i++) {
        const struct sentence_audio *u = b->utterances[i];
        struct face_track *track = face_track_new(pack, u, &options, NULL, NULL);
        struct face_placement *face = face_placement_new(track, u, &place);
        struct fap_frame frame;
        for (long k = 0; k < fps * u->samples / u->sample_rate; k++) {
            face_placement_sample(face, (double)k / fps, &frame);
            sum += frame.value[3];
        }
        face_placement_free(face);
        face_track_free(track);
    }
    return sum;
}

int main(int argc, char **argv) {
    static const struct synthesis_callbacks callbacks = {on_segment, on_problem, on_finished};
    struct bench b = {0};
    struct speech_request request;
    struct paths paths;
    struct settings settings;
    struct settings_request rest;
    struct error e;
    if (argc < 4 || argc > 5)
        return 2;
    FILE *file = fopen(argv[1], "rb");
    paths_find(&paths);
    if (!file || settings_read(&settings, &rest, PROGRAM_COMMANDS, 1, argv, &paths, &e) ||
        cli_open(&b.cli, &settings))
        return 1;
    struct buf text = {0};
    for (size_t got = 1; got; text.size += got)
        got = fread(buf_reserve(&text, 65536), 1, 65536, file);
    fclose(file);
    request_init(&request);
    request_set(&request, "text", (struct request_value){REQUEST_STRING, (char *)text.data, text.size, 0},
                &e);
    request_set(&request, "lang", (struct request_value){REQUEST_WORD, argv[2], strlen(argv[2]), 0}, &e);
    b.synthesis = synthesis_open(&b.cli.components.pipeline, &request, &callbacks, &b, &e);
    if (!b.synthesis)
        return 1;
    synthesis_start(b.synthesis);
    while (!b.finished && uv_run(&b.cli.loop, UV_RUN_ONCE))
        ;
    const struct speech_pack *pack = speech_packs_find(&b.cli.components.packs, argv[2]);
    double fps = atof(argv[3]);
    printf("{\"seconds\":%.1f,\"fps\":%g,\"cpu\":[", b.seconds, fps);
    for (int i = 0; i < 5; i++) {
        double before = cpu();
        long sum = run(&b, pack, fps, argc > 4 ? argv[4] : NULL);
        printf("%s%.4f", i ? "," : "", cpu() - before + 0 * (double)sum);
    }
    puts("]}");
    return 0;
}
