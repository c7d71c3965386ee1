/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Phones as text. Byte 0 selects: IPA, X-SAMPA, a timed transcription, or phones to look up in a pack; byte
 * 1: maximum size of the result, or the pack. */
#include "server/base/mem.h"
#include "server/base/sampa.h"
#include "server/base/utf8.h"
#include "server/face/packs/phone_match.h"
#include "server/face/packs/speech_pack.h"
#include "server/face/packs/spelling.h"
#include "server/face/packs/transcription.h"
#include "tests/fuzz/fuzz.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const struct speech_pack *pack(const char *lang) {
    static struct speech_packs loaded;
    struct error e;
    FUZZ_CHECK(loaded.count || !speech_packs_load(&loaded, SOURCE_ROOT "/models/speech", &e));
    return speech_packs_find(&loaded, lang);
}

typedef size_t convert(const char *from, char *out, size_t cap);

/* Output that does not fit is truncated after a whole symbol. */
static char *converted(convert *to, const char *text, size_t cap) {
    char *out = mem_alloc(cap);
    to(text, out, cap);
    FUZZ_CHECK(memchr(out, 0, cap));
    FUZZ_CHECK(utf8_check(out, strlen(out)) == strlen(out));
    return out;
}

static void there_and_back(convert *to, convert *back, const char *text, size_t cap) {
    char *short_one = converted(to, text, cap), *whole = converted(to, text, 8 * strlen(text) + 8);
    char *again = converted(back, whole, 8 * strlen(whole) + 8);
    FUZZ_CHECK(!strncmp(short_one, whole, strlen(short_one)));
    free(again);
    free(whole);
    free(short_one);
}

static void transcribe(const char *text, size_t size, uint8_t choice) {
    const struct transcription_sound other = {choice, 1 + choice * 1000u, 1 + choice % 4};
    struct error e = {0};
    struct sentence_audio *u =
        transcription_read(text, size, choice ? &other : &transcription_wav, pack("pt-BR"), &e);
    FUZZ_CHECK(u || e.code);
    uint32_t at = 0;
    for (size_t i = 0; u && i < u->phone_count; i++) {
        FUZZ_CHECK(u->phones[i].start == at && u->phones[i].end >= at);
        at = u->phones[i].end;
    }
    sentence_audio_free(u);
}

static void find(const char *text, uint8_t choice) {
    static const char *const langs[] = {"it", "en", "pt-BR", "tr", "und", "cmn"};
    const struct speech_pack *in = pack(langs[choice % 6]);
    struct phone_matches *found = mem_alloc(sizeof *found);
    phone_match_find(in, text, found);
    double share = 0;
    FUZZ_CHECK(found->count <= PHONE_MATCHES_MAX);
    for (size_t i = 0; i < found->count; i++) {
        FUZZ_CHECK(found->match[i].phone && found->match[i].share >= 0);
        share += found->match[i].share;
    }
    FUZZ_CHECK(!found->count || fabs(share - 1) < 1e-6);
    free(found);
    if (choice % 6 == 3) {
        struct spelled *letters = NULL;
        size_t count = spelling_read(in->letters, text, &letters);
        spelling_syllables(letters, count);
        for (size_t i = 0; i < count; i++)
            FUZZ_CHECK(spelling_shape(in->letters, &letters[i]) < in->letters->common.shapes.count);
        free(letters);
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    struct fuzz_input in = fuzz_input(data, size);
    uint8_t kind = fuzz_u8(&in) % 4, choice = fuzz_u8(&in);
    size_t length = fuzz_left(&in);
    uint8_t *bytes = fuzz_rest(&in, &length);
    char *text = mem_strndup((char *)bytes, length);
    if (kind == 0)
        there_and_back(sampa_from_ipa, sampa_to_ipa, text, 1u + choice);
    else if (kind == 1)
        there_and_back(sampa_to_ipa, sampa_from_ipa, text, 1u + choice);
    else if (kind == 2)
        transcribe((char *)bytes, length, choice);
    else
        find(text, choice);
    free(text);
    free(bytes);
    return 0;
}
