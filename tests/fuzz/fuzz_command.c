/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The command plugin. Byte 0 selects: a configuration, edits (json_edit.c) of one, or the output of a
 * program: format of the times, the times preceded by their size (2 bytes), and the sound. */
#include "server/base/mem.h"
#include "server/plugins/command/command_internal.h"
#include "tests/fuzz/fuzz.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char configuration[] =
    "{\"voices\": [{\"id\": \"a\", \"name\": \"A\", \"lang\": \"it\", \"gender\": \"female\", \"quality\": "
    "\"neural\","
    "\"licence\": \"MIT\", \"rate\": 160, \"argv\": [\"say\", \"{text}\", \"{rate}\"], \"feed\": true,"
    "\"sound\": \"file\", \"raw\": 16000, \"seconds\": 9, \"bytes\": 1000, \"times\": {\"format\": "
    "\"textgrid\","
    "\"argv\": [\"cat\"], \"tier\": \"MAU\", \"words\": \"ORT\", \"names\": {\"a\": \"a\", \"#\": \"\"}}},"
    "{\"id\": \"b\", \"lang\": \"en-GB\", \"argv\": [\"b\"]}]}";

static void configure(const char *text) {
    struct cm_voices voices = {0};
    char message[200] = "";
    int result = cm_config_read(&voices, text, message, sizeof message);
    FUZZ_CHECK(!result || *message);
    for (size_t i = 0; i < voices.count && !result; i++) {
        const struct cm_voice *v = &voices.list[i];
        FUZZ_CHECK(v->info.id && v->info.name && v->info.lang && json_array_size(v->argv));
        FUZZ_CHECK(cm_voices_find(&voices, v->info.id) && v->seconds > 0 && v->bytes);
    }
    cm_config_free(&voices);
}

/* Totals of the output. */
struct heard {
    uint64_t samples, phones_end;
    size_t words;
};

static int on_audio(void *ctx, const int16_t *samples, size_t count, uint32_t rate) {
    struct heard *h = ctx;
    FUZZ_CHECK((samples || !count) && rate);
    h->samples += count;
    return 0;
}

static int on_phone(void *ctx, const struct faccia_phone *phone) {
    struct heard *h = ctx;
    FUZZ_CHECK(phone->ipa && phone->symbol && phone->start <= phone->end && phone->start >= h->phones_end);
    h->phones_end = phone->end;
    return 0;
}

static int on_word(void *ctx, const struct faccia_word *word) {
    FUZZ_CHECK(word->span == 0 && word->offset + word->bytes <= strlen("uno due tre") && word->bytes);
    ((struct heard *)ctx)->words++;
    return 0;
}

static int on_mark(void *ctx, const char *name, uint64_t at) {
    (void)ctx, (void)name, (void)at;
    return 0;
}

static int on_warning(void *ctx, const char *message) {
    (void)ctx;
    FUZZ_CHECK(*message);
    return 0;
}

static void give(struct fuzz_input *in) {
    const struct faccia_span span = {.kind = FACCIA_SPAN_TEXT, .text = "uno due tre"};
    const struct faccia_sentence sentence = {.voice = "a", .spans = &span, .span_count = 1};
    struct heard heard = {0};
    const struct faccia_sink sink = {sizeof sink, &heard, on_audio, on_phone, on_word, on_mark, on_warning};
    struct cm_stop stop = {.wake = -1};
    struct cm_aligner aligner = {0};
    char message[200] = "", path[FUZZ_PATH];
    uint8_t choice = fuzz_u8(in);
    struct cm_voice voice = {.info = {.id = "a", .lang = "it", .gender = "female"},
                             .argv = json_pack("[s]", "say"),
                             .raw = choice & 128 ? 8000 : 0,
                             .bytes = 1 << 20,
                             .timing = {.given = true, .options = {.format = choice % (TIMES_FORMATS + 1)}}};
    struct cm_speaking s = {.voice = &voice,
                            .sentence = &sentence,
                            .sink = &sink,
                            .stop = &stop,
                            .aligner = &aligner,
                            .silence = choice & 64 ? 0.5 : 0,
                            .message = message,
                            .cap = sizeof message};
    size_t size = fuzz_u16(in);
    uint8_t *times = fuzz_bytes(in, &size);
    fuzz_write("times", times, size, path);
    FUZZ_CHECK(strlen(path) < sizeof s.times);
    memcpy(s.times, path, strlen(path) + 1);
    struct buf sound = {0};
    buf_add(&sound, in->at, fuzz_left(in));
    enum cm_result result = cm_give(&s, 0, &sound);
    FUZZ_CHECK(result != CM_FAILED || *message);
    FUZZ_CHECK(result != CM_DONE || heard.samples == s.at);
    buf_free(&sound);
    free(times);
    json_decref((json_t *)voice.argv);
    cm_aligner_close(&aligner);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    static json_t *base;
    struct fuzz_input in = fuzz_input(data, size);
    uint8_t kind = fuzz_u8(&in) % 3;
    if (!base)
        base = json_loads(configuration, 0, NULL);
    if (kind == 2) {
        give(&in);
    } else {
        json_t *edited = kind ? fuzz_edit_json(base, &in) : NULL;
        char *text = kind ? json_dumps(edited, JSON_ENCODE_ANY) : fuzz_rest_text(&in);
        configure(text);
        json_decref(edited);
        free(text);
    }
    return 0;
}
