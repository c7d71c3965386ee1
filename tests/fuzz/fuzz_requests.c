/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Requests of clients. Byte 0 selects: a message, the parameters of a query (NAME=VALUE, one per line), or
 * one of the daemon's messages for the text protocol. */
#include "server/api/api_internal.h"
#include "server/base/mem.h"
#include "server/base/utf8.h"
#include "server/rooms/notices.h"
#include "server/synthesis/speech_request.h"
#include "tests/fuzz/fuzz.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

static void check_request(const struct speech_request *r) {
    FUZZ_CHECK(r->rate == 0 || (r->rate >= 40 && r->rate <= 500));
    FUZZ_CHECK(r->pitch >= 0.25 && r->pitch <= 4 && r->volume >= 0.25 && r->volume <= 4);
    FUZZ_CHECK(r->fps >= 1 && r->fps <= 120 && r->life <= 2 && r->seed <= 9007199254740992.0);
    FUZZ_CHECK(r->blend <= SPEAK_BLEND_WEIGHTED && r->mode <= SPEAK_QUIET);
    FUZZ_CHECK(r->priority <= PRIORITY_ALARM && (!r->topic || strlen(r->topic) <= 64));
    FUZZ_CHECK(!r->id || strlen(r->id) <= 64);
}

static void check_error(const struct error *e) {
    FUZZ_CHECK(e->code && memchr(e->message, 0, sizeof e->message) && memchr(e->field, 0, sizeof e->field));
    struct buf out = {0};
    json_write(&out, error_json(e));
    json_t *again = json_loadb((char *)out.data, out.size, JSON_ALLOW_NUL, NULL);
    FUZZ_CHECK(again);
    json_decref(again);
    buf_free(&out);
}

/* A request survives the round trip to another daemon. */
static void check_told(const struct speech_request *request) {
    struct speech_request heard;
    struct error e;
    json_t *told = request_to_json(request);
    if (!told)
        return; /* no UTF-8 */
    request_init(&heard);
    FUZZ_CHECK(!request_from_json(&heard, told, &e));
    json_t *again = request_to_json(&heard);
    FUZZ_CHECK(json_equal(told, again));
    json_decref(again);
    json_decref(told);
    request_free(&heard);
}

static void take_message(const json_t *message) {
    struct speech_request request, copy;
    struct idle_options idle;
    struct mood_request mix;
    struct error e = {0};
    bool on;
    request_init(&request);
    if (request_from_json(&request, message, &e))
        check_error(&e);
    check_request(&request);
    check_told(&request);
    request_copy(&copy, &request);
    check_request(&copy);
    if (idle_from_json(message, &request, 1, &idle, &on, &e))
        check_error(&e);
    else
        FUZZ_CHECK(idle.life >= 0 && idle.life <= 2);
    if (express_read(message, &mix, &e)) {
        check_error(&e);
    } else {
        FUZZ_CHECK(mix.count <= MOOD_MIX && mix.ease >= 0 && isfinite(mix.ease));
        for (size_t i = 0; i < mix.count; i++)
            FUZZ_CHECK(mix.names[i] && mix.intensities[i] >= 0 && mix.intensities[i] <= 1);
    }
    request_free(&copy);
    request_free(&request);
}

static void take_words(struct fuzz_input *in) {
    struct speech_request request;
    struct error e = {0};
    request_init(&request);
    while (fuzz_left(in)) {
        char *line = fuzz_line(in), *equals = strchr(line, '=');
        if (equals) {
            *equals = '\0';
            struct request_value value = {REQUEST_WORD, equals + 1, strlen(equals + 1), 0};
            if (request_set(&request, line, value, &e) < 0)
                check_error(&e);
        }
        free(line);
    }
    check_request(&request);
    request_free(&request);
}

static void write_line(const struct stream_event *event) {
    struct buf line = {0};
    event_line(&line, event);
    for (size_t i = 0; i < line.size; i++)
        FUZZ_CHECK(line.data[i] >= ' ');
    FUZZ_CHECK(utf8_check((const char *)line.data, line.size) == line.size);
    buf_free(&line);
}

/* Any message becomes one line of the text protocol. */
static void write_lines(const char *text, size_t size) {
    struct error e;
    char *string = mem_strndup(text, size);
    write_line(&(struct stream_event){.kind = STREAM_WORD, .sample_rate = 16000, .end = size, .text = text});
    write_line(&(struct stream_event){.kind = STREAM_MARK, .text = string});
    error_in_field(&e, ERROR_BAD_FIELD, string, "%s", string);
    write_line(&(struct stream_event){.kind = STREAM_WARNING, .error = &e});
    free(string);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    struct fuzz_input in = fuzz_input(data, size);
    uint8_t kind = fuzz_u8(&in) % 3;
    if (kind == 1) {
        take_words(&in);
        return 0;
    }
    char *text = (char *)fuzz_rest(&in, &size);
    json_t *message = kind ? NULL : json_loadb(text, size, JSON_REJECT_DUPLICATES | JSON_ALLOW_NUL, NULL);
    if (json_is_object(message))
        take_message(message);
    if (kind)
        write_lines(text, size);
    json_decref(message);
    free(text);
    return 0;
}
