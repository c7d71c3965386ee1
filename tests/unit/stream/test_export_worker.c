/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/mem.h"
#include "server/export/export.h"
#include <math.h>
#include <setjmp.h>
#include <sndfile.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { RATE = 16000, FRAMES = 400, SEGMENTS = 4 };

static const char text[] = "Uno due. Tre.";
static const struct export_source source = {
    .text = text, .lang = "it", .voice = "a:voice", .engine = "dominance", .markup = "plain", .fps = 25};

/* Segments of several pieces, less than one, zero, and exactly two. */
static const uint32_t lengths[SEGMENTS] = {3 * RATE + 123, 77, 0, RATE / 2};

static struct media_segment make(const struct fap_frame *frames, size_t which) {
    struct sentence_audio *u = mem_alloc(sizeof *u);
    int64_t start = 0;
    for (size_t i = 0; i < which; i++)
        start += lengths[i];
    *u = (struct sentence_audio){.sample_rate = RATE, .samples = lengths[which], .from = 0, .to = 8};
    u->pcm = mem_alloc((u->samples + 1) * sizeof *u->pcm);
    for (uint32_t i = 0; i < u->samples; i++)
        u->pcm[i] = (int16_t)(8000 * sin(0.05 * i) * sin(0.0007 * i));
    u->words = mem_alloc(2 * sizeof *u->words);
    u->words[u->word_count++] = (struct word){.end = u->samples / 2, .to = 3};
    u->words[u->word_count++] = (struct word){.start = u->samples / 2, .end = u->samples, .from = 4, .to = 7};
    u->phones = mem_alloc(sizeof *u->phones);
    u->phones[u->phone_count++] = (struct phone){.ipa = "a", .sampa = "a", .end = u->samples};
    u->marks = mem_alloc(sizeof *u->marks);
    u->marks[u->mark_count++] = (struct mark){mem_strdup("end"), u->samples};
    return (struct media_segment){.audio = u, .start = start, .frames = frames, .frame_count = FRAMES};
}

static struct fap_frame *make_frames(void) {
    struct fap_frame *frames = calloc(FRAMES, sizeof *frames);
    for (int k = 0; k < FRAMES; k++) {
        fap_frame_set(&frames[k], 3, 10 * k % 300);
        fap_frame_set(&frames[k], 51, -k);
    }
    return frames;
}

struct receiver {
    uv_loop_t loop;
    struct export_worker *worker;
    struct buf got;
    size_t segments, calls;
    bool slow, done, streams;
};

static bool on_written(void *ctx, struct buf *out, size_t segments, bool done) {
    struct receiver *r = ctx;
    assert_false(r->done);
    if (r->streams || done) {
        buf_add(&r->got, out->data, out->size);
        buf_consume(out, out->size);
    }
    r->segments += segments;
    r->calls++;
    r->done = done;
    return !r->slow;
}

static void begin(struct receiver *r, const struct export_format *format) {
    *r = (struct receiver){.streams = format->streams};
    uv_loop_init(&r->loop);
    /* the source's strings may be freed */
    char *copy = strdup(text);
    struct export_source own = source;
    own.text = copy;
    r->worker = export_worker_open(&r->loop, format, &own, on_written, r);
    memset(copy, '?', strlen(copy));
    free(copy);
}

static void finish(struct receiver *r) {
    export_worker_free(r->worker);
    uv_run(&r->loop, UV_RUN_DEFAULT);
    assert_int_equal(uv_loop_close(&r->loop), 0);
    buf_free(&r->got);
}

static void fill(struct receiver *r, const struct fap_frame *frames) {
    struct error warning;
    error_set(&warning, ERROR_VOICE_WARNING, "of no weight");
    for (size_t i = 0; i < SEGMENTS; i++) {
        export_worker_add(r->worker, make(frames, i));
        if (i == 1)
            export_worker_warn(r->worker, &warning);
    }
    export_worker_end(r->worker);
}

static void expected(const struct export_format *format, const struct fap_frame *frames, struct buf *out) {
    struct export x;
    struct error warning;
    error_set(&warning, ERROR_VOICE_WARNING, "of no weight");
    export_begin(&x, format, &source);
    for (size_t i = 0; i < SEGMENTS; i++) {
        struct media_segment segment = make(frames, i);
        export_segment(&x, &segment);
        media_segment_free(&segment);
        if (i == 1)
            export_warning(&x, &warning);
    }
    export_end(&x);
    buf_add(out, x.out.data, x.out.size);
    export_free(&x);
}

static void writes_what_one_stroke_would(void **state) {
    (void)state;
    struct fap_frame *frames = make_frames();
    for (const struct export_format *format = export_formats; format->name; format++) {
        struct receiver r;
        struct buf all = {0};
        begin(&r, format);
        fill(&r, frames);
        uv_run(&r.loop, UV_RUN_DEFAULT);
        expected(format, frames, &all);
        assert_true(r.done);
        assert_int_equal(r.segments, SEGMENTS);
        /* the words come with the sentences' scripts, which these segments lack */
        assert_true(all.size > 100 || !strcmp(format->name, "words"));
        assert_int_equal(r.got.size, all.size);
        assert_memory_equal(r.got.data, all.data, all.size);
        buf_free(&all);
        finish(&r);
    }
    free(frames);
}

static void waits_for_a_slow_receiver(void **state) {
    (void)state;
    struct fap_frame *frames = make_frames();
    struct receiver r;
    begin(&r, export_by_name("ogg"));
    r.slow = true;
    fill(&r, frames);
    for (size_t calls = 1; !r.done; calls++) {
        uv_run(&r.loop, UV_RUN_DEFAULT); /* returns because nothing else is pending */
        assert_int_equal(r.calls, calls);
        export_worker_go_on(r.worker);
    }
    assert_true(r.calls > SEGMENTS + 2);
    finish(&r);
    free(frames);
}

static void is_freed_while_a_thread_writes(void **state) {
    (void)state;
    struct fap_frame *frames = make_frames();
    struct receiver r;
    begin(&r, export_by_name("ogg"));
    fill(&r, frames);
    export_worker_free(r.worker);
    r.worker = NULL;
    uv_run(&r.loop, UV_RUN_DEFAULT);
    assert_int_equal(r.calls, 0);
    finish(&r);
    free(frames);
}

/* Every frame and event, each at its time. */
static void pieces_leave_out_nothing(void **state) {
    (void)state;
    struct fap_frame *frames = make_frames();
    struct buf all = {0};
    expected(export_by_name("ndjson"), frames, &all);
    buf_add(&all, "", 1);
    size_t words = 0, marks = 0, phones = 0, count = 0;
    double time = 0;
    for (char *line = (char *)all.data, *end; *line; line = end + 1) {
        end = strchr(line, '\n');
        *end = '\0';
        const char *at = strstr(line, "\"time\":");
        assert_true(!at || atof(at + 7) >= time - 1e-6);
        time = at ? atof(at + 7) : time;
        words += strstr(line, "\"word\"") != NULL;
        marks += strstr(line, "\"mark\"") != NULL;
        phones += strstr(line, "\"phone\"") != NULL;
        count += strstr(line, "\"frame\":") != NULL;
    }
    assert_int_equal(words, 2 * SEGMENTS);
    assert_int_equal(marks, SEGMENTS);
    assert_int_equal(phones, SEGMENTS);
    uint32_t samples = 0;
    for (size_t i = 0; i < SEGMENTS; i++)
        samples += lengths[i];
    assert_int_equal(count, frame_from_sample(samples, RATE, 25));
    buf_free(&all);
    free(frames);
}

struct bytes {
    const struct buf *data;
    sf_count_t at;
};

static sf_count_t bytes_size(void *self) {
    return (sf_count_t)((struct bytes *)self)->data->size;
}

static sf_count_t bytes_seek(sf_count_t offset, int whence, void *self) {
    struct bytes *b = self;
    return b->at = offset + (whence == SEEK_SET ? 0 : whence == SEEK_CUR ? b->at : bytes_size(b));
}

static sf_count_t bytes_read(void *to, sf_count_t count, void *self) {
    struct bytes *b = self;
    sf_count_t left = bytes_size(b) - b->at, n = count < left ? count : left;
    memcpy(to, b->data->data + b->at, (size_t)n);
    b->at += n;
    return n;
}

static sf_count_t bytes_tell(void *self) {
    return ((struct bytes *)self)->at;
}

/* Decodes a sound file; returns the number of samples. */
static size_t decode(const struct buf *data, int16_t *pcm, size_t cap, int *rate) {
    SF_VIRTUAL_IO io = {bytes_size, bytes_seek, bytes_read, NULL, bytes_tell};
    struct bytes bytes = {data, 0};
    SF_INFO info = {0};
    SNDFILE *file = sf_open_virtual(&io, SFM_READ, &info, &bytes);
    assert_non_null(file);
    assert_int_equal(info.channels, 1);
    *rate = info.samplerate;
    size_t count = (size_t)sf_readf_short(file, pcm, (sf_count_t)cap);
    sf_close(file);
    return count;
}

/* The best correlation of two sounds over delays of up to 3000 samples. */
static double likeness(const int16_t *a, size_t n, const int16_t *b, size_t m) {
    double best = 0;
    for (size_t delay = 0; delay < 3000; delay++) {
        double ab = 0, aa = 1, bb = 1;
        for (size_t i = 0; i < n && i + delay < m; i += 3) {
            ab += (double)a[i] * b[i + delay];
            aa += (double)a[i] * a[i];
            bb += (double)b[i + delay] * b[i + delay];
        }
        best = fmax(best, ab / sqrt(aa * bb));
    }
    return best;
}

static void sound_files_hold_the_sound(void **state) {
    (void)state;
    enum { CAP = 4 * RATE * 2 };
    struct fap_frame *frames = make_frames();
    int16_t *wav = calloc(CAP, sizeof *wav), *other = calloc(CAP, sizeof *other);
    struct buf file = {0};
    int rate;
    expected(export_by_name("wav"), frames, &file);
    size_t samples = (file.size - WAV_HEADER_BYTES) / 2;
    memcpy(wav, file.data + WAV_HEADER_BYTES, 2 * samples);

    file.size = 0;
    expected(export_by_name("flac"), frames, &file);
    assert_int_equal(decode(&file, other, CAP, &rate), samples);
    assert_int_equal(rate, RATE);
    assert_memory_equal(wav, other, 2 * samples);

    file.size = 0;
    expected(export_by_name("mp3"), frames, &file);
    size_t decoded = decode(&file, other, CAP, &rate);
    assert_int_equal(rate, RATE);
    assert_true(decoded >= samples && decoded < samples + RATE / 5);
    assert_true(likeness(wav, samples, other, decoded) > 0.95);
    double bits = 8.0 * (double)file.size * RATE / (double)samples;
    assert_true(bits > 60000 && bits < 72000);

    /* 16000 Hz become 24000: every second sample is at the place of a third */
    file.size = 0;
    expected(export_by_name("pcm"), frames, &file);
    size_t resampled = file.size / 2;
    assert_true(resampled >= samples * 3 / 2 - 2 && resampled <= samples * 3 / 2 + 2);
    double difference = 0, energy = 1;
    for (size_t i = 0; i + 2 < resampled / 3; i++) {
        int16_t at = (int16_t)(file.data[6 * i] | file.data[6 * i + 1] << 8);
        difference += pow(at - wav[2 * i], 2);
        energy += pow(wav[2 * i], 2);
    }
    assert_true(difference < 0.001 * energy);
    buf_free(&file);
    free(wav);
    free(other);
    free(frames);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(writes_what_one_stroke_would),   cmocka_unit_test(waits_for_a_slow_receiver),
        cmocka_unit_test(is_freed_while_a_thread_writes), cmocka_unit_test(pieces_leave_out_nothing),
        cmocka_unit_test(sound_files_hold_the_sound),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
