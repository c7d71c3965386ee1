/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/bridges/satellite/satellite.h"
#include "server/base/buf.h"
#include "server/base/log.h"
#include "server/base/mem.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum {
    PEERS = 20,
    RATE = 16000, /* of the microphone's sound; 16 bit, mono */
    BYTES_PER_MS = RATE / 1000 * 2,
    SOUND_MOST = 8 << 20,          /* bytes of an utterance that waits for its wake word */
    ENOUGH = 700 * BYTES_PER_MS,   /* more than this after a wake word is a request */
    SILENCE = 1000 * BYTES_PER_MS, /* for the wake service to hear the last word out */
    AWAKE_MS = 10000,              /* after a wake word alone */
    ANSWER_MS = 60000,             /* for the assistant to answer */
    REFUSED_MS = 1000,
    TROUBLE_MS = 8000, /* an error is shown */
    CHANNELS_MOST = 8,
};

/* A connection: the assistant's, or that of a recogniser with an utterance. */
struct peer {
    struct satellite *satellite;
    struct wyoming_link *link;
    struct wyoming_link *service; /* connection to the wake service, or to others' recogniser; NULL: none */
    struct peer *next, **self;
    enum {
        STRANGER,
        ASSISTANT,
        WAKING,    /* an utterance whose wake word is awaited */
        HELD,      /* the wake word was said; the rest of the utterance decides */
        STREAMING, /* its sound goes to the pipeline */
        HEARD,     /* the pipeline has heard enough */
        ANSWERED,
        RELAYED, /* an utterance of another room */
    } state;
    struct buf sound; /* not given to the pipeline yet */
    uint64_t at;      /* bytes given to the pipeline, or to the wake service */
    bool complete;    /* the utterance has ended */
};

static void show_rest(struct satellite *s) {
    char text[1000];
    timers_text(&s->timers, text, sizeof text);
    uv_timer_stop(&s->rest);
    room_state(s->room, s->paused ? "muted" : "idle", text);
}

/* Shows it unless an utterance is being received. */
static void show_rest_if_quiet(struct satellite *s) {
    const struct peer *p = s->peers;
    while (p && (p->state < WAKING || p->state > HEARD))
        p = p->next;
    if (!p)
        show_rest(s);
}

static void on_rest(uv_timer_t *timer) {
    show_rest(timer->data);
}

/* Shows a state for a while. */
static void show(struct satellite *s, const char *state, const char *text, unsigned ms) {
    room_state(s->room, state, text);
    uv_timer_start(&s->rest, on_rest, ms, 0);
}

static void tell_assistant(struct satellite *s, const char *type, json_t *data) {
    if (s->assistant)
        wyoming_link_tell(s->assistant->link, type, data, NULL, 0);
    else
        json_decref(data);
}

static json_t *format_at(uint64_t bytes) {
    return json_pack("{si si si sI}", "rate", RATE, "width", 2, "channels", 1, "timestamp",
                     (json_int_t)(bytes / BYTES_PER_MS));
}

/* ---- utterances ---- */

static void drop_service(struct peer *p) {
    if (p->service)
        wyoming_link_close(p->service);
    p->service = NULL;
}

/* The recogniser's utterance is over: with its words, or (text NULL) an error. */
static void answer(struct peer *p, const char *text, const char *why) {
    if (p->satellite->current == p)
        p->satellite->current = NULL;
    drop_service(p);
    p->sound.size = 0;
    p->state = ANSWERED;
    if (text)
        wyoming_link_tell(p->link, "transcript", json_pack("{ss}", "text", text), NULL, 0);
    else
        wyoming_link_tell(p->link, "error", json_pack("{ss ss}", "text", why, "code", "satellite"), NULL, 0);
}

static void forward(struct peer *p) {
    const size_t size = p->sound.size & ~(size_t)1;
    if (size && p->satellite->assistant)
        wyoming_link_tell(p->satellite->assistant->link, "audio-chunk", format_at(p->at), p->sound.data,
                          size);
    p->at += size;
    buf_consume(&p->sound, size);
}

static void end_stream(struct peer *p) {
    tell_assistant(p->satellite, "audio-stop",
                   json_pack("{sI}", "timestamp", (json_int_t)(p->at / BYTES_PER_MS)));
}

/* Has the assistant recognise the utterance, and answer it unless it answers a question of the room. */
static void run_pipeline(struct peer *p) {
    struct satellite *s = p->satellite;
    if (s->current)
        answer(s->current, "", NULL);
    s->current = p;
    s->whole = s->talks || !room_asks(s->room);
    s->talks = false;
    uv_timer_stop(&s->awake);
    uv_timer_stop(&s->rest);
    p->state = STREAMING;
    p->at = 0;
    tell_assistant(s, "run-pipeline",
                   json_pack("{ss ss sb}", "start_stage", "asr", "end_stage", s->whole ? "tts" : "asr",
                             "restart_on_end", 0));
    forward(p);
    if (p->complete)
        end_stream(p);
}

static void on_awake(uv_timer_t *timer) {
    show_rest(timer->data);
}

/* The wake word was said: what follows in this utterance or the next one is a request. */
static void wake_up(struct peer *p) {
    struct satellite *s = p->satellite;
    p->state = HELD;
    if (p->sound.size >= ENOUGH) {
        run_pipeline(p);
    } else if (p->complete) {
        answer(p, "", NULL);
        uv_timer_start(&s->awake, on_awake, AWAKE_MS, 0);
        room_state(s->room, "listening", NULL);
    }
}

static void on_wake_event(void *ctx, const struct wyoming_event *event) {
    struct peer *p = ctx;
    const json_t *at = json_object_get(event->data, "timestamp"),
                 *name = json_object_get(event->data, "name");
    if (!strcmp(event->type, "detection")) {
        const double spoken =
            json_is_number(at) ? json_number_value(at) * BYTES_PER_MS : (double)p->sound.size;
        const size_t size = spoken > 0 && spoken < (double)p->sound.size ? (size_t)spoken : p->sound.size;
        buf_consume(&p->sound, size & ~(size_t)1);
        drop_service(p);
        tell_assistant(p->satellite, "detection", json_pack("{sO*}", "name", name));
        wake_up(p);
    } else if (!strcmp(event->type, "not-detected")) {
        answer(p, "", NULL);
    }
}

static void on_wake_ended(void *ctx, const char *why) {
    struct peer *p = ctx;
    char text[300];
    p->service = NULL;
    snprintf(text, sizeof text, "the wake service %.200s: %s", p->satellite->wake, why);
    log_warn("%s", text);
    answer(p, NULL, text);
}

static void ask_wake(struct peer *p) {
    static const struct wyoming_link_calls calls = {on_wake_event, on_wake_ended};
    const struct satellite *s = p->satellite;
    p->state = WAKING;
    p->service = wyoming_link_connect(s->loop, s->wake, &calls, p);
    wyoming_link_tell(p->service, "detect",
                      s->wake_word ? json_pack("{s[s]}", "names", s->wake_word) : json_pack("{sn}", "names"),
                      NULL, 0);
    wyoming_link_tell(p->service, "audio-start", format_at(0), NULL, 0);
}

static void on_relay_event(void *ctx, const struct wyoming_event *event) {
    const struct peer *p = ctx;
    wyoming_link_tell(p->link, event->type, json_incref(event->data), event->payload.data,
                      event->payload.size);
}

static void on_relay_ended(void *ctx, const char *why) {
    struct peer *p = ctx;
    char text[300];
    p->service = NULL;
    snprintf(text, sizeof text, "the recogniser %.200s of other rooms: %s", p->satellite->others, why);
    answer(p, NULL, text);
}

/* Has an utterance of another room recognised elsewhere, perhaps by that room's satellite. */
static void relay(struct peer *p) {
    static const struct wyoming_link_calls calls = {on_relay_event, on_relay_ended};
    drop_service(p);
    p->state = RELAYED;
    p->service = wyoming_link_connect(p->satellite->loop, p->satellite->others, &calls, p);
}

static void begin_utterance(struct peer *p, const json_t *data) {
    struct satellite *s = p->satellite;
    const char *room = json_string_value(json_object_get(json_object_get(data, "context"), "room"));
    char why[256];
    p->sound.size = 0;
    p->at = 0;
    p->complete = false;
    if (room && strcmp(room, s->room_name) != 0 && s->others) {
        relay(p);
    } else if (room && strcmp(room, s->room_name) != 0) {
        snprintf(why, sizeof why, "this satellite serves the room %.100s", s->room_name);
        answer(p, NULL, why);
    } else if (!s->assistant || s->paused) {
        answer(p, NULL,
               s->paused ? "the assistant has switched this satellite off" : "no assistant is connected");
        uv_timer_start(&s->rest, on_rest, REFUSED_MS, 0); /* the daemon shows the end of its listening */
    } else if (s->wake && !s->talks && !uv_is_active((uv_handle_t *)&s->awake) && !room_asks(s->room)) {
        ask_wake(p);
    } else {
        run_pipeline(p);
    }
}

static void hear(struct peer *p, const struct wyoming_event *event) {
    const struct buf *payload = &event->payload;
    if (json_integer_value(json_object_get(event->data, "rate")) != RATE ||
        json_integer_value(json_object_get(event->data, "channels")) != 1) {
        answer(p, NULL, "the sound must be 16-bit mono samples at 16000 Hz");
        return;
    }
    if (p->state == WAKING) {
        wyoming_link_tell(p->service, "audio-chunk", format_at(p->at), payload->data, payload->size);
        p->at += payload->size;
    }
    if (p->sound.size + payload->size > SOUND_MOST) {
        answer(p, NULL, "the utterance is too long");
        return;
    }
    buf_add(&p->sound, payload->data, payload->size);
    if (p->state == HELD && p->sound.size >= ENOUGH)
        run_pipeline(p);
    else if (p->state == STREAMING)
        forward(p);
}

static void end_utterance(struct peer *p) {
    p->complete = true;
    if (p->state == WAKING) {
        uint8_t *silence = mem_alloc(SILENCE);
        memset(silence, 0, SILENCE);
        wyoming_link_tell(p->service, "audio-chunk", format_at(p->at), silence, SILENCE);
        wyoming_link_tell(p->service, "audio-stop", NULL, NULL, 0);
        free(silence);
    } else if (p->state == HELD) {
        wake_up(p);
    } else if (p->state == STREAMING) {
        end_stream(p);
    }
}

/* Returns true if the event belongs to an utterance. */
static bool take_utterance(struct peer *p, const struct wyoming_event *event) {
    if (!strcmp(event->type, "transcribe") && p->state != ASSISTANT) {
        begin_utterance(p, event->data);
        if (p->state != RELAYED)
            return true;
    }
    if (p->state == RELAYED) {
        wyoming_link_tell(p->service, event->type, json_incref(event->data), event->payload.data,
                          event->payload.size);
        return true;
    }
    if (p->state == STRANGER || p->state == ASSISTANT)
        return false;
    if (p->state != HEARD && p->state != ANSWERED && !p->complete) {
        if (!strcmp(event->type, "audio-chunk"))
            hear(p, event);
        else if (!strcmp(event->type, "audio-stop"))
            end_utterance(p);
    }
    return true;
}

/* ---- the assistant ---- */

static const char *member(const json_t *data, const char *name) {
    const char *text = json_string_value(json_object_get(data, name));
    return text ? text : "";
}

static json_t *info(const struct satellite *s) {
    json_t *satellite =
        json_pack("{ss ss ss sb s{ss ss} ss* sb sb}", "name", s->name, "description",
                  "A face that listens and speaks", "version", FACCIA_VERSION, "installed", 1, "attribution",
                  "name", "faccia", "url", "", "area", s->area, "has_vad", 1, "supports_trigger", 0);
    if (s->wake)
        json_object_set_new(satellite, "max_active_wake_words", json_integer(1));
    if (s->wake_word)
        json_object_set_new(satellite, "active_wake_words", json_pack("[s]", s->wake_word));
    return json_pack("{s[] s[] s[] s[] s[] s[] s[] so}", "asr", "tts", "handle", "intent", "wake", "mic",
                     "snd", "satellite", satellite);
}

/* Tells the assistant that its answer has been heard to the end. */
static void check_played(struct satellite *s) {
    if (!s->owes_played || !s->sound_over || !s->room_over)
        return;
    s->owes_played = false;
    tell_assistant(s, "played", NULL);
    show_rest_if_quiet(s);
}

static void on_said(void *ctx) {
    struct satellite *s = ctx;
    s->room_over = true;
    check_played(s);
}

/* Everything that the assistant was about to do is off. */
static void forget(struct satellite *s, const char *why) {
    if (s->current)
        answer(s->current, NULL, why);
    for (struct peer *p = s->peers; p; p = p->next)
        if (p->state == WAKING || p->state == HELD)
            answer(p, NULL, why);
    if (s->sounds && !s->face_speaks)
        room_sound_end(s->room);
    s->owes_played = s->sounds = s->face_speaks = s->talks = false;
    uv_timer_stop(&s->awake);
}

/* Begins something that the room says. sound: the assistant's sound comes, too. */
static void begin_answer(struct satellite *s, bool sound) {
    s->owes_played = true;
    s->room_over = false;
    s->sound_over = !sound;
    uv_timer_stop(&s->rest);
}

static void say(struct satellite *s, const char *text, const char *lang) {
    s->owes_played = false; /* of what is cut off by this */
    room_say(s->room, text, lang, false);
    s->room_over = !room_speaks(s->room);
}

static void on_synthesize(struct satellite *s, const json_t *data) {
    const char *text = member(data, "text");
    const char *lang = json_string_value(json_object_get(json_object_get(data, "voice"), "language"));
    if (s->speech != SATELLITE_FACE || s->sounds || !bridge_has_words(text))
        return;
    s->face_speaks = true;
    say(s, text, lang);
    const bool over = s->room_over;
    begin_answer(s, true);
    s->room_over = over;
}

static void on_audio_start(struct satellite *s, const json_t *data) {
    const json_int_t rate = json_integer_value(json_object_get(data, "rate")),
                     width = json_integer_value(json_object_get(data, "width")),
                     channels = json_integer_value(json_object_get(data, "channels"));
    if (s->sounds)
        return;
    s->sounds = true;
    if (s->face_speaks)
        return;
    s->owes_played = false;
    if (width != 2 || channels < 1 || channels > CHANNELS_MOST || rate < 8000 || rate > 96000)
        log_warn("the assistant's sound has %lld Hz, %lld bytes, %lld channels: it is not played",
                 (long long)rate, (long long)width, (long long)channels);
    else
        room_sound_begin(s->room, (unsigned)rate, (unsigned)channels);
    const bool over = !room_speaks(s->room);
    begin_answer(s, true);
    s->room_over = over;
}

static void on_audio_stop(struct satellite *s) {
    if (!s->sounds)
        return;
    if (!s->face_speaks)
        room_sound_end(s->room);
    s->sounds = s->face_speaks = false;
    s->sound_over = true;
    check_played(s);
}

/* Errors that the room does not show: no words were found, or another satellite answers. */
static bool is_quiet(const char *code) {
    return !strcmp(code, "stt-no-text-recognized") || !strcmp(code, "duplicate_wake_up_detected");
}

static void on_error(struct satellite *s, const json_t *data) {
    const char *code = member(data, "code"), *text = member(data, "text");
    log_warn("the assistant: %s (%s)", text, code);
    if (s->current)
        answer(s->current, is_quiet(code) ? "" : NULL, text);
    if (!s->sounds)
        s->owes_played = s->face_speaks = false;
    if (is_quiet(code))
        show_rest(s);
    else
        show(s, "error", text, TROUBLE_MS);
}

static void on_transcript(struct satellite *s, const json_t *data) {
    const char *text = member(data, "text");
    if (s->current)
        answer(s->current, text, NULL);
    else
        log_warn("the assistant recognised an utterance that is over");
    if (s->whole)
        show(s, "thinking", text, ANSWER_MS);
}

/* The assistant begins: an announcement, or a conversation. */
static void on_run_pipeline(struct satellite *s, const json_t *data) {
    const char *stage = member(data, "start_stage"), *text = member(data, "announce_text");
    const bool listens = !strcmp(stage, "asr");
    if (!listens && strcmp(stage, "tts") != 0)
        return;
    s->talks |= listens;
    s->owes_played = false;
    if (listens && *text)
        room_ask(s->room, text);
    else if (*text)
        room_say(s->room, text, NULL, false);
    else
        show(s, "listening", NULL, AWAKE_MS);
    if (!*text)
        return;
    const bool over = !room_speaks(s->room);
    begin_answer(s, false);
    s->room_over = over;
    check_played(s);
}

static void on_timer_event(struct satellite *s, const struct wyoming_event *event) {
    char *text = timers_take(&s->timers, event->type, event->data, s->lang, (int64_t)time(NULL));
    if (text)
        room_say(s->room, text, s->lang ? s->lang : "en", true);
    free(text);
    if (!uv_is_active((uv_handle_t *)&s->rest) && !uv_is_active((uv_handle_t *)&s->awake))
        show_rest_if_quiet(s);
}

static void take_assistant(struct satellite *s, const struct wyoming_event *event) {
    const char *type = event->type;
    if (!strcmp(type, "pause-satellite")) {
        s->paused = true;
        forget(s, "the assistant has switched this satellite off");
        show_rest(s);
    } else if (!strcmp(type, "voice-stopped")) {
        if (s->current)
            s->current->state = HEARD;
        if (s->whole)
            show(s, "thinking", NULL, ANSWER_MS);
    } else if (!strcmp(type, "transcript")) {
        on_transcript(s, event->data);
    } else if (!strcmp(type, "synthesize")) {
        on_synthesize(s, event->data);
    } else if (!strcmp(type, "audio-start")) {
        on_audio_start(s, event->data);
    } else if (!strcmp(type, "audio-chunk")) {
        if (s->sounds && !s->face_speaks)
            room_sound(s->room, event->payload.data, event->payload.size);
    } else if (!strcmp(type, "audio-stop")) {
        on_audio_stop(s);
    } else if (!strcmp(type, "error")) {
        on_error(s, event->data);
    } else if (!strcmp(type, "run-pipeline")) {
        on_run_pipeline(s, event->data);
    } else if (!strncmp(type, "timer-", strlen("timer-"))) {
        on_timer_event(s, event);
    }
}

/* ---- connections ---- */

static void free_peer(struct peer *p) {
    *p->self = p->next;
    if (p->next)
        p->next->self = p->self;
    p->satellite->peer_count--;
    drop_service(p);
    buf_free(&p->sound);
    free(p);
}

/* An assistant that has restarted may not have closed its former connection. */
static void become_assistant(struct peer *p) {
    struct satellite *s = p->satellite;
    struct peer *former = s->assistant;
    s->paused = false;
    if (former != p) {
        forget(s, "another assistant has connected");
        s->assistant = p;
        p->state = ASSISTANT;
        log_info("an assistant is connected");
    }
    if (former && former != p) {
        wyoming_link_close(former->link);
        free_peer(former);
    }
    show_rest(s);
}

static void on_peer_event(void *ctx, const struct wyoming_event *event) {
    struct peer *p = ctx;
    struct satellite *s = p->satellite;
    if (!strcmp(event->type, "describe"))
        wyoming_link_tell(p->link, "info", info(s), NULL, 0);
    else if (!strcmp(event->type, "ping"))
        wyoming_link_tell(p->link, "pong", json_incref(event->data), NULL, 0);
    else if (!strcmp(event->type, "run-satellite") && (p->state == STRANGER || p->state == ASSISTANT))
        become_assistant(p);
    else if (!take_utterance(p, event) && p == s->assistant)
        take_assistant(s, event);
}

static void on_peer_ended(void *ctx, const char *why) {
    struct peer *p = ctx;
    struct satellite *s = p->satellite;
    if (p == s->assistant) {
        log_warn("the assistant is gone: %s", why);
        s->assistant = NULL;
        s->paused = false;
        forget(s, "the assistant has gone");
        show_rest(s);
    } else if (p == s->current) { /* the recogniser was stopped */
        if (p->state == STREAMING && !p->complete)
            end_stream(p);
        s->current = NULL;
    }
    free_peer(p);
}

void satellite_accept(struct satellite *s, uv_stream_t *listener) {
    static const struct wyoming_link_calls calls = {on_peer_event, on_peer_ended};
    struct peer *p = mem_alloc(sizeof *p);
    *p = (struct peer){.satellite = s, .next = s->peers, .self = &s->peers};
    if (p->next)
        p->next->self = &p->next;
    s->peers = p;
    s->peer_count++;
    p->link = wyoming_link_accept(listener, &calls, p);
    if (p->link && s->peer_count <= PEERS)
        return;
    wyoming_link_close(p->link);
    free_peer(p);
}

static void on_room_connected(void *ctx) {
    show_rest(ctx);
}

const struct room_calls satellite_room_calls = {on_said, on_room_connected};

void satellite_open(struct satellite *s, uv_loop_t *loop) {
    s->loop = loop;
    uv_timer_init(loop, &s->rest);
    uv_timer_init(loop, &s->awake);
    s->rest.data = s->awake.data = s;
}

void satellite_close(struct satellite *s) {
    while (s->peers) {
        struct peer *p = s->peers;
        wyoming_link_close(p->link);
        free_peer(p);
    }
    s->assistant = s->current = NULL;
    uv_close((uv_handle_t *)&s->rest, NULL);
    uv_close((uv_handle_t *)&s->awake, NULL);
}

void satellite_free(struct satellite *s) {
    timers_free(&s->timers);
}
