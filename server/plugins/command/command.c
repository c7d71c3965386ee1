/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The command voice plugin: speaks with programs from its configuration. */
#include "server/base/mem.h"
#include "server/plugins/command/command_internal.h"
#include "server/voice/wire.h"
#include <dlfcn.h>
#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

struct command {
    struct cm_voices voices;
    struct cm_stop stop;
    struct cm_aligner aligner;
    char beside[PATH_MAX]; /* the plugin's folder */
};

static bool has_words(const char *text) {
    for (; text && *text; text++)
        if (!strchr(" \t\r\n.,;:!?()\"'-", *text))
            return true;
    return false;
}

static enum cm_result speak_span(struct cm_speaking *s, uint32_t index) {
    const struct faccia_span *span = &s->sentence->spans[index];
    struct buf sound = {0};
    if (!has_words(span->text))
        return CM_DONE;
    if (span->phones)
        s->sink->warning(s->sink->ctx, "the voice reads the text instead of the given phones");
    enum cm_result result = cm_ask(s, s->voice->argv, span, &sound);
    if (result == CM_DONE && s->voice->file) {
        sound.size = 0;
        result = cm_take_file(s, s->output, &sound) < 0 ? CM_FAILED : CM_DONE;
    }
    if (result == CM_DONE)
        result = cm_give(s, index, &sound);
    buf_free(&sound);
    return result;
}

static enum cm_result speak_all(struct cm_speaking *s) {
    enum cm_result result = CM_DONE;
    for (uint32_t i = 0; i < s->sentence->span_count && result == CM_DONE; i++) {
        const struct faccia_span *span = &s->sentence->spans[i];
        if (span->kind == FACCIA_SPAN_TEXT)
            result = speak_span(s, i);
        else if (span->kind == FACCIA_SPAN_BREAK && !s->rate)
            s->silence += span->seconds;
        else if (span->kind == FACCIA_SPAN_BREAK)
            result = cm_give_silence(s, span->seconds);
        else if (span->kind == FACCIA_SPAN_MARK && s->sink->mark(s->sink->ctx, span->text, s->at))
            result = CM_STOPPED;
    }
    return result;
}

static int cm_speak(void *ctx, const struct faccia_sentence *sentence, const struct faccia_sink *sink,
                    char *message, size_t cap) {
    struct command *self = ctx;
    struct cm_speaking s = {.voice = cm_voices_find(&self->voices, sentence->voice),
                            .sentence = sentence,
                            .sink = sink,
                            .stop = &self->stop,
                            .aligner = &self->aligner,
                            .beside = self->beside,
                            .message = message,
                            .cap = cap};
    if (!s.voice) {
        snprintf(message, cap, "no program is configured as \"%s\"", sentence->voice);
        return -1;
    }
    snprintf(s.folder, sizeof s.folder, "/tmp/faccia-voice-XXXXXX");
    if (!mkdtemp(s.folder)) {
        snprintf(message, cap, "no folder in /tmp: %s", strerror(errno));
        return -1;
    }
    snprintf(s.output, sizeof s.output, "%s/sound", s.folder);
    snprintf(s.times, sizeof s.times, "%s/times", s.folder);
    cm_stop_reset(&self->stop);
    enum cm_result result = speak_all(&s);
    unlink(s.output);
    unlink(s.times);
    rmdir(s.folder);
    return result == CM_FAILED ? -1 : 0;
}

static void cm_cancel(void *ctx) {
    cm_stop_now(&((struct command *)ctx)->stop);
}

static void cm_list(void *ctx, void (*each)(void *ctx, const struct faccia_voice_info *voice),
                    void *each_ctx) {
    const struct command *self = ctx;
    for (size_t i = 0; i < self->voices.count; i++)
        each(each_ctx, &self->voices.list[i].info);
}

static void cm_close(void *ctx) {
    struct command *self = ctx;
    cm_config_free(&self->voices);
    cm_aligner_close(&self->aligner);
    cm_stop_close(&self->stop);
    free(self);
}

extern const struct faccia_voice faccia_voice; /* defined below */

static void find_beside(char beside[PATH_MAX]) {
    Dl_info info;
    if (!dladdr(&faccia_voice, &info) || !realpath(info.dli_fname, beside))
        snprintf(beside, PATH_MAX, "./");
    *strrchr(beside, '/') = '\0';
}

static int cm_open(const char *config, void **out, char *message, size_t cap) {
    struct command *self = mem_alloc(sizeof *self);
    int result = cm_stop_open(&self->stop);
    find_beside(self->beside);
    if (result < 0)
        snprintf(message, cap, "no event descriptor is left");
    else
        result = cm_config_read(&self->voices, config, message, cap);
    *out = self;
    if (result)
        cm_close(self);
    return result;
}

__attribute__((visibility("default"))) const struct faccia_voice faccia_voice = {
    .abi = FACCIA_VOICE_ABI,
    .size = sizeof(struct faccia_voice),
    .name = "command",
    .version = FACCIA_VERSION,
    .licence = "GPL-3.0-or-later",
    .capabilities = FACCIA_VOICE_MARKS | FACCIA_VOICE_UNTIMED | FACCIA_VOICE_NETWORK | FACCIA_VOICE_PROGRAMS |
                    FACCIA_VOICE_FILES | WORKER_SPAWNER_WANTED,
    .open = cm_open,
    .list = cm_list,
    .speak = cm_speak,
    .cancel = cm_cancel,
    .close = cm_close,
};
