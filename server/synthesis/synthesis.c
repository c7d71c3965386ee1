/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A synthesis: opening, delivery, seeking and queries. */
#include "server/base/mem.h"
#include "server/base/suggest.h"
#include "server/markup/dialogue.h"
#include "server/markup/language_runs.h"
#include "server/synthesis/synthesis_internal.h"
#include <stdlib.h>
#include <string.h>

bool synthesis_find_mark(const struct synthesis *s, const char *name, size_t *sentence) {
    for (size_t i = 0; i < synthesis_sentences(s); i++) {
        const struct score_sentence *in = &s->score->sentences[i];
        for (size_t k = in->first; k < in->first + in->count; k++)
            if (s->score->items[k].kind == SCORE_MARK && !strcmp(s->score->items[k].text, name)) {
                *sentence = i;
                return true;
            }
    }
    return false;
}

void synthesis_near_marks(const struct synthesis *s, struct suggestions *near) {
    for (size_t i = 0; s->score && i < s->score->item_count; i++)
        if (s->score->items[i].kind == SCORE_MARK)
            suggest_name(near, s->score->items[i].text, s->score->items[i].text);
}

size_t synthesis_sentences(const struct synthesis *s) {
    return s->score ? s->score->sentence_count : 0;
}

size_t synthesis_next(const struct synthesis *s) {
    return s->delivered;
}

const char *synthesis_entry(const struct synthesis *s) {
    return s->entry;
}

const struct score *synthesis_score(const struct synthesis *s) {
    return s->score;
}

const struct voice *synthesis_voice(const struct synthesis *s) {
    return s->voice;
}

const char *synthesis_markup(const struct synthesis *s) {
    return s->markup->name;
}

bool synthesis_has_speakers(const struct synthesis *s) {
    return s->request.speaker || s->speakers.count;
}

const struct speaker *synthesis_speaker(const struct synthesis *s, size_t byte) {
    if (s->speakers.count)
        return speaker_runs_at(&s->speakers, byte, NULL);
    return s->request.speaker ? &s->alone : NULL;
}

const struct speech_request *synthesis_request(const struct synthesis *s) {
    return &s->request;
}

/* Opening: from a request to a score with its voices. */

static int no_markup(const char *name, struct error *e) {
    struct suggestions near = suggestions_for(name);
    char text[SUGGESTIONS_TEXT];
    for (const struct markup_kind *kind = markup_kinds; kind->name; kind++)
        suggest_name(&near, kind->name, kind->name);
    return error_in_field(e, ERROR_UNKNOWN_MARKUP, "markup", "no markup '%s'%s", name,
                          suggestions_text(&near, text));
}

static int check_affect(const struct synthesis *s, struct error *e) {
    const char *name = s->request.affect;
    if (!name || (s->expressions && expressions_find(s->expressions, "affect", name) >= 0))
        return 0;
    struct suggestions near = suggestions_for(name);
    char text[SUGGESTIONS_TEXT];
    if (s->expressions)
        near = expressions_near(s->expressions, "affect", name);
    return error_in_field(e, ERROR_UNKNOWN_EXPRESSION, "affect", "unknown affect '%.80s'%s", name,
                          suggestions_text(&near, text));
}

static void writing_open(struct synthesis *s);

/* Converts the text to UTF-8. From here on, places in errors refer to the converted text. */
static int decode_text(struct synthesis *s, struct error *e) {
    char *text;
    size_t size;
    const char *name = s->request.markup ? s->request.markup : "auto";
    s->markup = markup_by_name(name);
    if (!s->markup)
        return no_markup(name, e);
    if (s->request.open) {
        writing_open(s);
        s->markup = markup_by_name("plain"); /* until the kind is known */
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

static void drop_reading(struct reading_result *r, const struct markup_rules *rules) {
    enum error_code code;
    const char *why = markup_why_given_up(rules, &code);
    score_free(r->document);
    score_free(r->score);
    voice_selection_free(r->chosen);
    *r = (struct reading_result){0};
    error_set(&r->error, code, "%s", why);
}

/* Limit of processor time for parsing a text, in s, and addition per megabyte: many times what the slowest
 * text takes. */
enum { READ_SECONDS = 10, READ_SECONDS_EACH = 20 };

/* Callable from any thread: nothing reached from here changes while texts are parsed. */
static void read_text(struct synthesis *s) {
    struct reading_result *r = &s->result;
    struct markup_rules rules = synthesis_rules(s);
    struct work_limit limit = work_limit_begin(
        &s->given_up, READ_SECONDS + READ_SECONDS_EACH * (unsigned)(s->request.text_size >> 20));
    struct language_runs runs = {0};
    const char *languages = s->request.languages;
    if (languages && language_runs_read(&runs, languages, s->request.text, s->request.text_size, &r->error))
        return;
    const char *speakers = s->request.speakers;
    if (speakers &&
        speaker_runs_read(&s->speakers, speakers, s->request.text, s->request.text_size, &r->error)) {
        language_runs_free(&runs);
        return;
    }
    if (!speakers && s->request.dialogue == DIALOGUE_VOICES && !strcmp(s->markup->name, "plain"))
        dialogue_find(&s->speakers, s->request.text, s->request.text_size, synthesis_lang(s));
    rules.runs = &runs;
    rules.speakers = &s->speakers;
    rules.limit = &limit;
    r->document = markup_read(s->markup, s->request.text, s->request.text_size, &rules, &r->error);
    language_runs_free(&runs);
    if (r->document && !markup_given_up(&rules))
        synthesis_direct(s, r, &limit);
    if (r->document && markup_given_up(&rules))
        drop_reading(r, &rules); /* freed here, because freeing a large result would block the loop */
}

static void take_result(struct synthesis *s) {
    s->score = s->result.score;
    s->chosen = s->result.chosen;
    voice_pool_release(s->pipeline->voices);
}

static void on_work(uv_work_t *work) {
    read_text(work->data);
}

static void synthesis_go_on(struct synthesis *s);

static void after_work(uv_work_t *work, int status) {
    struct synthesis *s = work->data;
    s->reading = false;
    take_result(s);
    if (status) /* cancelled before it started */
        error_set(&s->result.error, ERROR_CANCELLED, "the text was not read");
    synthesis_go_on(s);
}

static int begin_reading(struct synthesis *s, struct error *e) {
    s->voices = voice_pool_retain(s->pipeline->voices);
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

/* Tells whether a plugin that is still starting could no longer change the choice of voices. Marked-up
 * text may name any voice. */
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

static const struct speech_source_ops source_ops;

/* Lists the lexicons by precedence, if the request or its surroundings bring some; the pipeline's are used
 * directly otherwise. */
static int gather_lexicons(struct synthesis *s, const struct lexicons *around, struct error *e) {
    const struct pipeline *p = s->pipeline;
    const char *text = s->request.lexicon;
    struct lexicon *own = text && *text ? lexicon_read_sent(text, strlen(text), e) : NULL;
    if (own)
        lexicons_add(&s->lexicons, own);
    else if (text && *text)
        return -1;
    const char *place = s->request.passage ? s->request.passage : s->request.work;
    if (place && p->passage_lexicons)
        p->passage_lexicons(p->library, place, &s->lexicons);
    lexicons_add_all(&s->lexicons, around);
    if (s->lexicons.count)
        lexicons_add_all(&s->lexicons, p->lexicons);
    return 0;
}

struct synthesis *synthesis_open(const struct pipeline *pipeline, const struct speech_request *request,
                                 const struct synthesis_callbacks *callbacks, void *ctx, struct error *e) {
    struct synthesis *s = mem_alloc(sizeof *s);
    s->base = (struct speech_source){
        .ops = &source_ops, .request = &s->request, .text = s, .own_face = request->seed >= 0};
    s->pipeline = pipeline;
    s->expressions = expressions_share(pipeline->expressions);
    s->callbacks = *callbacks;
    s->ctx = ctx;
    request_copy(&s->request, request);
    s->alone = (struct speaker){.id = s->request.speaker, .name = s->request.speaker, .pitch = 1, .rate = 1};
    if (s->request.contacts == CONTACTS_ENGINE)
        s->request.contacts = pipeline->default_contacts;
    int result = check_affect(s, e) || gather_lexicons(s, request->around, e) || decode_text(s, e) ? -1 : 0;
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

static void synthesis_deliver(struct synthesis *s);

static void on_done(void *ctx, struct sentence_audio *audio) {
    struct slot *slot = ctx;
    slot->job = NULL;
    slot->audio = audio;
    metrics_add(slot->synthesis->pipeline->metrics, METRIC_SENTENCES, 1);
    synthesis_deliver(slot->synthesis);
}

static void on_failed(void *ctx, const struct error *e) {
    struct slot *slot = ctx;
    slot->job = NULL;
    slot->failure = *e;
    metrics_add(slot->synthesis->pipeline->metrics, METRIC_SENTENCES_FAILED, 1);
    synthesis_deliver(slot->synthesis);
}

static enum voice_priority priority_of(const struct synthesis *s, const struct slot *slot) {
    return s->request.ahead                ? VOICE_PRIORITY_BACKGROUND
           : slot->sentence == s->released ? VOICE_PRIORITY_URGENT
                                           : VOICE_PRIORITY_NORMAL;
}

static void ask_voice(struct synthesis *s, struct slot *slot) {
    static const struct voice_callbacks callbacks = {on_done, on_failed};
    struct sentence_request request = {.voice = s->voice,
                                       .score = s->score,
                                       .sentence = slot->sentence,
                                       .rate = s->request.rate,
                                       .pitch = s->request.pitch,
                                       .volume = s->request.volume,
                                       .priority = priority_of(s, slot),
                                       .quota_key = s->request.quota_key,
                                       .connection = s->request.connection,
                                       .reader = s->pipeline->reader,
                                       .gate = s->pipeline->gate};
    synthesis_normalize(s, s->result.score, s->chosen, slot->sentence);
    metrics_add(s->pipeline->metrics, METRIC_SENTENCES_ASKED, 1);
    slot->job = sentence_speak(s->pipeline->voices, s->pipeline->loop, &request, s->chosen, &callbacks, slot);
}

static bool has_sentence(struct synthesis *s, size_t sentence) {
    return sentence < s->score->sentence_count || (s->writing && writing_read(s));
}

/* Skips sentences already spoken or in progress. */
static void synthesis_submit(struct synthesis *s) {
    if (!s->started || !s->score)
        return;
    for (; s->submitted < s->released + WINDOW && has_sentence(s, s->submitted); s->submitted++) {
        struct slot *slot = &s->slots[s->submitted % WINDOW];
        if (slot->taken)
            continue;
        *slot =
            (struct slot){.synthesis = s, .taken = true, .sentence = s->submitted, .rate = s->request.rate};
        const struct kept_sentence *kept = kept_speech_find(&s->kept, s->submitted);
        if (kept) {
            slot->audio = sentence_audio_share(kept->audio);
            slot->track = face_track_share(kept->track);
        } else if (!speculation_take(s, slot, synthesis_deliver)) {
            ask_voice(s, slot);
        }
    }
}

static void ring(struct synthesis *s, const struct slot *before) {
    s->rung = true;
    s->callbacks.segment(s->ctx, synthesis_bell(s, before));
}

static void play(struct synthesis *s, struct slot *slot) {
    if (s->request.bell && !s->rung)
        ring(s, slot);
    struct media_segment segment = synthesis_segment(s, slot);
    *slot = (struct slot){0};
    s->spoken++;
    if (s->freed)
        media_segment_free(&segment);
    else
        s->callbacks.segment(s->ctx, segment);
}

/* Tells whether the sentence exceeds the range of the utterance's clock. */
static bool is_beyond(const struct synthesis *s, const struct sentence_audio *u) {
    return u && u->samples > UINT32_MAX - s->samples;
}

static void warn_of_markup(struct synthesis *s) {
    while (s->warned < s->score->warning_count && !s->freed)
        s->callbacks.problem(s->ctx, &s->score->warnings[s->warned++], true);
}

/* Reports the faults of the request's own lexicon. Its lines are not those of the text, so that the place
 * stands in the message. */
static void warn_of_lexicon(struct synthesis *s) {
    size_t count = 0;
    const struct error *faults =
        s->request.lexicon && s->lexicons.count ? lexicon_warnings(s->lexicons.list[0], &count) : NULL;
    while (s->lexicon_warned < count && !s->freed) {
        const struct error *fault = &faults[s->lexicon_warned++];
        char text[sizeof fault->message + 64];
        struct error e;
        error_in_field(&e, fault->code, "lexicon", "%.240s", error_text(fault, text, sizeof text));
        s->callbacks.problem(s->ctx, &e, true);
    }
}

/* Reports an error in an open text. */
static void complain_of_writing(struct synthesis *s) {
    struct writing *w = s->writing;
    if (!w || w->told || s->freed || w->error.code == ERROR_NONE)
        return;
    w->told = true;
    struct error e = w->error;
    s->callbacks.problem(s->ctx, &e, false);
}

static bool is_finished(const struct synthesis *s) {
    return s->delivered == s->score->sentence_count && (!s->writing || s->writing->read);
}

static void drop_audio(struct slot *slot) {
    sentence_audio_free(slot->audio);
    face_track_free(slot->track);
    slot->audio = NULL;
    slot->track = NULL;
}

/* Delivers finished segments in order. */
static void synthesis_deliver(struct synthesis *s) {
    if (s->busy || !s->score || !s->started)
        return;
    s->busy = true;
    warn_of_lexicon(s);
    warn_of_markup(s);
    complain_of_writing(s);
    while (!s->freed && s->delivered < s->submitted) {
        struct slot *slot = &s->slots[s->delivered % WINDOW];
        if (slot->job)
            break;
        s->delivered++;
        if (slot->audio && !slot->track)
            synthesis_prepare(s, slot->audio);
        if (is_beyond(s, slot->audio)) {
            error_set(&slot->failure, ERROR_VOICE_FAILED, "the speech is longer than its clock can count");
            drop_audio(slot);
        }
        if (slot->audio) {
            play(s, slot);
        } else {
            struct error failure = slot->failure;
            *slot = (struct slot){0};
            s->released++;
            s->callbacks.problem(s->ctx, &failure, false);
        }
        free(s->entry);
        s->entry = NULL;
        if (!s->freed)
            synthesis_submit(s);
    }
    if (!s->freed && !s->finished && is_finished(s)) {
        s->finished = true;
        s->callbacks.finished(s->ctx, s->spoken);
    }
    s->busy = false;
    if (s->freed)
        synthesis_free(s);
}

void synthesis_start(struct synthesis *s) {
    s->started = true;
    synthesis_submit(s);
    if (s->writing)
        speculation_check(s);
}

static void refuse(struct synthesis *s) {
    s->busy = true;
    s->callbacks.problem(s->ctx, &s->result.error, false);
    if (!s->freed)
        s->callbacks.finished(s->ctx, 0);
    s->busy = false;
}

/* Continues after parsing, successful or not. */
static void synthesis_go_on(struct synthesis *s) {
    if (!s->freed && !s->score)
        refuse(s);
    if (s->freed)
        synthesis_free(s);
    else
        synthesis_submit(s);
}

void synthesis_keep(struct synthesis *s) {
    s->keeps = true;
}

/* Drops work in progress and finished sentences, except those in [first, last) that are still valid. */
static void forget_pending(struct synthesis *s, size_t first, size_t last) {
    for (size_t i = 0; i < WINDOW; i++) {
        struct slot *slot = &s->slots[i];
        if (slot->taken && slot->sentence >= first && slot->sentence < last && slot->rate == s->request.rate)
            continue;
        if (slot->job && !speculation_cancel(s, slot))
            sentence_cancel(slot->job);
        drop_audio(slot);
        *slot = (struct slot){0};
    }
}

/* The parse result of a long text, freed on another thread. */
struct rest {
    uv_work_t work;
    struct voice_selection *chosen;
    struct score *script, *document;
};

static void free_rest(uv_work_t *work) {
    struct rest *rest = work->data;
    voice_selection_free(rest->chosen);
    score_free(rest->script);
    score_free(rest->document);
}

static void after_rest(uv_work_t *work, int status) {
    if (status) /* the thread never ran */
        free_rest(work);
    free(work->data);
}

static void free_result(struct synthesis *s) {
    struct rest *rest = mem_alloc(sizeof *rest);
    *rest = (struct rest){.chosen = s->chosen, .script = s->result.score, .document = s->result.document};
    rest->work.data = rest;
    bool is_long = s->pipeline->long_text && s->request.text_size >= s->pipeline->long_text && s->score;
    if (is_long && !uv_queue_work(s->pipeline->loop, &rest->work, free_rest, after_rest))
        return;
    free_rest(&rest->work);
    free(rest);
}

void synthesis_free(struct synthesis *s) {
    if (!s)
        return;
    forget_pending(s, 0, 0);
    kept_speech_clear(&s->kept);
    voice_wait_end(s->wait);
    s->wait = NULL;
    s->freed = true;
    if (s->reading) {
        atomic_store(&s->given_up, true);
        uv_cancel((uv_req_t *)&s->work); /* if it is running, it stops soon */
    }
    if (s->busy || s->reading)
        return;
    free(s->entry);
    speculation_drop(s);
    writing_free(s);
    free_result(s);
    speaker_runs_free(&s->speakers);
    request_free(&s->request);
    lexicons_free(&s->lexicons);
    expressions_free(s->expressions);
    free(s);
}

void synthesis_release(struct synthesis *s) {
    s->released++;
    synthesis_submit(s);
    if (s->keeps)
        synthesis_deliver(s);
}

void synthesis_seek(struct synthesis *s, size_t sentence, const char *mark, uint32_t sample, size_t held) {
    char *entry = mark ? mem_strdup(mark) : NULL;
    forget_pending(s, sentence, sentence - held + WINDOW);
    free(s->entry);
    s->entry = entry;
    s->submitted = s->delivered = sentence;
    s->released = sentence - held;
    s->samples = sample;
    s->finished = false;
    synthesis_submit(s);
    synthesis_deliver(s);
}

void synthesis_set_rate(struct synthesis *s, double rate) {
    if (rate != s->request.rate)
        kept_speech_clear(&s->kept);
    s->request.rate = rate;
}

/* A likely sentence end followed by this much silence is one: people and programs pause there. A slow
 * language model takes about 50 ms between words. */
enum { SETTLE_MS = 200 };

/* The same for an almost certain end in a text written by a program, recognised by an average below
 * BRISK_MS between writes. */
enum { SURE_MS = 13, BRISK_MS = 80 };

static void on_timer(uv_timer_t *timer);

static uint64_t now_of(const struct synthesis *s) {
    return uv_now(s->pipeline->loop);
}

static void writing_open(struct synthesis *s) {
    struct writing *w = s->writing = mem_alloc(sizeof *w);
    w->open.kind = markup_by_name(s->request.markup ? s->request.markup : "auto");
    w->timer = mem_alloc(sizeof *w->timer);
    uv_timer_init(s->pipeline->loop, w->timer);
    w->timer->data = s;
    w->look = on_timer;
    w->last = now_of(s);
    w->settle = SETTLE_MS;
    w->text_cap = s->request.text ? s->request.text_size + 1 : 0;
    size_t bad = s->request.text ? utf8_feed(&w->utf8, s->request.text, s->request.text_size) : 0;
    if (bad < s->request.text_size)
        error_at_byte(&w->error, ERROR_BAD_UTF8, bad, "the text is not UTF-8");
    writing_wake(s, SETTLE_MS);
}

/* Without a score the voices are still starting and the language's rules are unknown, so nothing is
 * parsed. */
static bool surely_ended(const struct synthesis *s) {
    if (!s->score)
        return false;
    struct markup_rules rules = synthesis_rules(s);
    return open_text_surely_ended(&s->writing->open, s->request.text, s->request.text_size, &rules);
}

static void wrote(struct synthesis *s) {
    struct writing *w = s->writing;
    w->last = now_of(s);
    w->first = w->writes++ ? w->first : w->last;
    bool brisk = w->writes > 2 && w->last - w->first < BRISK_MS * (w->writes - 1);
    w->settle = brisk && surely_ended(s) ? SURE_MS : SETTLE_MS;
    writing_wake(s, w->settle);
}

int synthesis_write(struct synthesis *s, const char *text, size_t size, size_t most, struct error *e) {
    struct writing *w = s->writing;
    if (!w || w->closed || w->error.code != ERROR_NONE)
        return 0;
    size_t before = s->request.text_size;
    if (size > most || before > most - size)
        return error_in_field(e, ERROR_TEXT_TOO_LONG, "text", "a text may have at most %zu bytes", most);
    const char *nul = memchr(text, '\0', size);
    if (nul)
        return error_at_byte(e, ERROR_NUL, before + (size_t)(nul - text), "the text holds a NUL character");
    struct utf8_reader utf8 = w->utf8;
    size_t bad = utf8_feed(&utf8, text, size);
    if (bad < size)
        return error_at_byte(e, ERROR_BAD_UTF8, before + bad, "the text is not UTF-8");
    w->utf8 = utf8;
    s->request.text = mem_grow(s->request.text, &w->text_cap, before + size + 1, 1);
    memcpy(s->request.text + before, text, size);
    s->request.text_size = before + size;
    s->request.text[s->request.text_size] = '\0';
    wrote(s);
    synthesis_submit(s);
    speculation_check(s);
    return 0;
}

static void flush(struct synthesis *s) {
    struct writing *w = s->writing;
    size_t size = s->request.text_size;
    if (!size || (w->flush_count && w->flushes[w->flush_count - 1] == size))
        return;
    w->flushes = mem_grow(w->flushes, &w->flush_cap, w->flush_count + 1, sizeof *w->flushes);
    w->flushes[w->flush_count++] = size;
    synthesis_submit(s);
}

void synthesis_flush(struct synthesis *s) {
    if (!s->writing || s->writing->closed)
        return;
    s->writing->last = now_of(s);
    flush(s);
}

void synthesis_close(struct synthesis *s) {
    if (!s->writing || s->writing->closed)
        return;
    s->writing->closed = true;
    writing_wake(s, 0);
    synthesis_submit(s);
}

/* Closes a text that was idle for too long, so that others get their turn. */
static void give_up(struct synthesis *s) {
    struct error e;
    error_set(&e, ERROR_UNFINISHED, "nothing was written for %u s: the text is taken as it is",
              s->pipeline->open_seconds);
    s->busy = true;
    s->callbacks.problem(s->ctx, &e, true);
    s->busy = false;
    if (!s->freed)
        synthesis_close(s);
}

static void on_timer(uv_timer_t *timer) {
    struct synthesis *s = timer->data;
    struct writing *w = s->writing;
    uint64_t silent = now_of(s) - w->last, most = (uint64_t)s->pipeline->open_seconds * 1000;
    struct markup_rules rules;
    if (s->freed)
        return;
    if (!w->closed && most && silent >= most)
        give_up(s);
    if (s->freed) {
        synthesis_free(s);
        return;
    }
    if (!w->closed && silent >= w->settle && s->score && s->request.text) {
        rules = synthesis_rules(s);
        if (open_text_seems_ended(&w->open, s->request.text, s->request.text_size, &rules))
            flush(s);
    }
    if (!w->closed && (silent < w->settle || most))
        writing_wake(s, silent < w->settle ? w->settle - silent : most - silent);
    synthesis_deliver(s);
}

/* A synthesis as a source. */

static struct synthesis *of(struct speech_source *source) {
    return (struct synthesis *)source;
}

static const struct synthesis *of_const(const struct speech_source *source) {
    return (const struct synthesis *)source;
}

static void source_start(struct speech_source *source) {
    synthesis_start(of(source));
}

static void source_release(struct speech_source *source) {
    synthesis_release(of(source));
}

static void source_free(struct speech_source *source) {
    synthesis_free(of(source));
}

static double source_fps(const struct speech_source *source) {
    return source->request->fps;
}

static const char *source_id(const struct speech_source *source) {
    return source->request->id;
}

static void source_describe(const struct speech_source *source, struct source_description *description) {
    const struct synthesis *s = of_const(source);
    *description = (struct source_description){.voice = s->voice->id,
                                               .lang = synthesis_lang(s),
                                               .engine = synthesis_engine(s),
                                               .markup = synthesis_markup(s),
                                               .bell = s->request.bell};
}

static bool source_is_open(const struct speech_source *source) {
    const struct writing *w = of_const(source)->writing;
    return w && !w->closed;
}

static void source_close(struct speech_source *source) {
    synthesis_close(of(source));
}

static bool source_awaits(const struct speech_source *source) {
    const struct synthesis *s = of_const(source);
    return source_is_open(source) && s->score && s->delivered == s->score->sentence_count &&
           s->samples < UINT32_MAX / 2; /* later speech needs the clock, too */
}

static void source_wait(struct speech_source *source, unsigned ms) {
    struct synthesis *s = of(source);
    s->callbacks.segment(s->ctx, synthesis_wait(s, ms));
}

static const struct speech_source_ops source_ops = {.start = source_start,
                                                    .release = source_release,
                                                    .free = source_free,
                                                    .fps = source_fps,
                                                    .id = source_id,
                                                    .describe = source_describe,
                                                    .is_open = source_is_open,
                                                    .close = source_close,
                                                    .awaits = source_awaits,
                                                    .wait = source_wait};

struct speech_source *synthesis_open_source(const struct pipeline *pipeline, void *request,
                                            const struct synthesis_callbacks *callbacks, void *ctx,
                                            struct error *e) {
    struct synthesis *s = synthesis_open(pipeline, request, callbacks, ctx, e);
    return s ? &s->base : NULL;
}
