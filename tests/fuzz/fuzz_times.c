/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Files of times. Byte 0: the format; byte 1: the requested names, tiers and entries; the rest is the file.
 */
#include "server/face/packs/speech_pack.h"
#include "server/library/align/times.h"
#include "tests/fuzz/fuzz.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const struct speech_pack *pack(void) {
    static struct speech_pack *loaded;
    struct error e;
    if (!loaded)
        loaded = speech_pack_load(SOURCE_ROOT "/models/speech/pt-BR.json", &e);
    return loaded;
}

static const json_t *names(void) {
    static json_t *table;
    if (!table)
        table = json_pack("{ss ss ss ss}", "a", "a", "pau", "", "a1", "ˈa", "tS", "t͡ʃ");
    return table;
}

static void check(const struct times *t) {
    for (size_t i = 0; i < t->phone_count; i++) {
        const struct times_phone *p = &t->phones[i];
        FUZZ_CHECK(memchr(p->name, 0, sizeof p->name) && memchr(p->ipa, 0, sizeof p->ipa));
        FUZZ_CHECK(p->start >= 0 && p->end >= p->start && isfinite(p->end) && p->stress <= 2);
        FUZZ_CHECK(!i || p->start >= t->phones[i - 1].end);
    }
    for (size_t i = 0; i < t->word_count; i++) {
        const struct times_word *w = &t->words[i];
        FUZZ_CHECK(w->text && w->start >= 0 && w->end >= w->start && isfinite(w->end));
        FUZZ_CHECK(!i || w->start >= t->words[i - 1].start);
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    struct fuzz_input in = fuzz_input(data, size);
    enum times_format format = fuzz_below(&in, TIMES_FORMATS + 1);
    uint8_t choice = fuzz_u8(&in);
    const struct times_options options = {.format = format,
                                          .tier = choice & 1 ? "fonemi" : NULL,
                                          .word_tier = choice & 2 ? "parole" : NULL,
                                          .entry = choice & 4 ? "frase" : NULL,
                                          .names = choice & 8 ? names() : NULL,
                                          .pack = choice & 16 ? NULL : pack()};
    struct times times;
    struct error e = {0};
    char *text = (char *)fuzz_rest(&in, &size);
    if (!times_read(&times, &options, text, size, &e))
        check(&times);
    else
        FUZZ_CHECK(e.code);
    times_free(&times);
    free(text);
    return 0;
}
