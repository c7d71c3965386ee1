/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/json/error_json.h"
#include "server/rooms/shared/shared_internal.h"
#include <string.h>

json_t *packet_begin(const char *kind, const char *room) {
    return json_pack("{si ss ss}", "v", PACKET_VERSION, "kind", kind, "room", room);
}

void packet_write(struct buf *out, json_t *head, const void *body, size_t size) {
    json_print(out, head, JSON_COMPACT | JSON_REAL_PRECISION(17));
    json_decref(head);
    buf_add(out, "\n", 1);
    if (size)
        buf_add(out, body, size);
}

static const char *word(const json_t *head, const char *name) {
    const char *value = json_string_value(json_object_get(head, name));
    return value ? value : "";
}

bool packet_read(const void *data, size_t size, struct packet *p) {
    const char *end = memchr(data, '\n', size);
    size_t length = end ? (size_t)(end - (const char *)data) : 0;
    *p = (struct packet){.head = length ? json_loadb(data, length, JSON_ALLOW_NUL, NULL) : NULL};
    if (!p->head)
        return false;
    p->kind = word(p->head, "kind");
    p->room = word(p->head, "room");
    p->from = word(p->head, "from");
    p->body = (const uint8_t *)data + length + 1;
    p->size = size - length - 1;
    if (packet_number(p, "v") == PACKET_VERSION)
        return true;
    json_decref(p->head);
    p->head = NULL;
    return false;
}

uint64_t packet_number(const struct packet *p, const char *name) {
    json_int_t value = json_integer_value(json_object_get(p->head, name));
    return value > 0 ? (uint64_t)value : 0;
}
