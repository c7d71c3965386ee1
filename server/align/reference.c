/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/align/reference.h"
#include "server/base/lang.h"
#include "server/base/mem.h"
#include "server/voice/faccia-voice.h"
#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#define CODE ERROR_NO_REFERENCE
/* A man and a woman for every language. */
#define CONFIG "{\"variants\": [\"f2\"]}"

struct known {
    char *id, *lang;
    bool female;
};

struct reference {
    void *library;
    const struct faccia_voice *api;
    void *self;
    struct known *voices;
    size_t voice_count, voice_cap;
    struct reference_speech *out; /* of the sentence that is spoken */
    uint64_t before;              /* samples that it had */
    size_t text_from;
};

static void keep_voice(void *ctx, const struct faccia_voice_info *voice) {
    struct reference *r = ctx;
    r->voices = mem_grow(r->voices, &r->voice_cap, r->voice_count + 1, sizeof *r->voices);
    r->voices[r->voice_count++] =
        (struct known){mem_strdup(voice->id), mem_strdup(voice->lang), !strcmp(voice->gender, "female")};
}

struct reference *reference_open(const char *path, struct error *e) {
    struct reference *r = mem_alloc(sizeof *r);
    char message[200] = "";
    r->library = dlopen(path, RTLD_NOW | RTLD_LOCAL);
    r->api = r->library ? dlsym(r->library, FACCIA_VOICE_SYMBOL) : NULL;
    if (!r->api || r->api->abi != FACCIA_VOICE_ABI) {
        error_set(e, CODE, "no voice to align to: %.180s is no plugin that can be loaded", path);
        r->api = NULL;
    } else if (r->api->open(CONFIG, &r->self, message, sizeof message)) {
        error_set(e, CODE, "no voice to align to: %s", message);
        r->self = NULL;
    } else {
        r->api->list(r->self, keep_voice, r);
        return r;
    }
    reference_close(r);
    return NULL;
}

void reference_close(struct reference *r) {
    if (!r)
        return;
    if (r->self)
        r->api->close(r->self);
    for (size_t i = 0; i < r->voice_count; i++) {
        free(r->voices[i].id);
        free(r->voices[i].lang);
    }
    free(r->voices);
    free(r); /* the library stays, as engines leave threads and atexit handlers behind */
}

struct reference *reference_get(struct reference_slot *slot, struct error *e) {
    if (!slot->reference)
        slot->reference = reference_open(slot->path, e);
    return slot->reference;
}

void reference_path(char *out, size_t cap) {
    Dl_info info;
    const char *file = dladdr((void *)(uintptr_t)reference_path, &info) ? info.dli_fname : "",
               *slash = strrchr(file, '/');
    snprintf(out, cap, "%.*sespeak.so", slash ? (int)(slash - file) + 1 : 0, file);
}

const char *reference_voice(const struct reference *r, const char *lang, const char *gender) {
    const struct known *best = NULL;
    lang = lang_usual(lang);
    size_t primary = strcspn(lang, "-");
    bool female = !strcmp(gender, "female");
    for (size_t i = 0; i < r->voice_count; i++) {
        const struct known *v = &r->voices[i];
        if (v->female != female)
            continue;
        if (!strcasecmp(v->lang, lang))
            return v->id;
        if (!best && !strncasecmp(v->lang, lang, primary) && strcspn(v->lang, "-") == primary)
            best = v;
    }
    return best ? best->id : "";
}

static int on_audio(void *ctx, const int16_t *samples, size_t count, uint32_t rate) {
    struct reference_speech *s = ((struct reference *)ctx)->out;
    s->pcm = mem_grow(s->pcm, &s->pcm_cap, s->samples + count, sizeof *s->pcm);
    memcpy(s->pcm + s->samples, samples, count * sizeof *samples);
    s->samples += count;
    s->rate = rate;
    return 0;
}

static int on_phone(void *ctx, const struct faccia_phone *phone) {
    struct reference *r = ctx;
    struct reference_speech *s = r->out;
    s->phones = mem_grow(s->phones, &s->phone_cap, s->phone_count + 1, sizeof *s->phones);
    struct reference_phone *p = &s->phones[s->phone_count++];
    *p = (struct reference_phone){
        .stress = (uint8_t)phone->stress, .start = r->before + phone->start, .end = r->before + phone->end};
    snprintf(p->ipa, sizeof p->ipa, "%s", phone->ipa);
    return 0;
}

static int on_word(void *ctx, const struct faccia_word *word) {
    struct reference *r = ctx;
    struct reference_speech *s = r->out;
    s->words = mem_grow(s->words, &s->word_cap, s->word_count + 1, sizeof *s->words);
    size_t from = r->text_from + word->offset;
    s->words[s->word_count++] = (struct reference_word){from, from + word->bytes, r->before + word->start};
    return 0;
}

static int on_mark(void *ctx, const char *name, uint64_t at) {
    (void)ctx, (void)name, (void)at;
    return 0;
}

static int on_warning(void *ctx, const char *message) {
    (void)ctx, (void)message;
    return 0;
}

int reference_speak(struct reference *r, const char *voice, const char *text, size_t from, size_t to,
                    struct reference_speech *out, struct error *e) {
    char message[200] = "", *copy = mem_strndup(text + from, to - from);
    const struct faccia_span span = {
        .kind = FACCIA_SPAN_TEXT, .text = copy, .pitch = 1, .range = 1, .volume = 1};
    const struct faccia_sentence sentence = {voice, &span, 1};
    const struct faccia_sink sink = {sizeof sink, r, on_audio, on_phone, on_word, on_mark, on_warning};
    r->out = out;
    r->before = out->samples;
    r->text_from = from;
    int result = r->api->speak(r->self, &sentence, &sink, message, sizeof message);
    free(copy);
    return result ? error_set(e, CODE, "the voice to align to failed: %s", message) : 0;
}

void reference_clear(struct reference_speech *s) {
    s->samples = s->phone_count = s->word_count = 0;
}

void reference_free(struct reference_speech *s) {
    free(s->pcm);
    free(s->phones);
    free(s->words);
    *s = (struct reference_speech){0};
}
