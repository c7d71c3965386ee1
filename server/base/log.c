/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/log.h"
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

/* One write per line, so that lines of several processes do not mix. The priority prefix is for journald
 * alone. */
static void line(int priority, const char *word, const char *format, va_list args) {
    char text[1024], out[1200];
    vsnprintf(text, sizeof text, format, args);
    if (getenv("JOURNAL_STREAM"))
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
