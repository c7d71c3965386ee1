/* SPDX-License-Identifier: MIT */
#include "protocol/fapfile_internal.h"
#include <string.h>

int fapfile_wrong(struct fapfile_reader *r, const char *at, const char *message) {
    *r->error = (struct fapfile_error){r->line_number, (size_t)(at - r->line) + 1, message};
    return -1;
}

/* Lines end with LF, CR LF or CR. */
static bool next_line(struct fapfile_reader *r) {
    if (r->text == r->limit)
        return false;
    const char *end = r->text;
    while (end < r->limit && *end != '\n' && *end != '\r')
        end++;
    r->line = r->at = r->text;
    r->line_end = end;
    r->line_number++;
    if (end < r->limit && *end++ == '\r' && end < r->limit && *end == '\n')
        end++;
    r->text = end;
    return true;
}

void fapfile_skip_space(struct fapfile_reader *r) {
    while (r->at < r->line_end && fapfile_is_space(*r->at))
        r->at++;
}

bool fapfile_next_content(struct fapfile_reader *r) {
    while (!r->stopped && next_line(r)) {
        r->stopped = r->stop && r->stop(r->ctx);
        if (r->stopped)
            break;
        fapfile_skip_space(r);
        if (r->at < r->line_end && *r->at != '#')
            return true;
    }
    r->line = r->line_end = r->at = r->limit;
    r->line_number++;
    return false;
}

struct fapfile_word fapfile_next_word(struct fapfile_reader *r) {
    fapfile_skip_space(r);
    struct fapfile_word w = {r->at, 0};
    while (r->at < r->line_end && !fapfile_is_space(*r->at))
        r->at++;
    w.size = (size_t)(r->at - w.at);
    return w;
}

/* Parses [+-]DIGITS[.DIGITS]. strtod will not do: it depends on the locale and needs a NUL. */
bool fapfile_parse_number(struct fapfile_word w, double *value) {
    size_t i = 0, digits = 0;
    double mantissa = 0, scale = 1;
    bool negative = w.size && w.at[0] == '-';
    if (w.size && (w.at[0] == '-' || w.at[0] == '+'))
        i++;
    for (; i < w.size && fapfile_is_digit(w.at[i]); i++, digits++)
        mantissa = mantissa * 10 + (w.at[i] - '0');
    if (i < w.size && w.at[i] == '.')
        for (i++; i < w.size && fapfile_is_digit(w.at[i]); i++, digits++) {
            if (scale >= 1e9)
                continue; /* further decimals change nothing that matters here */
            mantissa = mantissa * 10 + (w.at[i] - '0');
            scale *= 10;
        }
    *value = (negative ? -mantissa : mantissa) / scale;
    return digits && i == w.size;
}

bool fapfile_is_infinite(struct fapfile_word w) {
    if (w.size == 4 && (*w.at == '-' || *w.at == '+'))
        w = (struct fapfile_word){w.at + 1, 3};
    return w.size == 3 && !memcmp(w.at, "inf", 3);
}
