/* SPDX-License-Identifier: GPL-3.0-or-later */
/* From a request to a score with its voices: what can be said of it before anything is spoken. */
#include "server/base/mem.h"
#include "server/base/suggest.h"
#include "server/markup/language_runs.h"
#include "server/synthesis/synthesis_internal.h"
#include <stdlib.h>
#include <string.h>

static int no_markup(const char *name, struct error *e) {
    struct suggestions near = suggestions_for(name);
    char text[SUGGESTIONS_TEXT];
    for (const struct markup_kind *kind = markup_kinds; kind->name; kind++)
        suggest_name(&near, kind->name, kind->name);
    return error_in_field(e, ERROR_UNKNOWN_MARKUP, "markup", "no markup '%s'%s", name,
                          suggestions_text(&near, text));
}

/* From here on the request's text is what all places count in. */
static int decode_text(struct synthesis *s, struct error *e) {
    char *text;
    size_t size;
    const char *name = s->request.markup ? s->request.markup : "auto";
    s->markup = markup_by_name(name);
    if (!s->markup)
        return no_markup(name, e);
    if (s->request.open) {
        writing_open(s);
        s->markup = markup_by_name("plain"); /* until it is known better */
        return 0;
    }
    if (!s->request.text)
        return error_plain_in_field(e, ERROR_MISSING_FIELD, "text");
    if (markup_decode(s->request.text, s->request.text_size, &text, &size, e))
        return -1;
    if (text) {
        free(s->request.text);
        s->request.text = text;
        s->request.text_size = size;
    }
    s->markup = markup_detect(s->markup, s->request.text, s->request.text_size);
    return 0;
}

/* In any thread: what is reached from here does not change while texts are read. */
static void read_text(struct synthesis *s) {
    struct reading_result *r = &s->result;
    struct markup_rules rules = synthesis_rules(s);
    struct language_runs runs = {0};
    const char *languages = s->request.languages;
    if (languages && language_runs_read(&runs, languages, s->request.text, s->request.text_size, &r->error))
        return;
    rules.runs = &runs;
    r->document = markup_read(s->markup, s->request.text, s->request.text_size, &rules, &r->error);
    language_runs_free(&runs);
    if (r->document && markup_given_up(&rules)) { /* much to free, which is better done here */
        score_free(r->document);
        r->document = NULL;
    }
    if (r->document)
        synthesis_direct(s, r);
}

static void take_result(struct synthesis *s) {
    s->score = s->result.score;
    s->chosen = s->result.chosen;
    voice_pool_let_go(s->pipeline->voices);
}

static void on_work(uv_work_t *work) {
    read_text(work->data);
}

static void after_work(uv_work_t *work, int status) {
    struct synthesis *s = work->data;
    s->reading = false;
    take_result(s);
    if (status) /* it was cancelled before it began */
        error_set(&s->result.error, ERROR_CANCELLED, "the text was not read");
    synthesis_go_on(s);
}

static int begin_reading(struct synthesis *s, struct error *e) {
    s->voices = voice_pool_hold(s->pipeline->voices);
    if (s->pipeline->long_text && s->request.text_size >= s->pipeline->long_text) {
        s->reading = true;
        s->work.data = s;
        uv_queue_work(s->pipeline->loop, &s->work, on_work, after_work);
        return 0;
    }
    read_text(s);
    take_result(s);
    *e = s->result.error;
    return s->score ? 0 : -1;
}

/* Whether a plugin that is still starting could not change the choice of voices any more. Marked-up text may
 * name any. */
static bool is_settled(const struct synthesis *s) {
    const struct voice_pool *voices = s->pipeline->voices;
    const char *lang = s->request.lang ? s->request.lang : s->pipeline->default_lang;
    const struct speech_pack *pack = speech_packs_find(s->pipeline->packs, lang);
    if (!voices)
        return true;
    if (s->markup != markup_by_name("plain") || !pack || speech_pack_is_general(pack))
        return voice_pool_settled(voices, NULL, NULL);
    return voice_pool_settled(voices, s->request.voice, speech_pack_voices(pack));
}

static int choose_and_read(struct synthesis *s, struct error *e) {
    if (synthesis_choose(s, e))
        return -1;
    if (!s->writing)
        return begin_reading(s, e);
    writing_begin(s);
    return 0;
}

static void on_voices(void *ctx) {
    struct synthesis *s = ctx;
    if (!is_settled(s))
        return;
    voice_wait_end(s->wait);
    s->wait = NULL;
    struct error e;
    if (choose_and_read(s, &e))
        s->result.error = e;
    if (!s->reading)
        synthesis_go_on(s);
}

struct synthesis *synthesis_open(const struct pipeline *pipeline, const struct speech_request *request,
                                 const struct synthesis_callbacks *callbacks, void *ctx, struct error *e) {
    struct synthesis *s = mem_alloc(sizeof *s);
    s->pipeline = pipeline;
    s->expressions = expressions_share(pipeline->expressions);
    s->callbacks = *callbacks;
    s->ctx = ctx;
    request_copy(&s->request, request);
    if (s->request.contacts == CONTACTS_ENGINE)
        s->request.contacts = pipeline->default_contacts;
    int result = decode_text(s, e);
    if (!result && !is_settled(s))
        s->wait = voice_pool_wait(pipeline->voices, on_voices, s);
    else if (!result)
        result = choose_and_read(s, e);
    if (result) {
        synthesis_free(s);
        return NULL;
    }
    return s;
}
