/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/voice/assembly_said.h"
#include "server/base/utf8.h"
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

void assembly_warn(struct assembly *a, const char *format, ...) {
    char message[256];
    va_list args;
    va_start(args, format);
    vsnprintf(message, sizeof message, format, args);
    va_end(args);
    size_t length = strlen(message);
    message[utf8_check(message, length)] = '\0'; /* a cut character at the end, or what the plugin made up */
    if (a->u->warning_count < ASSEMBLY_WARNINGS)
        sentence_audio_warn(a->u, message);
}

uint32_t assembly_time(struct assembly *a, uint64_t t, uint32_t from, const char *what) {
    if (t > a->u->samples) {
        assembly_warn(a, "the voice put a %s after the end of the audio", what);
        t = a->u->samples;
    }
    if (t < from) {
        assembly_warn(a, "the voice put a %s before the one that it follows", what);
        t = from;
    }
    return (uint32_t)t;
}
