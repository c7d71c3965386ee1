/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/log.h"
#include "server/base/utf8.h"
#include <stdarg.h>
#include <stdatomic.h>
#include <stdio.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

static const char *const names[] = {[LOG_TEXT] = "text", [LOG_JSON] = "json", [LOG_JOURNAL] = "journal"};
static _Atomic(enum log_format) current;

void log_open(enum log_format format) {
    current = format;
}

bool log_open_named(const char *name) {
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        if (!strcmp(names[i], name)) {
            log_open((enum log_format)i);
            return true;
        }
    return false;
}

const char *log_format_name(void) {
    return names[current];
}

/* Quotes the text as a JSON string. */
static void quote(char *out, size_t cap, const char *text) {
    size_t n = 0;
    for (; *text && n + 8 < cap; text++) {
        unsigned char c = (unsigned char)*text;
        if (c == '"' || c == '\\')
            n += (size_t)snprintf(out + n, cap - n, "\\%c", c);
        else if (c < 0x20)
            n += (size_t)snprintf(out + n, cap - n, "\\u%04x", c);
        else
            out[n++] = (char)c;
    }
    out[n] = '\0';
}

static void write_json(char *out, size_t cap, const char *word, const char *text) {
    struct timespec now;
    struct tm utc;
    char at[32], quoted[1000];
    clock_gettime(CLOCK_REALTIME, &now);
    strftime(at, sizeof at, "%Y-%m-%dT%H:%M:%S", gmtime_r(&now.tv_sec, &utc));
    quote(quoted, sizeof quoted, text);
    snprintf(out, cap, "{\"time\":\"%s.%03ldZ\",\"level\":\"%.*s\",\"pid\":%ld,\"message\":\"%s\"}\n", at,
             now.tv_nsec / 1000000, *word ? (int)strcspn(word, ":") : 4, *word ? word : "info",
             (long)getpid(), quoted);
}

/* Writes a line at once, so that lines of several processes do not mix. Only journald gets the priority
 * prefix. */
static void line(int priority, const char *word, const char *format, va_list args) {
    char text[1024], out[1200];
    vsnprintf(text, sizeof text, format, args);
    utf8_mend(text); /* untrusted text must not start lines or control the terminal */
    if (current == LOG_JSON)
        write_json(out, sizeof out, word, text);
    else if (current == LOG_JOURNAL)
        snprintf(out, sizeof out, "<%d>%s\n", priority, text);
    else
        snprintf(out, sizeof out, "faccia: %s%s\n", word, text);
    fputs(out, stderr);
}

void log_error(const char *format, ...) {
    va_list args;
    va_start(args, format);
    line(3, "error: ", format, args);
    va_end(args);
}

void log_warn(const char *format, ...) {
    va_list args;
    va_start(args, format);
    line(4, "warning: ", format, args);
    va_end(args);
}

void log_info(const char *format, ...) {
    va_list args;
    va_start(args, format);
    line(6, "", format, args);
    va_end(args);
}
