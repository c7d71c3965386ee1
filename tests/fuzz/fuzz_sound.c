/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sound files, in all their readers. Byte 0 selects the reader; the rest is the file. */
#include "server/base/mem.h"
#include "server/library/align/sound/sound_file.h"
#include "server/plugins/command/command_internal.h"
#include "server/synthesis/recording.h"
#include "server/voice/sentence.h"
#include "server/voice/sound_reader.h"
#include "tests/fuzz/fuzz.h"
#include <stdlib.h>
#include <string.h>

enum { PIECE = 8192, PIECES = 12 };

/* Reads from the beginning, from near the end, and from beyond it. */
static void align(const char *path) {
    struct error e = {0};
    struct sound_file *file = sound_open(path, &e);
    FUZZ_CHECK(file || e.code);
    if (!file)
        return;
    const struct sound_source *source = sound_source(file);
    int16_t *pcm = mem_alloc(PIECE * sizeof *pcm);
    const uint64_t from[] = {0, PIECE, source->samples / 2, source->samples - 1, source->samples, UINT32_MAX};
    for (size_t i = 0; i < sizeof from / sizeof *from; i++)
        FUZZ_CHECK(source->read(source->ctx, from[i], pcm, PIECE) <= PIECE);
    free(pcm);
    sound_close(file);
}

static void command(const uint8_t *data, size_t size, uint32_t raw) {
    struct cm_sound sound;
    char message[200] = "";
    uint8_t *copy = mem_alloc(size);
    memcpy(copy, data, size);
    if (cm_sound_read(&sound, copy, size, raw, message, sizeof message))
        FUZZ_CHECK(*message);
    else
        FUZZ_CHECK(!sound.count || sound.samples);
    free(sound.samples);
    free(copy);
}

static void audio_element(const char *path, uint8_t choice) {
    struct error e = {0};
    struct sentence_audio *u = sound_read(NULL, path, choice / 32.0, choice & 1 ? 22050 : 48000, NULL, &e);
    FUZZ_CHECK(u ? u->sample_rate > 0 : e.code != ERROR_NONE);
    if (u)
        FUZZ_CHECK(u->samples <= (SOUND_SECONDS + 1u) * u->sample_rate &&
                   (!u->phone_count || u->phones[u->phone_count - 1].end == u->samples));
    sentence_audio_free(u);
}

static void recording(const uint8_t *data, size_t size) {
    struct recording_source source = {0};
    struct sound_reader *sound;
    struct error e = {0};
    buf_add(&source.sound, data, size);
    int16_t *pcm = mem_alloc(PIECE * sizeof *pcm);
    if (!recording_sound_open(&sound, &source, NULL, NULL, &e) && sound) {
        FUZZ_CHECK(sound_reader_rate(sound) >= 8000);
        for (int i = 0; i < PIECES && recording_sound_read(sound, pcm, PIECE) == PIECE; i++)
            ;
        sound_reader_close(sound);
    }
    free(pcm);
    recording_source_free(&source);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    struct fuzz_input in = fuzz_input(data, size);
    char path[FUZZ_PATH];
    uint8_t choice = fuzz_u8(&in);
    fuzz_write("sound", in.at, fuzz_left(&in), path);
    switch (choice % 4) {
    case 0:
        align(path);
        break;
    case 1:
        command(in.at, fuzz_left(&in), choice > 128 ? 16000 : 0);
        break;
    case 2:
        audio_element(path, choice);
        break;
    default:
        recording(in.at, fuzz_left(&in));
    }
    return 0;
}
