/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A stream's events as JSON, written by hand: many leave each second, to every listener. */
#include "server/base/utf8.h"
#include "server/rooms/events.h"
#include <stdio.h>
#include <string.h>

static void put(struct buf *out, const char *text) {
    buf_add(out, text, strlen(text));
}

static void put_member(struct buf *out, const char *name) {
    put(out, ",\"");
    put(out, name);
    put(out, "\":");
}

static void put_number(struct buf *out, uint64_t value) {
    char digits[20];
    size_t at = sizeof digits;
    do
        digits[--at] = (char)('0' + value % 10);
    while (value /= 10);
    buf_add(out, digits + at, sizeof digits - at);
}

static void put_escaped(struct buf *out, unsigned char c) {
    char escaped[8];
    const char *plain = strchr("\"\\", c);
    int length = c && plain ? snprintf(escaped, sizeof escaped, "\\%c", c)
                            : snprintf(escaped, sizeof escaped, "\\u%04x", c);
    buf_add(out, escaped, (size_t)length);
}

/* Input quoted in a message may not be UTF-8, or may have been cut inside a character: non-ASCII bytes are
 * then replaced with '?'. */
static void put_string(struct buf *out, const char *text, size_t size) {
    bool good = utf8_check(text, size) == size;
    size_t from = 0;
    put(out, "\"");
    for (size_t i = 0; i < size; i++) {
        unsigned char c = (unsigned char)text[i];
        bool bad = c >= 0x80 && !good;
        if (c >= 0x20 && c != '"' && c != '\\' && !bad)
            continue;
        buf_add(out, text + from, i - from);
        from = i + 1;
        if (bad)
            put(out, "?");
        else
            put_escaped(out, c);
    }
    buf_add(out, text + from, size - from);
    put(out, "\"");
}

static void put_text(struct buf *out, const char *name, const char *value) {
    if (!value)
        return;
    put_member(out, name);
    put_string(out, value, strlen(value));
}

static void put_count(struct buf *out, const char *name, uint64_t value) {
    put_member(out, name);
    put_number(out, value);
}

/* Prints up to 6 decimals, without trailing zeros. */
static void put_seconds(struct buf *out, const char *name, const struct stream_event *e, uint32_t samples) {
    uint64_t rate = e->sample_rate, millionths = rate ? (samples * 2000000ull + rate) / (2 * rate) : 0;
    char digits[] = ".000000";
    size_t length = sizeof digits - 1;
    put_count(out, name, millionths / 1000000);
    millionths %= 1000000;
    for (size_t i = length; --i > 0; millionths /= 10)
        digits[i] = (char)('0' + millionths % 10);
    while (length > 2 && digits[length - 1] == '0')
        length--;
    buf_add(out, digits, length);
}

static void put_real(struct buf *out, const char *name, double value) {
    char digits[32];
    put_member(out, name);
    buf_add(out, digits, (size_t)snprintf(digits, sizeof digits, "%.12g", value));
}

static void put_error(struct buf *out, const struct error *e) {
    put_text(out, "code", error_name(e->code));
    put_text(out, "message", e->message);
    if (e->place == PLACE_BYTE)
        put_count(out, "byte", e->byte);
    if (e->place == PLACE_FIELD)
        put_text(out, "field", e->field);
    if (e->place == PLACE_LINE) {
        put_count(out, "line", e->line);
        put_count(out, "column", e->column);
    }
}

static void put_time(struct buf *out, const struct stream_event *e) {
    put_seconds(out, "time", e, e->sample);
    put_count(out, "sample", e->sample);
}

static void put_begin(struct buf *out, const struct stream_event *e) {
    put_count(out, "rate", e->sample_rate);
    put_real(out, "fps", e->fps);
    put_text(out, "play", e->play);
    put_text(out, "voice", e->voice);
    put_text(out, "lang", e->lang);
    put_text(out, "engine", e->engine);
    put_text(out, "markup", e->markup);
    if (e->again)
        put(out, ",\"again\":true");
    if (e->bell)
        put(out, ",\"bell\":true");
    if (e->live) {
        put_count(out, "lookahead", e->lookahead);
        put_member(out, "captions");
        put(out, "false");
    }
    if (e->idle >= 0)
        put_real(out, "idle", e->idle);
}

static void put_place(struct buf *out, const struct stream_event *e) {
    put_time(out, e);
    put_seconds(out, "duration", e, e->duration);
    put_count(out, "start", e->start);
    put_count(out, "end", e->end);
    put_count(out, "utf16_start", e->utf16_start);
    put_count(out, "utf16_end", e->utf16_end);
    put_member(out, "text");
    put_string(out, e->text, e->end - e->start);
}

const char *event_name(enum stream_event_kind kind) {
    static const char *const types[] = {
        [STREAM_BEGIN] = "begin",     [STREAM_SENTENCE] = "sentence", [STREAM_WORD] = "word",
        [STREAM_SPEAKER] = "speaker", [STREAM_MARK] = "mark",         [STREAM_WARNING] = "warning",
        [STREAM_ERROR] = "error",     [STREAM_END] = "end",           [STREAM_PHONE] = "phone",
        [STREAM_PAUSED] = "paused",   [STREAM_RESUMED] = "resumed",   [STREAM_JUMPED] = "jumped",
    };
    return types[kind];
}

void event_write(struct buf *out, const struct stream_event *e, const char *stream) {
    put(out, "{\"type\":\"");
    put(out, event_name(e->kind));
    put(out, "\"");
    put_text(out, "stream", stream);
    if (e->utterance)
        put_count(out, "utterance", e->utterance);
    put_text(out, "id", e->id);
    switch (e->kind) {
    case STREAM_BEGIN:
        put_begin(out, e);
        break;
    case STREAM_SENTENCE:
    case STREAM_WORD:
        put_place(out, e);
        break;
    case STREAM_SPEAKER:
        put_time(out, e);
        put_text(out, "speaker", e->text);
        put_text(out, "name", e->name);
        break;
    case STREAM_MARK:
        put_time(out, e);
        put_text(out, "name", e->text);
        break;
    case STREAM_PHONE:
        put_time(out, e);
        put_seconds(out, "duration", e, e->duration);
        put_text(out, "ipa", e->text);
        break;
    case STREAM_RESUMED:
        if (e->idle >= 0)
            put_real(out, "idle", e->idle);
        /* fall through */
    case STREAM_PAUSED:
        if (e->utterance)
            put_time(out, e);
        break;
    case STREAM_JUMPED:
        put_time(out, e);
        put_text(out, "mark", e->text);
        break;
    case STREAM_WARNING:
    case STREAM_ERROR:
        put_error(out, e->error);
        break;
    case STREAM_END:
        put_text(out, "reason", e->reason);
        put_seconds(out, "duration", e, e->duration);
        if (e->blocked)
            put(out, ",\"blocked\":true");
        break;
    }
    put(out, "}");
}

json_t *message_read(const struct queued_message *message) {
    return json_loadb((const char *)queued_message_body(message), message->size, JSON_ALLOW_NUL, NULL);
}
