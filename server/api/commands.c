/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/api/commands.h"
#include "server/api/api_internal.h"
#include "server/api/client_internal.h"
#include "server/api/listener_words.h"
#include "server/base/mem.h"
#include "server/base/suggest.h"
#include "server/rooms/notices.h"
#include "server/rooms/question.h"
#include "server/rooms/repeat.h"
#include <stdlib.h>
#include <string.h>

static struct stream *stream_of(const struct command_call *call) {
    return channel_stream(call->channel);
}

/* {"type":TYPE,"room":ROOM}; on the client's own stream no answer is needed. */
static int answer(struct command_call *call, unsigned status, const char *type) {
    call->status = status;
    if (call->room)
        call->answer = json_pack("{ss ss}", "type", type, "room", call->room);
    return 0;
}

static int accepted(struct command_call *call) {
    answer(call, 202, "accepted");
    if (call->answer)
        json_object_set_new(call->answer, "listeners",
                            json_integer((json_int_t)channel_listeners(call->channel)));
    return 0;
}

/* A string member of the message, already checked. */
static const char *string_of(const struct command_call *call, const char *name) {
    return json_string_value(json_object_get(call->message, name));
}

static int speak(struct command_call *call, struct error *e) {
    if (!call->room || !call->keeps) {
        call->utterance = channel_speak(call->channel, call->request, NULL);
        return accepted(call);
    }
    call->answer = room_speak(call->api->rooms, call->room, call->request, &call->utterance, e);
    call->status = 202;
    return call->answer ? 0 : -1;
}

/* Says the text, and waits for an answer. */
static int ask(struct command_call *call, struct error *e) {
    struct error why;
    if (!call->request->text)
        return error_plain_in_field(e, ERROR_MISSING_FIELD, "text");
    if (question_check(call->message, e))
        return -1;
    call->utterance = channel_speak(call->channel, call->request, &why);
    call->asks = call->utterance && !json_is_false(json_object_get(call->message, "wait"));
    if (call->utterance)
        question_begin(call->channel, call->message, call->utterance);
    accepted(call);
    if (!call->utterance && call->answer)
        json_object_set_new(call->answer, "refused", error_json(&why));
    return 0;
}

static int play(struct command_call *call, struct error *e) {
    struct recording_source source = {0};
    if (media_source(call->api, &source, string_of(call, "name"), e)) {
        recording_source_free(&source);
        return -1;
    }
    source.id = call->request->id ? mem_strdup(call->request->id) : NULL;
    call->utterance = stream_play(stream_of(call), call->request, recording_open_source, &source);
    recording_source_free(&source);
    return accepted(call);
}

static int stop(struct command_call *call, struct error *e) {
    (void)e;
    stream_stop(stream_of(call));
    return answer(call, 200, "stopped");
}

static int pause_speech(struct command_call *call, struct error *e) {
    (void)e;
    stream_pause(stream_of(call));
    return answer(call, 200, "paused");
}

static int resume(struct command_call *call, struct error *e) {
    (void)e;
    stream_resume(stream_of(call));
    return answer(call, 200, "resumed");
}

static int rate(struct command_call *call, struct error *e) {
    (void)e;
    stream_rate(stream_of(call), json_number_value(json_object_get(call->message, "rate")));
    return accepted(call);
}

static int jump(struct command_call *call, struct error *e) {
    return stream_jump(stream_of(call), string_of(call, "mark"), e) ? -1 : accepted(call);
}

static int cancel(struct command_call *call, struct error *e) {
    const char *id = string_of(call, "id");
    if (!stream_cancel(stream_of(call), id))
        return error_in_field(e, ERROR_UNKNOWN_UTTERANCE, "id", "no utterance '%.64s' is playing or queued",
                              id);
    return accepted(call);
}

static int express(struct command_call *call, struct error *e) {
    return notice_express(call->channel, call->message, *call->by ? call->by : NULL, e) ? -1 : accepted(call);
}

static int offer_choices(struct command_call *call, struct error *e) {
    return notice_choices(call->channel, call->message, e) ? -1 : accepted(call);
}

static int choose(struct command_call *call, struct error *e) {
    return notice_choose(call->channel, call->message, call->by, e) ? -1 : accepted(call);
}

static int set_state(struct command_call *call, struct error *e) {
    return notice_state(call->channel, call->message, e) ? -1 : accepted(call);
}

static int calibrate(struct command_call *call, struct error *e) {
    return notice_calibrate(call->channel, call->message, e) ? -1 : accepted(call);
}

static int set_lexicon(struct command_call *call, struct error *e) {
    return notice_lexicon(call->channel, call->message, e) ? -1 : accepted(call);
}

static int show_head(struct command_call *call, struct error *e) {
    const char *name = string_of(call, "head");
    if (*name && !heads_find(&call->api->heads, name))
        return heads_unknown(&call->api->heads, name, "head", e);
    notice_head(call->channel, name);
    return accepted(call);
}

static int consent(struct command_call *call, struct error *e) {
    return notice_consent(call->channel, call->message, call->by, e) ? -1 : accepted(call);
}

static int set_backdrop(struct command_call *call, struct error *e) {
    return notice_backdrop(call->channel, call->message, e) ? -1 : accepted(call);
}

static int set_manner(struct command_call *call, struct error *e) {
    (void)e;
    channel_set_manner(call->channel, call->message);
    return accepted(call);
}

/* Words that the listener's own device has recognised, or that were typed. */
static int take_words(struct command_call *call, struct error *e) {
    const json_t *final = json_object_get(call->message, "final"),
                 *confidence = json_object_get(call->message, "confidence");
    (void)e;
    const struct listener_words words = {
        .id = string_of(call, "id"),
        .text = string_of(call, "text"),
        .lang = string_of(call, "lang"),
        .by = call->by,
        .final = !json_is_false(final),
        .confidence = confidence ? json_number_value(confidence) : -1,
    };
    listener_words_tell(call->channel, &words);
    listener_words_act(call->api, call->channel, &words);
    return accepted(call);
}

/* Listeners may answer without any right. Observers cannot, since nobody may consent for another. */
static int check_consent(const struct command_call *call, bool *exempt, struct error *e) {
    if (client_message_check("consent", call->message, e))
        return -1;
    *exempt = consent_is_answer(call->message);
    return *exempt && call->observes ? error_set(e, ERROR_FORBIDDEN, "only listeners can consent") : 0;
}

/* The rights are in protocol/messages.json. */
static const struct command commands[] = {
    {"speak", .speaks = true, .run = speak},
    {"play", .speaks = true, .run = play},
    {"ask", .speaks = true, .run = ask},
    {"stop", .run = stop, .bare = true},
    {"pause", .run = pause_speech, .bare = true},
    {"resume", .run = resume, .bare = true},
    {"rate", .run = rate},
    {"jump", .run = jump},
    {"cancel", .run = cancel},
    {"express", .run = express},
    {"choices", .run = offer_choices},
    {"choose", .run = choose},
    {"state", .run = set_state},
    {"calibrate", .run = calibrate},
    {"head", .run = show_head},
    {"lexicon", .run = set_lexicon},
    {"backdrop", .run = set_backdrop},
    {"manner", .run = set_manner},
    {"said", .run = take_words},
    {"consent", .check = check_consent, .run = consent},
    {"text", .act = open_text_add},
    {"flush", .act = open_text_flush},
    {"close", .act = open_text_close},
    {"voice", .act = client_voice_begin},
    {"drive", .act = client_drive},
    {"hear", .act = client_ear_begin},
    {"overhear", .act = client_overhear},
    {"idle", .act = client_idle},
    {"model", .act = client_send_model},
    {"media", .act = client_choose_media},
    {"join", .act = client_join},
    {"leave", .act = client_leave_room},
    {"authorize", .act = client_authorize},
    {"ping", .act = client_pong},
};

enum { COMMANDS = sizeof commands / sizeof *commands };

const struct command *command_find(const char *name) {
    for (size_t i = 0; i < COMMANDS; i++)
        if (!strcmp(commands[i].name, name))
            return &commands[i];
    return NULL;
}

const struct command *command_of(const json_t *message, struct error *e) {
    const char *type = json_string_value(json_object_get(message, "type"));
    if (!json_is_object(message) || !type) {
        error_in_field(e, ERROR_BAD_MESSAGE, "type", "a message must be an object with a string 'type'");
        return NULL;
    }
    const struct command *command = command_find(type);
    if (!command) {
        struct suggestions near = suggestions_for(type);
        char text[SUGGESTIONS_TEXT];
        for (size_t i = 0; i < COMMANDS; i++)
            suggest_name(&near, commands[i].name, commands[i].name);
        error_in_field(e, ERROR_UNKNOWN_TYPE, "type", "unknown message type '%.80s'%s", type,
                       suggestions_text(&near, text));
    }
    return command;
}

int command_request(const struct command *command, const json_t *message, struct speech_request *request,
                    struct error *e) {
    return command->run == speak ? request_from_json(request, message, e)
                                 : client_message_request(command->name, message, request, e);
}

int command_permit(const struct command *command, const struct command_call *call,
                   const struct principal *principal, struct error *e) {
    enum right right = client_message_right(command->name);
    bool exempt = !right;
    if (command->check && command->check(call, &exempt, e))
        return -1;
    return exempt ? 0 : principal_may(call->api, principal, right, call->room, e);
}

int command_admit(const struct command_call *call, const struct principal *principal, struct error *e) {
    struct speech_request *request = call->request;
    unsigned limit = call->api->options.text_bytes;
    if (call->api->draining)
        return error_set(e, ERROR_STOPPING, "the server is shutting down");
#ifdef HAVE_LIBRARY
    if (passage_resolve(call->api, request, e))
        return -1;
#else
    if (request->passage)
        return error_in_field(e, ERROR_UNKNOWN_PASSAGE, "passage",
                              "this daemon was built without the library");
#endif
    if (request->text_size > limit)
        return error_in_field(e, ERROR_TEXT_TOO_LONG, "text", "a text may have at most %u bytes", limit);
    request->quota_key = principal_quota_key(principal);
    request->connection = principal_connection(principal);
    return 0;
}

int command_run(const struct command *command, struct command_call *call, struct error *e) {
    bool anywhere = command->run == speak && call->keeps;
    if (!call->channel && !anywhere)
        return error_in_field(e, ERROR_UNKNOWN_ROOM, "room", "there is nobody in the room '%s'", call->room);
    if (call->message && client_message_check(command->name, call->message, e))
        return -1;
    return command->run(call, e);
}

json_t *command_pack(const struct command *command, const struct command_call *call, struct error *e) {
    json_t *packed = json_pack("{ss ss}", "type", command->name, "by", call->by);
    if (call->message)
        json_object_set(packed, "message", (json_t *)call->message);
    if (call->keeps)
        json_object_set_new(packed, "keeps", json_true());
    if (!call->request)
        return packed;
    json_t *request = request_to_json(call->request);
    if (!request) {
        error_plain(e, ERROR_BAD_UTF8);
        json_decref(packed);
        return NULL;
    }
    json_object_set_new(packed, "request", request);
    json_object_set_new(packed, "quota-key", json_integer(call->request->quota_key));
    json_object_set_new(packed, "connection", json_integer(call->request->connection));
    if (command->run == speak)
        json_object_del(packed, "message"); /* the request holds everything */
    return packed;
}

static int unpack_request(const struct api *api, const json_t *packed, struct speech_request *request,
                          struct error *e) {
    if (api->draining)
        return error_plain(e, ERROR_STOPPING);
    request->quota_key = (uint32_t)json_integer_value(json_object_get(packed, "quota-key"));
    request->connection = (uint32_t)json_integer_value(json_object_get(packed, "connection"));
    return request_from_json(request, json_object_get(packed, "request"), e);
}

json_t *commands_run_packed(void *ctx, const char *room, const json_t *packed, uint64_t remote,
                            uint64_t number, unsigned *status) {
    struct api *api = ctx;
    const char *by = json_string_value(json_object_get(packed, "by"));
    const char *type = json_string_value(json_object_get(packed, "type"));
    const struct command *command = type ? command_find(type) : NULL;
    struct speech_request request;
    struct error e;
    struct command_call call = {.api = api,
                                .room = room,
                                .channel = channel_occupied(api->rooms, room),
                                .message = json_object_get(packed, "message"),
                                .by = by ? by : "",
                                .keeps = json_is_true(json_object_get(packed, "keeps"))};
    request_init(&request);
    int failed = command && command->run ? 0 : error_plain(&e, ERROR_UNKNOWN_TYPE);
    if (!failed && command->speaks) {
        call.request = &request;
        failed = unpack_request(api, packed, &request, &e);
        request.origin = remote;
        request.command = number;
    }
    failed = failed || command_run(command, &call, &e);
    if (!failed && call.request && !call.utterance && call.channel && !call.keeps)
        call.utterance =
            stream_number(channel_stream(call.channel)); /* even if refused: the utterance's end carries it */
    request_free(&request);
    *status = failed ? error_status(e.code) : call.status;
    if (failed)
        return error_json(&e);
    if (call.utterance)
        json_object_set_new(call.answer, "utterance", json_integer(call.utterance));
    return call.answer;
}
