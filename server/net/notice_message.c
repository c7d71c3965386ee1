/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/net/notice_message.h"
#include "server/net/net_internal.h"
#include <string.h>

void notice_take_member(const json_t *message, const char *name, json_t *into) {
    json_object_set(into, name, json_object_get(message, name)); /* nothing where there is none */
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
