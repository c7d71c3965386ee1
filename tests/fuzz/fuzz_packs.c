/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A language's files: byte 0 selects the file, the rest edits it (json_edit.c). A file that loads is used for
 * an utterance. */
#include "server/base/mem.h"
#include "server/face/packs/context_table.h"
#include "server/face/packs/speech_pack_internal.h"
#include "server/face/packs/spelling.h"
#include "server/face/track.h"
#include "tests/fuzz/fuzz.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { RATE = 10000, FRAMES = 6 };

static const char *const files[] = {"it.json", "und.json",           "pt-BR.json",      "tr.json",
                                    "en.json", "alphabets/ipa.json", "visemes/pt.json", "letters/tr.json"};
enum { FILES = sizeof files / sizeof *files };

/* Copies of a pack inherit from the other packs and use their files, which are links. */
static void prepare(void) {
    static bool done;
    static const char *const links[] = {"und.json", "it.json", "alphabets", "visemes", "letters"};
    char from[512], to[FUZZ_PATH];
    for (size_t i = 0; !done && i < sizeof links / sizeof *links; i++) {
        snprintf(from, sizeof from, SOURCE_ROOT "/models/speech/%s", links[i]);
        snprintf(to, sizeof to, "%s/%s", fuzz_folder(), links[i]);
        FUZZ_CHECK(!symlink(from, to));
    }
    done = true;
}

static const json_t *base(size_t which) {
    static json_t *loaded[FILES];
    char path[128];
    snprintf(path, sizeof path, "models/speech/%s", files[which]);
    if (!loaded[which])
        loaded[which] = fuzz_load_json(path);
    return loaded[which];
}

static struct sentence_audio *sample(void) {
    static const char *const phones[] = {"",  "p", "a", "t͡ʃ", "o",  "",  "m", "u",
                                         "ʒ", "i", "l", "e",  "kː", "ã", ""};
    enum { COUNT = sizeof phones / sizeof *phones };
    struct sentence_audio *u = mem_alloc(sizeof *u);
    u->sample_rate = RATE;
    u->phones = mem_alloc(COUNT * sizeof *u->phones);
    u->words = mem_alloc(2 * sizeof *u->words);
    for (size_t i = 0; i < COUNT; i++) {
        struct phone *p = &u->phones[u->phone_count++];
        snprintf(p->ipa, sizeof p->ipa, "%s", phones[i]);
        p->start = u->samples, p->end = u->samples += RATE / 10, p->stress = i % 3;
    }
    for (uint32_t i = 0; i < 2; i++)
        u->words[u->word_count++] = (struct word){
            .start = i * RATE / 2, .end = (i + 1) * RATE / 2, .to = 4, .text = mem_strdup("ağlar")};
    return u;
}

static void serve(const struct speech_pack *pack) {
    struct sentence_audio *u = sample();
    for (const char *const *engine = face_engines(); *engine; engine++) {
        if (!face_engine_speaks(*engine, pack))
            continue;
        struct face_options options = {.engine = *engine, .still = true};
        struct face_track *track = face_track_new(pack, u, &options, NULL, NULL);
        for (int i = 0; i < FRAMES; i++) {
            struct fap_frame frame;
            face_track_sample(track, (double)u->samples / RATE * i / FRAMES, &frame);
            for (int n = 3; n <= FAP_COUNT; n++)
                FUZZ_CHECK(!fap_frame_has(&frame, n) || fap_clamp(n, frame.value[n]) == frame.value[n]);
        }
        face_track_free(track);
    }
    sentence_audio_free(u);
}

static const struct speech_pack *whole(const char *lang) {
    static struct speech_packs packs;
    struct error e;
    FUZZ_CHECK(packs.count || !speech_packs_load(&packs, SOURCE_ROOT "/models/speech", &e));
    return speech_packs_find(&packs, lang);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    struct fuzz_input in = fuzz_input(data, size);
    size_t which = fuzz_below(&in, FILES);
    struct error e = {0};
    char path[FUZZ_PATH];
    prepare();
    json_t *edited = fuzz_edit_json(base(which), &in);
    fuzz_write_json("edited.json", edited, path);
    json_decref(edited);
    void *loaded;
    if (!strncmp(files[which], "alphabets", 9))
        alphabet_free(loaded = alphabet_load(path, &e));
    else if (!strncmp(files[which], "visemes", 7))
        context_table_free(loaded = context_table_load(path, whole("pt-BR"), &e));
    else if (!strncmp(files[which], "letters", 7))
        spelling_free(loaded = spelling_load(path, whole("tr"), &e));
    else if ((loaded = speech_pack_load(path, &e)) != NULL) {
        serve(loaded);
        speech_pack_free(loaded);
    }
    FUZZ_CHECK(loaded || (e.code && memchr(e.field, 0, sizeof e.field)));
    return 0;
}
