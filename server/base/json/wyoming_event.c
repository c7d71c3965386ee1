/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/json/wyoming_event.h"
#include <string.h>

enum { WYOMING_LINE_MOST = 65536, WYOMING_DATA_MOST = 1 << 20, WYOMING_PAYLOAD_MOST = 1 << 22 };

/* Returns a length stated in the line; absent or null: 0; -1 if it is invalid. */
static long long length_of(const json_t *head, const char *name, long long most) {
    const json_t *value = json_object_get(head, name);
    long long length = json_integer_value(value);
    return value && !json_is_null(value) && (!json_is_integer(value) || length < 0 || length > most) ? -1
                                                                                                     : length;
}

void wyoming_event_free(struct wyoming_event *f) {
    json_decref(f->head);
    json_decref(f->data);
    buf_free(&f->payload);
    *f = (struct wyoming_event){0};
}

static int fail(struct wyoming_event *f, const char **why, const char *text) {
    wyoming_event_free(f);
    *why = text;
    return -1;
}

int wyoming_event_next(struct buf *come, struct wyoming_event *f, const char **why) {
    *f = (struct wyoming_event){0};
    const char *bytes = (const char *)come->data, *end = come->size ? memchr(bytes, '\n', come->size) : NULL;
    if (!end)
        return come->size > WYOMING_LINE_MOST ? fail(f, why, "a line is too long") : 0;
    size_t line = (size_t)(end - bytes) + 1;
    f->head = json_loadb(bytes, line, 0, NULL);
    f->type = json_string_value(json_object_get(f->head, "type"));
    if (!f->type)
        return fail(f, why, "a line is not a JSON object with a type");
    long long data = length_of(f->head, "data_length", WYOMING_DATA_MOST);
    long long payload = length_of(f->head, "payload_length", WYOMING_PAYLOAD_MOST);
    if (data < 0 || payload < 0)
        return fail(f, why, "a length is not a number, or too large");
    if (come->size - line < (size_t)(data + payload)) {
        wyoming_event_free(f);
        return 0;
    }
    json_t *more = data ? json_loadb(bytes + line, (size_t)data, 0, NULL) : NULL;
    if (data && !json_is_object(more)) {
        json_decref(more);
        return fail(f, why, "the data is not a JSON object");
    }
    const json_t *of_line = json_object_get(f->head, "data");
    f->data = json_is_object(of_line) ? json_deep_copy(of_line) : json_object();
    if (more)
        json_object_update(f->data, more);
    json_decref(more);
    if (payload)
        buf_add(&f->payload, come->data + line + (size_t)data, (size_t)payload);
    buf_consume(come, line + (size_t)(data + payload));
    return 1;
}

void wyoming_event_write(struct buf *out, const char *type, json_t *data, const void *payload, size_t size) {
    struct buf text = {0};
    if (data) {
        size_t length = json_dumpb(data, NULL, 0, JSON_COMPACT);
        json_dumpb(data, buf_reserve(&text, length), length, JSON_COMPACT);
        text.size = length;
    }
    json_t *head = json_pack("{ss sI sI}", "type", type, "data_length", (json_int_t)text.size,
                             "payload_length", (json_int_t)size);
    size_t length = json_dumpb(head, NULL, 0, JSON_COMPACT);
    json_dumpb(head, buf_reserve(out, length), length, JSON_COMPACT);
    out->size += length;
    buf_add(out, "\n", 1);
    if (text.size)
        buf_add(out, text.data, text.size);
    if (size)
        buf_add(out, payload, size);
    buf_free(&text);
    json_decref(head);
    json_decref(data);
}
