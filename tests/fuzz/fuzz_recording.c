/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A folder of the recording plugin: byte 0 selects the format of the times; then follow the description, the
 * text and the times, each preceded by its size (2 bytes), and the sound. */
#include "server/face/packs/speech_pack.h"
#include "server/plugins/recording/recording_voice_internal.h"
#include "tests/fuzz/fuzz.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const struct speech_packs *packs(void) {
    static struct speech_packs loaded;
    struct error e;
    FUZZ_CHECK(loaded.count || !speech_packs_load(&loaded, SOURCE_ROOT "/models/speech", &e));
    return &loaded;
}

/* Writes the next part, unless it is empty. */
static void write_part(struct fuzz_input *in, const char *name) {
    char path[FUZZ_PATH];
    size_t size = fuzz_u16(in);
    uint8_t *bytes = fuzz_bytes(in, &size);
    fuzz_write(name, bytes, size, path);
    if (!size)
        unlink(path);
    free(bytes);
}

/* Unknown words would need alignment, which takes a voice. */
static bool is_known(const struct aligned_recording *reading, size_t first, size_t last) {
    for (size_t i = first; i <= last && i < reading->tokens.count; i++)
        if (!reading->words[i].known)
            return false;
    return true;
}

static void speak(struct recorded *r) {
    struct aligned_recording *reading = r->reading;
    const struct faccia_span span = {.kind = FACCIA_SPAN_TEXT, .text = "uno due"};
    const struct faccia_sentence sentence = {.voice = "a", .spans = &span, .span_count = 1};
    struct match match = {0};
    struct error e;
    uint64_t from, to;
    match_words(&match, &sentence);
    bool found = !match_find(&match, reading, 0, &e);
    if (found && is_known(reading, match.at, match.at + match.tokens.count)) {
        aligned_recording_stretch(reading, match.at, match.at + match.tokens.count, 2, &from, &to);
        FUZZ_CHECK(from <= to);
        struct sentence_audio *u = aligned_recording_audio(reading, from, to);
        uint32_t at = 0;
        for (size_t i = 0; i < u->phone_count; i++) {
            FUZZ_CHECK(u->phones[i].start == at && u->phones[i].end >= at && u->phones[i].end <= u->samples);
            at = u->phones[i].end;
        }
        for (size_t i = 0; i < match.tokens.count; i++)
            match_time(&match, reading, i, i & 1, from, u->samples);
        sentence_audio_free(u);
    }
    match_free(&match);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    static const char *const times[] = {"a.TextGrid", "a.lab", "a.mlf", "a.times", "a.timing.json"};
    struct fuzz_input in = fuzz_input(data, size);
    char path[FUZZ_PATH], folder_path[FUZZ_PATH];
    struct folder folder;
    struct reference_slot slot = {0};
    atomic_bool stop = false;
    struct error e = {0};
    const char *name = times[fuzz_below(&in, sizeof times / sizeof *times)];
    snprintf(folder_path, sizeof folder_path, "%s", fuzz_folder());
    write_part(&in, "a.json");
    write_part(&in, "a.txt");
    write_part(&in, name);
    fuzz_write("a.wav", in.at, fuzz_left(&in), path);
    int failed = folder_open(&folder, folder_path, NULL, "it", &e);
    if (!failed && folder.count && !(failed = folder_load(&folder, folder.list, &slot, packs(), &stop, &e)))
        speak(folder.list);
    FUZZ_CHECK(!failed || e.code);
    folder_close(&folder);
    fuzz_write(name, "", 0, path);
    unlink(path);
    return 0;
}
