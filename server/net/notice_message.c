/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/net/notice_message.h"
#include "server/net/net_internal.h"
#include <string.h>

int notice_take_text(const json_t *message, const char *name, size_t most, json_t *into, struct error *e) {
    json_t *value = json_object_get(message, name);
    size_t length = json_string_length(value);
    if (!value || json_is_null(value))
        return 0;
    if (!json_is_string(value) || length > most || strlen(json_string_value(value)) != length)
        return error_in_field(e, ERROR_BAD_FIELD, name, "must be a string of at most %zu bytes", most);
    json_object_set(into, name, value);
    return 0;
}

json_t *notice_begin(const struct channel *c, const char *type) {
    return json_pack("{ss ss}", "type", type, "stream", c->name);
}

struct queued_message *notice_message(const json_t *object, const char *event) {
    struct buf text = {0}, line = {0};
    message_write(&text, json_incref((json_t *)object));
    text_line(object, &line);
    struct queued_message *message = queued_message_new(WEBSOCKET_TEXT, text.data, text.size);
    message->event = event;
    message->line = queued_message_new(WEBSOCKET_TEXT, line.data, line.size);
    buf_free(&text);
    buf_free(&line);
    return message;
}

struct queued_message *notice_tell(struct channel *c, const json_t *told, const char *event) {
    struct queued_message *message = notice_message(told, event);
    channel_notice(c, message);
    return message;
}
