/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Converts the encodings of documents to UTF-8. Tables: ISO/IEC 8859-1 and -9, and Microsoft's code pages
 * 1252 and 1254 according to Unicode's mappings. */
#include "server/base/utf8.h"
#include "server/markup/detect.h"
#include <stdlib.h>
#include <string.h>

static const uint16_t windows[32] = {
    0x20AC, 0,      0x201A, 0x0192, 0x201E, 0x2026, 0x2020, 0x2021, 0x02C6, 0x2030, 0x0160,
    0x2039, 0x0152, 0,      0x017D, 0,      0,      0x2018, 0x2019, 0x201C, 0x201D, 0x2022,
    0x2013, 0x2014, 0x02DC, 0x2122, 0x0161, 0x203A, 0x0153, 0,      0x017E, 0x0178,
};

static const struct {
    const char *name;
    bool turkish, windows;
} encodings[] = {
    {"iso-8859-1", false, false},  {"iso8859-1", false, false}, {"iso_8859-1", false, false},
    {"latin1", false, false},      {"latin-1", false, false},   {"l1", false, false},
    {"iso-8859-9", true, false},   {"iso8859-9", true, false},  {"iso_8859-9", true, false},
    {"latin5", true, false},       {"latin-5", true, false},    {"l5", true, false},
    {"windows-1252", false, true}, {"cp1252", false, true},     {"windows-1254", true, true},
    {"cp1254", true, true},
};

/* Returns 0 for a byte without a character. */
static uint32_t decode(uint8_t byte, bool turkish, bool cp) {
    static const uint8_t turkish_bytes[] = {0xD0, 0xDD, 0xDE, 0xF0, 0xFD, 0xFE};
    static const uint16_t turkish_letters[] = {0x011E, 0x0130, 0x015E, 0x011F, 0x0131, 0x015F};
    if (cp && byte >= 0x80 && byte < 0xA0)
        return turkish && (byte == 0x8E || byte == 0x9E) ? 0 : windows[byte - 0x80];
    for (size_t i = 0; turkish && i < sizeof turkish_bytes; i++)
        if (byte == turkish_bytes[i])
            return turkish_letters[i];
    return byte;
}

static int at_byte(struct error *e, enum error_code code, const char *text, size_t byte,
                   const char *message) {
    struct lines lines = {0};
    size_t line, column;
    lines_place(&lines, text, byte, &line, &column);
    return error_at_line(e, code, line, column, "%s", message);
}

int markup_decode(const char *text, size_t size, char **out, size_t *out_size, struct error *e) {
    *out = NULL;
    size_t bad = utf8_check(text, size), known = 0, count = sizeof encodings / sizeof *encodings;
    struct prolog prolog;
    if (bad == size || prolog_read(text, size, &prolog, e) || !*prolog.encoding ||
        !strcmp(prolog.encoding, "utf-8"))
        return 0;
    while (known < count && strcmp(encodings[known].name, prolog.encoding) != 0)
        known++;
    if (known == count)
        return at_byte(
            e, ERROR_UNKNOWN_ENCODING, text, prolog.encoding_at,
            "this encoding is not read here; UTF-8, ISO-8859-1, ISO-8859-9 and windows-1252, -1254 are");
    struct buf buf = {0};
    for (size_t i = 0; i < size; i++) {
        uint32_t c = decode((uint8_t)text[i], encodings[known].turkish, encodings[known].windows);
        if (!c && text[i]) {
            buf_free(&buf);
            return at_byte(e, ERROR_BAD_ENCODING, text, i,
                           "the encoding that is stated has no such character");
        }
        buf.size += utf8_put(c, buf_reserve(&buf, 4));
    }
    *out_size = buf.size;
    buf_add(&buf, "", 1);
    *out = (char *)buf.data;
    return 0;
}
