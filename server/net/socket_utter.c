/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a WebSocket client has spoken: here, or where its room is. */
#include "server/net/socket_internal.h"

void socket_speak_request(struct socket *s, struct speech_request *request) {
    unsigned limit = s->net->options.text_bytes;
    struct error e;
    int refused = socket_may_speak(s, &e) || passage_resolve(s->net, request, &e);
    if (!refused && request->text_size > limit)
        refused = error_in_field(&e, ERROR_TEXT_TOO_LONG, "text", "a text may have at most %u bytes", limit);
    if (!refused && request->open)
        refused = write_check(s, request, &e);
    if (refused) {
        socket_refuse(s, request->id, &e);
        return;
    }
    request->payer = principal_payer(&s->principal);
    request->asker = principal_asker(&s->principal);
    if (socket_order_speech(s, request))
        return;
    uint32_t utterance = stream_speak(socket_stream(s), request, NULL);
    if (request->open && utterance)
        write_begin(s, request->id, utterance, request->half);
}

void socket_speak(struct socket *s, const char *text, size_t size) {
    struct speech_request request;
    struct error e;
    request_copy(&request, &s->defaults);
    request_set(&request, "text", (struct request_value){REQUEST_STRING, text, size, 0}, &e);
    socket_speak_request(s, &request);
    request_free(&request);
}
