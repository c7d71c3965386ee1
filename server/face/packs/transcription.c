/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/face/packs/transcription.h"
#include "server/base/mem.h"
#include "server/base/utf8.h"
#include "server/face/packs/context_table.h"
#include "server/face/packs/phone_match.h"
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const struct transcription_sound transcription_wav = {44, 16000, 2};

#define CODE ERROR_BAD_TRANSCRIPTION

enum { LINE_BYTES = 128 };

struct transcription_reader {
    const struct transcription_sound *sound;
    const struct speech_pack *pack;
    struct sentence_audio *u;
    size_t cap, line;
    unsigned long index; /* 1 + the last line's index; 0 = none */
    bool ended;
    struct error *e;
};

static int fail(struct transcription_reader *r, const char *what, const char *name) {
    return error_at_line(r->e, CODE, r->line, 1, "%s%s", what, name);
}

static int read_number(struct transcription_reader *r, char **at, unsigned long *out) {
    char *end;
    errno = 0;
    *at += strspn(*at, " \t");
    *out = strtoul(*at, &end, 10);
    if (**at < '0' || **at > '9' || errno)
        return fail(r, "expected \"INDEX: OFFSET SYMBOL\"", "");
    *at = end;
    return 0;
}

static int read_time(struct transcription_reader *r, unsigned long offset, uint32_t *at) {
    if (offset < r->sound->header || (offset - r->sound->header) / r->sound->frame > UINT32_MAX)
        return fail(r, "the offset is not inside the sound", "");
    *at = (uint32_t)((offset - r->sound->header) / r->sound->frame);
    if (*at < r->u->samples)
        return fail(r, "the offset comes before the last line's", "");
    return 0;
}

/* The phone of a symbol; a pause for "##". */
static int read_symbol(struct transcription_reader *r, const char *symbol, struct phone *p) {
    if (!strcmp(symbol, "##")) {
        strcpy(p->sampa, "_");
        return 0;
    }
    p->stress = *symbol == '\'' ? 2 : 0;
    const struct context_phone *known = context_phone_named(r->pack->visemes, symbol + (*symbol == '\''));
    if (!known)
        return fail(r, "unknown symbol ", symbol);
    struct phone_matches found;
    phone_match_find(r->pack, known->ipa, &found);
    snprintf(p->ipa, sizeof p->ipa, "%s", known->ipa);
    snprintf(p->symbol, sizeof p->symbol, "%s", symbol);
    if (found.count)
        snprintf(p->sampa, sizeof p->sampa, "%s", found.match[0].phone->sampa);
    return 0;
}

/* Phones are adjacent and cover the sound from its first sample: a pause precedes the first one. */
static void add_phone(struct transcription_reader *r, const struct phone *p, uint32_t start) {
    struct sentence_audio *u = r->u;
    if (!u->phone_count && start && *p->ipa)
        add_phone(r, &(struct phone){.sampa = "_"}, 0);
    if (u->phone_count)
        u->phones[u->phone_count - 1].end = start;
    u->phones = mem_grow(u->phones, &r->cap, u->phone_count + 1, sizeof *u->phones);
    u->phones[u->phone_count] = *p;
    u->phones[u->phone_count].start = u->phone_count ? start : 0;
    u->phone_count++;
}

static int read_line(struct transcription_reader *r, char *line) {
    line[strcspn(line, "\r")] = '\0';
    if (!line[strspn(line, " \t")])
        return 0;
    unsigned long index, offset;
    uint32_t at = 0;
    struct phone p = {0};
    if (r->ended)
        return fail(r, "there is something after the last line, the one without a symbol", "");
    if (read_number(r, &line, &index))
        return -1;
    if (*line++ != ':')
        return fail(r, "expected a colon after the index", "");
    if (read_number(r, &line, &offset) || read_time(r, offset, &at))
        return -1;
    if (index < r->index)
        return fail(r, "the index does not come after the last line's", "");
    r->index = index + 1;
    line += strspn(line, " \t");
    line[strcspn(line, " \t")] = '\0';
    r->u->samples = at;
    if (*line) {
        if (read_symbol(r, line, &p))
            return -1;
        add_phone(r, &p, at);
    } else if (r->u->phone_count) {
        r->u->phones[r->u->phone_count - 1].end = at;
        r->ended = true;
    } else {
        return fail(r, "there is no phone", "");
    }
    return 0;
}

static int read_lines(struct transcription_reader *r, const char *text, size_t size) {
    for (size_t i = 0; i < size;) {
        const char *newline = memchr(text + i, '\n', size - i);
        size_t n = newline ? (size_t)(newline - (text + i)) : size - i;
        char line[LINE_BYTES];
        r->line++;
        if (n >= sizeof line)
            return fail(r, "the line is too long", "");
        memcpy(line, text + i, n);
        line[n] = '\0';
        if (read_line(r, line))
            return -1;
        i += n + 1;
    }
    return r->ended ? 0 : fail(r, "the last line, which tells the end, is missing", "");
}

struct sentence_audio *transcription_read(const char *text, size_t size,
                                          const struct transcription_sound *sound,
                                          const struct speech_pack *pack, struct error *e) {
    if (!pack->visemes) {
        error_set(e, ERROR_UNKNOWN_ENGINE, "'%s' has no table of visemes, so no symbols of transcriptions",
                  pack->lang);
        return NULL;
    }
    struct transcription_reader r = {.sound = sound, .pack = pack, .u = mem_alloc(sizeof *r.u), .e = e};
    r.u->sample_rate = sound->rate;
    snprintf(r.u->lang, sizeof r.u->lang, "%s", pack->lang);
    if (!read_lines(&r, text, size))
        return r.u;
    free(r.u->phones);
    free(r.u);
    return NULL;
}
