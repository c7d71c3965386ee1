/* SPDX-License-Identifier: GPL-3.0-or-later */
/* POST /v1/audio/speech: OpenAI's speech API, so that its clients can use this daemon. Translates requests,
 * errors and events; the formats, voices and affects are the daemon's own. GET /v1/audio/voices and
 * /v1/audio/models are not OpenAI's: clients ask them of every other server, to offer a choice. */
#include "server/api/api_internal.h"
#include "server/api/commands.h"
#include "server/base/json/surrogates.h"
#include "server/base/mem.h"
#include "server/base/utf8.h"
#include <ctype.h>
#include <openssl/evp.h>
#include <stdlib.h>
#include <string.h>

/* OpenAI's voice names. Each selects a voice of the request's language by gender. */
static const struct {
    const char *name;
    enum voice_gender gender;
} usual_voices[] = {
    {"alloy", GENDER_ANY},    {"ash", GENDER_MALE},  {"ballad", GENDER_MALE}, {"cedar", GENDER_MALE},
    {"coral", GENDER_FEMALE}, {"echo", GENDER_MALE}, {"fable", GENDER_MALE},  {"marin", GENDER_FEMALE},
    {"nova", GENDER_FEMALE},  {"onyx", GENDER_MALE}, {"sage", GENDER_FEMALE}, {"shimmer", GENDER_FEMALE},
    {"verse", GENDER_MALE},
};

/* Names of OpenAI's models of speech. A request may have any name. */
static const char *const usual_models[] = {"tts-1", "tts-1-hd", "gpt-4o-mini-tts"};

json_t *openai_voices(const struct api *api) {
    json_t *list = json_array(), *own = message_voices(api), *voice;
    size_t i;
    for (i = 0; i < sizeof usual_voices / sizeof *usual_voices; i++)
        json_array_append_new(list,
                              json_pack("{ss ss}", "id", usual_voices[i].name, "name", usual_voices[i].name));
    json_array_foreach(own, i, voice) {
        const char *id, *name, *lang;
        json_unpack(voice, "{ss ss ss}", "id", &id, "name", &name, "lang", &lang);
        json_array_append_new(list, json_pack("{ss so ss}", "id", id, "name",
                                              json_sprintf("%s (%s)", name, lang), "lang", lang));
    }
    json_decref(own);
    return json_pack("{so}", "voices", list);
}

json_t *openai_models(void) {
    json_t *list = json_array();
    for (size_t i = 0; i < sizeof usual_models / sizeof *usual_models; i++)
        json_array_append_new(list,
                              json_pack("{ss ss ss si ss}", "id", usual_models[i], "name", usual_models[i],
                                        "object", "model", "created", 0, "owned_by", "faccia"));
    return list;
}

/* Answers with the daemon's own error, extended by {"error":{"message","type","param","code"}}. */
static int refuse(struct exchange *x, const struct error *e) {
    unsigned status = error_status(e->code);
    bool in_field = e->place == PLACE_FIELD;
    struct error named = *e;
    char text[1024];
    if (in_field && !strcmp(e->field, "text"))
        snprintf(named.field, sizeof named.field, "input");
    error_text(&named, text, sizeof text);
    utf8_mend(text); /* a quotation in it may be cut within a character */
    utf8_mend(named.field);
    json_t *error = json_pack("{ss ss so ss}", "message", text, "type",
                              status < 500 ? "invalid_request_error" : "server_error", "param",
                              in_field ? json_string(named.field) : json_null(), "code", error_name(e->code));
    json_t *answer = error_json(e);
    json_object_set_new(answer, "error", error);
    return exchange_json(x, status, answer);
}

static void send_event(struct exchange *x, const struct buf *bytes) {
    static const char head[] = "data: {\"type\":\"speech.audio.delta\",\"audio\":\"", tail[] = "\"}\n\n";
    static const char end[] = "data: {\"type\":\"speech.audio.done\",\"usage\":{\"input_tokens\":0,"
                              "\"output_tokens\":0,\"total_tokens\":0}}\n\n";
    if (!bytes) {
        exchange_add(x, end, strlen(end));
        return;
    }
    struct buf event = {0};
    size_t room = (bytes->size + 2) / 3 * 4;
    buf_add(&event, head, strlen(head));
    EVP_EncodeBlock(buf_reserve(&event, room + 1), bytes->data, (int)bytes->size);
    event.size += room;
    buf_add(&event, tail, strlen(tail));
    exchange_add(x, event.data, event.size);
    buf_free(&event);
}

/* Sets *value to a string member, or NULL if it is absent or null. */
static int string_member(const json_t *body, const char *name, const char **value, struct error *e) {
    const json_t *member = json_object_get(body, name);
    *value = json_string_value(member);
    if (!member || json_is_null(member) || *value)
        return 0;
    return error_in_field(e, ERROR_BAD_FIELD, name, "must be a string");
}

/* A name, or {"id": NAME}. */
static int read_voice(const json_t *body, struct speech_request *request, struct error *e) {
    const json_t *member = json_object_get(body, "voice");
    const char *name = json_string_value(json_is_object(member) ? json_object_get(member, "id") : member);
    if (!member || json_is_null(member))
        return 0;
    if (!name)
        return error_in_field(e, ERROR_BAD_FIELD, "voice", "must be the name of a voice");
    for (size_t i = 0; i < sizeof usual_voices / sizeof *usual_voices; i++)
        if (!strcmp(usual_voices[i].name, name)) {
            request->gender = usual_voices[i].gender;
            return 0;
        }
    return request_set(request, "voice", (struct request_value){REQUEST_STRING, name, strlen(name), 0}, e);
}

/* Returns a copy of the first word of the instructions that names an affect, or NULL. Skips a word that
 * follows "not", "no" or "without". */
static char *find_affect(const struct expressions *expressions, const char *text) {
    static const char letters[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ-";
    bool denied = false;
    for (text += strcspn(text, letters); *text; text += strcspn(text, letters)) {
        size_t length = strspn(text, letters);
        char *word = mem_strndup(text, length);
        for (char *c = word; *c; c++)
            *c = (char)tolower((unsigned char)*c);
        if (!denied && expressions_find(expressions, "affect", word) >= 0)
            return word;
        denied = !strcmp(word, "not") || !strcmp(word, "no") || !strcmp(word, "without");
        free(word);
        text += length;
    }
    return NULL;
}

static const struct export_format *find_format(const char *name, struct error *e) {
    const struct export_format *format = !name                   ? export_by_name("mp3")
                                         : !strcmp(name, "opus") ? export_by_name("ogg")
                                                                 : export_by_name(name);
    if (!format)
        error_in_field(
            e, ERROR_UNKNOWN_FORMAT, "response_format",
            "no format '%.40s': use mp3, opus, aac, flac, wav or pcm, or json for the times of words and "
            "visemes",
            name);
    return format;
}

static int read_speed(const json_t *body, struct speech_request *request, struct error *e) {
    const json_t *member = json_object_get(body, "speed");
    double speed = json_number_value(member);
    if (!member || json_is_null(member))
        return 0;
    if (!json_is_number(member) || !(speed >= 0.25 && speed <= 4))
        return error_in_field(e, ERROR_BAD_FIELD, "speed", "must be a number from 0.25 to 4");
    request->speed = speed;
    return 0;
}

static int read_stream(const json_t *body, struct speech_answer *answer, struct error *e) {
    const char *stream;
    if (string_member(body, "stream_format", &stream, e))
        return -1;
    if (stream && strcmp(stream, "audio") && strcmp(stream, "sse"))
        return error_in_field(e, ERROR_BAD_FIELD, "stream_format", "must be audio or sse");
    answer->event = stream && !strcmp(stream, "sse") ? send_event : NULL;
    return 0;
}

static int read_body(struct speech_answer *answer, const json_t *body, struct speech_request *request,
                     struct error *e) {
    const struct expressions *expressions = exchange_api(answer->x)->pipeline->expressions;
    const char *format, *instructions, *lang;
    const json_t *input = json_object_get(body, "input");
    if (!json_is_object(body))
        return error_set(e, ERROR_BAD_MESSAGE, "the body must be an object with a string 'input'");
    if (!json_is_string(input))
        return error_plain_in_field(e, input ? ERROR_BAD_FIELD : ERROR_MISSING_FIELD, "input");
    if (request_set(request, "text", value_from_json(input), e) || read_voice(body, request, e) ||
        string_member(body, "response_format", &format, e) ||
        string_member(body, "instructions", &instructions, e) || string_member(body, "lang", &lang, e) ||
        read_speed(body, request, e) || read_stream(body, answer, e))
        return -1;
    if (lang && request_set(request, "lang", value_from_json(json_object_get(body, "lang")), e))
        return -1;
    request->markup = mem_strdup("plain");
    if (instructions && expressions)
        request->affect = find_affect(expressions, instructions);
    answer->format = find_format(format, e);
    return answer->format ? 0 : -1;
}

static int on_body_end(void *self) {
    struct speech_answer *answer = self;
    struct exchange *x = answer->x;
    const struct buf *text = exchange_body(x);
    struct speech_request request;
    struct command_call call = {.api = exchange_api(x), .request = &request};
    struct error e;
    json_error_t why;
    json_t *body = surrogates_load(text->size ? (const char *)text->data : "", text->size, &why);
    int failed = body ? 0 : error_bad_json(&why, &e);
    request_init(&request);
    if (!failed)
        failed = read_body(answer, body, &request, &e) || command_admit(&call, exchange_principal(x), &e) ||
                 speech_answer_open(answer, &request, &e);
    request_free(&request);
    json_decref(body);
    exchange_drop_body(x);
    return failed ? refuse(x, &e) : 0;
}

static void on_free(void *self) {
    struct speech_answer *answer = self;
    speech_export_free(answer->speech);
    free(answer);
}

int openai_speech(struct exchange *x) {
    struct speech_answer *answer = mem_alloc(sizeof *answer);
    *answer = (struct speech_answer){.x = x, .refuse = refuse};
    exchange_set_work(
        x, (struct exchange_work){
               .body_end = on_body_end, .sent = speech_answer_sent, .free = on_free, .self = answer});
    exchange_expect_body(x, exchange_api(x)->options.http.message_bytes, ERROR_MESSAGE_TOO_LONG);
    return 0;
}
