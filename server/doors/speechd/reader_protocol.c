/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/doors/speechd/reader_protocol.h"
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

void reader_say(const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    vprintf(format, arguments);
    va_end(arguments);
    putchar('\n');
    fflush(stdout);
}

void reader_list(int code, const char *first, const char *second, const char *third) {
    const char *const texts[] = {first, second, third};
    printf("%d-", code);
    for (size_t i = 0; i < 3 && texts[i]; i++) {
        if (i)
            putchar('\t');
        for (const char *c = texts[i]; *c; c++)
            putchar((unsigned char)*c < ' ' || *c == 0x7F ? ' ' : *c);
    }
    putchar('\n');
}

void reader_mark(const char *name) {
    reader_list(700, name, NULL, NULL);
    reader_say("700 INDEX MARK");
}

void reader_sound(const int16_t *samples, size_t count, unsigned rate) {
    enum { ESCAPE = 0x7d, TURN = 0x20 };
    printf("705-bits=16\n705-num_channels=1\n705-sample_rate=%u\n705-num_samples=%zu\n705-big_endian=0\n705-"
           "AUDIO",
           rate, count);
    putchar(0);
    for (size_t i = 0; i < 2 * count; i++) {
        unsigned char byte = (unsigned char)((uint16_t)samples[i / 2] >> 8 * (i & 1));
        bool escaped = byte == ESCAPE || byte == '\n';
        if (escaped)
            putchar(ESCAPE);
        putchar(escaped ? byte ^ TURN : byte);
    }
    printf("\n705 AUDIO\n");
    fflush(stdout);
}

static void begin_message(struct reader_protocol *p, enum reader_kind kind) {
    p->state = READER_MESSAGE;
    p->kind = kind;
    p->text.size = p->lines = 0;
    reader_say("202 OK RECEIVING MESSAGE");
}

static void begin_settings(struct reader_protocol *p, const char *receiving, const char *received,
                           bool count) {
    p->state = READER_SETTINGS;
    p->received = received;
    p->settings_count = count;
    p->wrong = false;
    reader_say("%s", receiving);
}

static void command(struct reader_protocol *p, const char *line) {
    if (!strcmp(line, "SPEAK"))
        begin_message(p, READER_TEXT);
    else if (!strcmp(line, "CHAR"))
        begin_message(p, READER_CHAR);
    else if (!strcmp(line, "KEY"))
        begin_message(p, READER_KEY);
    else if (!strcmp(line, "SOUND_ICON"))
        begin_message(p, READER_SOUND_ICON);
    else if (!strcmp(line, "STOP"))
        p->calls.stop(p->ctx);
    else if (!strcmp(line, "PAUSE"))
        p->calls.pause(p->ctx);
    else if (!strcmp(line, "LIST VOICES"))
        p->calls.list_voices(p->ctx);
    else if (!strcmp(line, "INIT"))
        reader_say("299-faccia: ready\n299 OK LOADED SUCCESSFULLY");
    else if (!strcmp(line, "SET"))
        begin_settings(p, "203 OK RECEIVING SETTINGS", "203 OK SETTINGS RECEIVED", true);
    else if (!strcmp(line, "AUDIO"))
        begin_settings(p, "207 OK RECEIVING AUDIO SETTINGS", "203 OK AUDIO INITIALIZED", false);
    else if (!strcmp(line, "LOGLEVEL"))
        begin_settings(p, "207 OK RECEIVING LOGLEVEL SETTINGS", "203 OK LOG LEVEL SET", false);
    else if (!strncmp(line, "DEBUG", 5))
        reader_say("200 OK DEBUGGING %s", strstr(line, "ON") ? "ON" : "OFF");
    else if (!strcmp(line, "QUIT"))
        p->calls.quit(p->ctx);
    else
        reader_say("300 ERR UNKNOWN COMMAND");
}

static void end_message(struct reader_protocol *p) {
    p->state = READER_COMMANDS;
    buf_add(&p->text, "", 1);
    bool whole =
        p->text.size > 1 && p->text.size <= READER_TEXT_MOST && !memchr(p->text.data, 0, p->text.size - 1);
    if (p->kind != READER_TEXT && p->lines > 1)
        reader_say("305 DATA MORE THAN ONE LINE");
    else if (whole && p->calls.speak(p->ctx, p->kind, (char *)p->text.data))
        return; /* it has answered */
    else
        reader_say("301 ERROR CANT SPEAK");
}

static void message_line(struct reader_protocol *p, const char *line, size_t size) {
    if (size == 1 && *line == '.') {
        end_message(p);
        return;
    }
    if (p->lines++)
        buf_add(&p->text, "\n", 1);
    size_t dots = *line == '.';
    if (p->text.size + size <= READER_LINE_MOST)
        buf_add(&p->text, line + dots, size - dots);
}

static void settings_line(struct reader_protocol *p, char *line) {
    char *value = strchr(line, '=');
    if (!strcmp(line, ".")) {
        p->state = READER_COMMANDS;
        reader_say("%s", p->wrong ? "303 ERROR INVALID PARAMETER OR VALUE" : p->received);
        return;
    }
    if (value)
        *value++ = '\0';
    p->wrong |= !value || (p->settings_count && !p->calls.set(p->ctx, line, value));
}

void reader_take(struct reader_protocol *p, const char *bytes, size_t size) {
    size_t at = 0;
    buf_add(&p->come, bytes, size);
    for (char *end; p->come.size > at && (end = memchr(p->come.data + at, '\n', p->come.size - at));) {
        char *line = (char *)p->come.data + at;
        size_t length = (size_t)(end - line);
        *end = '\0';
        at += length + 1;
        if (p->state == READER_MESSAGE)
            message_line(p, line, length);
        else if (p->state == READER_SETTINGS)
            settings_line(p, line);
        else
            command(p, line);
    }
    buf_consume(&p->come, at);
    if (p->come.size > READER_LINE_MOST)
        p->come.size = 0;
}

void reader_free(struct reader_protocol *p) {
    buf_free(&p->come);
    buf_free(&p->text);
}
