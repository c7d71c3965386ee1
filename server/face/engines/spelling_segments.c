/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/mem.h"
#include "server/face/packs/spelling.h"
#include <math.h>
#include <stdlib.h>

/* Words are not drawn out more than this, as a multiple of the table: the rest of the time is a pause. */
#define MAX_STRETCH 2.0
/* Nor more than the sentence's usual word by this factor. */
#define MAX_UNEVEN 1.5
/* A shorter gap is a part of the word before it. */
#define MIN_PAUSE 0.04

struct room {
    double start, end; /* s: to the next word or the end of the audio */
    double said;       /* s: the word's end if the voice knows it, else 0 */
    double table;      /* s: by the table */
    struct spelled *letters;
    size_t count;
};

static int ascending(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* How much longer than in the table the usual word is: the median, so that pauses do not count. */
static double pace_of(const struct room *rooms, size_t count) {
    double *ratios = mem_alloc((count + 1) * sizeof *ratios), pace = 1;
    size_t used = 0;
    for (size_t i = 0; i < count; i++)
        if (rooms[i].table > 0)
            ratios[used++] = (rooms[i].end - rooms[i].start) / rooms[i].table;
    if (used) {
        qsort(ratios, used, sizeof *ratios, ascending);
        pace = ratios[(used - 1) / 2];
    }
    free(ratios);
    return fmin(pace, MAX_STRETCH);
}

static double scale_of(const struct room *room, double pace) {
    if (room->said > room->start)
        return (room->said - room->start) / room->table;
    return fmin((room->end - room->start) / room->table, fmin(MAX_UNEVEN * pace, MAX_STRETCH));
}

static void add(struct phone_segments *g, const struct speech_phone *phone, double start, double end) {
    if (end <= start && !phone)
        return;
    g->items = mem_grow(g->items, &g->cap, g->count + 1, sizeof *g->items);
    g->items[g->count++] = (struct phone_segment){phone, start, end, phone ? 0.5 : 0, 1};
}

static void read_rooms(const struct spelling *spelling, const struct sentence_audio *u, double rate,
                       double end, struct room *rooms) {
    for (size_t i = 0; i < u->word_count; i++) {
        const struct word *w = &u->words[i];
        struct room *room = &rooms[i];
        room->start = w->start / rate;
        room->end = i + 1 < u->word_count ? u->words[i + 1].start / rate : end;
        room->said = w->end > w->start && w->end / rate < room->end ? w->end / rate : 0;
        room->count = spelling_read(spelling, w->text ? w->text : "", &room->letters);
        for (size_t k = 0; k < room->count; k++)
            room->table += room->letters[k].letter->seconds;
    }
}

void spelling_segments(const struct spelling *spelling, const struct sentence_audio *u,
                       struct phone_segments *out) {
    double rate = u->sample_rate ? u->sample_rate : 1;
    *out = (struct phone_segments){.end = u->samples / rate};
    struct room *rooms = mem_alloc((u->word_count + 1) * sizeof *rooms);
    read_rooms(spelling, u, rate, out->end, rooms);
    double pace = pace_of(rooms, u->word_count), at = 0;
    for (size_t i = 0; i < u->word_count; i++) {
        struct room *room = &rooms[i];
        add(out, NULL, at, room->start);
        at = room->start;
        double scale = room->count ? scale_of(room, pace) : 0;
        for (size_t k = 0; k < room->count; k++) {
            double end = at + scale * room->letters[k].letter->seconds;
            if (k + 1 == room->count && room->end - end < MIN_PAUSE)
                end = room->end;
            add(out, room->letters[k].letter->phone, at, end);
            at = end;
        }
        free(room->letters);
    }
    add(out, NULL, at, out->end);
    free(rooms);
}
