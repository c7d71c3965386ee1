/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Frames from and to a worker. Any answer of a worker to a sentence becomes an utterance or an error. */
#include "server/voice/assembly.h"
#include "server/voice/voice_pool_internal.h"
#include "tests/fuzz/fuzz.h"
#include <stdlib.h>
#include <string.h>

static const struct voice_request *request(void) {
    static struct voice_request made;
    if (!made.span_count) {
        struct score *score = score_new();
        struct score_item *item = score_add(score, SCORE_TEXT, 0, 9);
        item->text = "Perch\xC3\xA9 no";
        item->verbatim = true;
        score_add(score, SCORE_MARK, 9, 10)->text = "qui";
        score_add(score, SCORE_BREAK, 10, 11)->seconds = 0.5;
        item = score_add(score, SCORE_TEXT, 11, 20);
        item->text = "due tre.";
        score_end_sentence(score);
        voice_request_make(&made, score, 0, &(struct voice_prosody){.pitch = 1, .volume = 1});
        score_free(score);
    }
    return &made;
}

static void check_utterance(const struct sentence_audio *u) {
    uint32_t at = 0;
    for (size_t i = 0; i < u->phone_count; i++) {
        const struct phone *p = &u->phones[i];
        FUZZ_CHECK(p->start == at && p->end >= p->start && p->stress <= 2);
        FUZZ_CHECK(memchr(p->ipa, 0, sizeof p->ipa) && memchr(p->symbol, 0, sizeof p->symbol));
        at = p->end;
    }
    FUZZ_CHECK(at == u->samples || !u->phone_count);
    for (size_t i = 0; i < u->word_count; i++)
        FUZZ_CHECK(u->words[i].start <= u->words[i].end && u->words[i].end <= u->samples &&
                   u->words[i].from <= u->words[i].to && u->words[i].to <= 20);
    for (size_t i = 0; i < u->mark_count; i++)
        FUZZ_CHECK(u->marks[i].name && u->marks[i].at <= u->samples);
    FUZZ_CHECK(!u->samples || u->pcm);
}

static void take_voices(const char *description) {
    struct catalog catalog = {0};
    struct error e = {0};
    FUZZ_CHECK(!catalog_add(&catalog, "m", "{\"voices\": [{\"id\": \"a\"}]}", &e));
    FUZZ_CHECK(!catalog_add(&catalog, "x", description, &e) || e.code);
    for (size_t i = 0; i < catalog.count; i++) {
        const struct voice *v = &catalog.voices[i];
        FUZZ_CHECK(v->id && v->name && v->lang && v->gender && v->quality && v->licence &&
                   v->sample_rate >= 8000);
    }
    catalog_free(&catalog);
}

static void read_told(const struct wire_frame *frame) {
    struct faccia_sentence sentence;
    struct faccia_span *spans = NULL;
    struct wire_reader r = wire_read(frame);
    if (frame->type == WIRE_OPEN) {
        wire_get_string(&r);
        wire_get_limits(&r);
    } else if (frame->type == WIRE_SPEAK) {
        wire_get_u32(&r);
        if (wire_get_sentence(&r, &sentence, &spans))
            for (size_t i = 0; i < sentence.span_count; i++)
                FUZZ_CHECK(!spans[i].text || strlen(spans[i].text) < frame->size);
        free(spans);
    } else if (frame->type == WIRE_DONE) {
        wire_get_u32(&r);
        wire_get_string(&r);
    } else {
        const char *text = wire_get_string(&r);
        if (text && frame->type == WIRE_HELLO)
            take_voices(text);
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    struct assembly *a = assembly_new(request());
    struct wire_frame frame;
    struct error e = {0};
    size_t used;
    int failed = 0;
    for (size_t at = 0; !failed && wire_next(data + at, size - at, &frame, &used) > 0; at += used) {
        FUZZ_CHECK(used <= size - at && frame.size + WIRE_HEADER_BYTES == used);
        if (frame.type == WIRE_AUDIO)
            failed = assembly_audio(a, &frame, &e);
        else if (frame.type == WIRE_EVENTS)
            failed = assembly_events(a, &frame, &e);
        else
            read_told(&frame);
    }
    FUZZ_CHECK(!failed || e.code);
    if (!failed) {
        struct sentence_audio *u = assembly_finish(a, "it", 22050, NULL);
        check_utterance(u);
        sentence_audio_free(u);
    }
    assembly_free(a);
    return 0;
}
