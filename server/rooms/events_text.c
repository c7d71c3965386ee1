/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Events and answers as lines of text, for people who type. */
#include "protocol/server_messages.h"
#include "server/base/utf8.h"
#include "server/rooms/events.h"
#include <string.h>

/* Control characters would end the line, so they become spaces. Input quoted in a message may not be
 * UTF-8: non-ASCII bytes are then replaced with '?'. */
static void add_text(struct buf *line, const char *text, size_t size) {
    bool good = utf8_check(text, size) == size;
    buf_add(line, " ", 1);
    buf_add(line, text, size);
    for (uint8_t *c = line->data + line->size - size; c < line->data + line->size; c++)
        *c = *c < ' ' ? ' ' : !good && *c >= 0x80 ? '?' : *c;
}

static void add(struct buf *line, const char *text) {
    if (text)
        add_text(line, text, strlen(text));
}

static void add_seconds(struct buf *line, const struct stream_event *e, uint32_t samples) {
    buf_printf(line, " %.3f", e->sample_rate ? (double)samples / e->sample_rate : 0.0);
}

static void add_error(struct buf *line, const struct error *e) {
    add(line, error_name(e->code));
    if (e->place == PLACE_FIELD)
        add(line, e->field);
    add(line, e->message);
    if (e->place == PLACE_LINE)
        buf_printf(line, " (line %zu, column %zu)", e->line, e->column);
}

void event_line(struct buf *line, const struct stream_event *e) {
    buf_printf(line, "%s", event_name(e->kind));
    switch (e->kind) {
    case STREAM_BEGIN:
        add(line, e->voice);
        add(line, e->play);
        break;
    case STREAM_SENTENCE:
        add_seconds(line, e, e->sample);
        add_seconds(line, e, e->duration);
        break;
    case STREAM_WORD:
        add_seconds(line, e, e->sample);
        add_text(line, e->text, e->end - e->start);
        break;
    case STREAM_SPEAKER:
        add_seconds(line, e, e->sample);
        add(line, *e->name ? e->name : NULL);
        break;
    case STREAM_MARK:
    case STREAM_PHONE:
    case STREAM_JUMPED:
        add_seconds(line, e, e->sample);
        add(line, e->text);
        break;
    case STREAM_PAUSED:
    case STREAM_RESUMED:
        if (e->utterance)
            add_seconds(line, e, e->sample);
        break;
    case STREAM_WARNING:
    case STREAM_ERROR:
        add_error(line, e->error);
        break;
    case STREAM_END:
        add(line, e->reason);
        add_seconds(line, e, e->duration);
        break;
    }
}

/* Members that are printed for each message that is not an event; missing members are skipped. */
static const struct {
    const char *type, *members[4];
} lines[] = {
    SERVER_LINES /* generated from protocol/messages.json */
    {"help", {"text", NULL}},
};

void text_line(const json_t *message, struct buf *line) {
    const char *type = json_string_value(json_object_get(message, "type"));
    for (size_t i = 0; i < sizeof lines / sizeof *lines; i++) {
        if (strcmp(lines[i].type, type))
            continue;
        buf_printf(line, "%s", type);
        for (const char *const *member = lines[i].members; *member; member++) {
            const json_t *value = json_object_get(message, *member);
            if (json_is_string(value))
                buf_printf(line, " %s", json_string_value(value));
        }
        if (json_object_get(message, "line"))
            buf_printf(line, " (line %d, column %d)",
                       (int)json_integer_value(json_object_get(message, "line")),
                       (int)json_integer_value(json_object_get(message, "column")));
    }
    for (size_t i = 0; i < line->size; i++)
        if (line->data[i] < ' ')
            line->data[i] = ' ';
}
