/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/library/align/clip_slices.h"
#include "server/base/mem.h"
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

enum {
    SEQUENCE = 5,      /* words that find a clip's place, with those of the clips after it */
    LOOK_AHEAD = 2000, /* words of the text without a clip between two clips */
    ANCHORS = 16,      /* clips to find in the whole text, if few are near its start */
    LEAD = 200,        /* words before such a clip, where those before it may be */
    SLICE_SECONDS = 5, /* shorter slices are joined with the next */
};

/* All words of the clips, and which of them begins each clip. */
struct spoken {
    struct text_words words;
    size_t *begins; /* one more than clips */
};

static void read_clips(struct spoken *s, const struct sound_clip *clips, size_t count) {
    s->begins = mem_alloc((count + 1) * sizeof *s->begins);
    for (size_t i = 0; i < count; i++) {
        s->begins[i] = s->words.count;
        text_words_add(&s->words, clips[i].text, strlen(clips[i].text), 0);
    }
    s->begins[count] = s->words.count;
}

/* The first place from `at` on, at most `ahead` words further, with the words from `word` on; fewer of them
 * near the end. SIZE_MAX: none. */
static size_t find(const struct spoken *s, size_t word, const struct text_words *text, size_t at,
                   size_t ahead) {
    size_t left = s->words.count - word, count = left < SEQUENCE ? left : SEQUENCE;
    const struct text_words until = {.list = text->list,
                                     .count = text->count - at > ahead ? at + ahead : text->count};
    return text_words_find(&until, s->words.list + word, count, at);
}

/* Follows the clip's words in the text from `at`, tolerating words that either lacks. Returns where they end.
 */
static size_t follow(const struct spoken *s, size_t from, size_t to, const struct text_words *text,
                     size_t at) {
    enum { NEAR = 4 };
    while (from < to && at < text->count) {
        size_t best = SIZE_MAX, skip = 0;
        for (size_t apart = 0; apart <= NEAR && best == SIZE_MAX; apart++)
            for (size_t i = 0; i <= apart && best == SIZE_MAX; i++)
                if (from + i < to && at + apart - i < text->count &&
                    s->words.list[from + i].hash == text->list[at + apart - i].hash) {
                    best = apart - i;
                    skip = i;
                }
        if (best == SIZE_MAX)
            break;
        from += skip + 1;
        at += best + 1;
    }
    return at;
}

/* True when a sentence ends between two bytes of the text. */
static bool ends_sentence(const char *text, size_t from, size_t to) {
    for (size_t i = from; i < to; i++)
        if (strchr(".!?\n", text[i]) || !strncmp(text + i, "\xE2\x80\xA6", 3))
            return true;
    return false;
}

static struct clip_slice *add_slice(struct clip_slices *s, size_t *cap, struct clip_slice slice) {
    s->list = mem_grow(s->list, cap, s->count + 1, sizeof *s->list);
    if (s->count)
        s->list[s->count - 1].to = slice.from;
    s->list[s->count] = slice;
    return &s->list[s->count++];
}

/* Returns the end, in bytes, of the text between the words first and last, which no clip reads. Returns
 * `from` if it has hardly a word or ends no sentence. */
static size_t end_of_gap(const char *text, size_t size, const struct text_words *words, size_t first,
                         size_t last, size_t from) {
    enum { FEW = 3 };
    size_t to = last < words->count ? words->list[last].from : size;
    return last - first >= FEW && (!from || ends_sentence(text, from, to)) ? to : from;
}

static void divide(struct clip_slices *s, const char *text, size_t size, const struct text_words *words,
                   uint32_t rate) {
    size_t cap = 0, done = 0, byte = 0; /* words, bytes */
    bool loose = false;                 /* the text that follows may be in the clips that were not found */
    for (size_t i = 0; i < s->clip_count; i++) {
        const struct clip_bounds *c = &s->clips[i];
        struct clip_slice *last = s->count ? &s->list[s->count - 1] : NULL;
        size_t from = words->list[c->first].from;
        if (!loose && end_of_gap(text, size, words, done, c->first, byte) > byte) {
            add_slice(s, &cap,
                      (struct clip_slice){.from = byte ? words->list[done].from : 0,
                                          .begin = c->from,
                                          .end = c->from,
                                          .first = i,
                                          .last = i});
            last = NULL;
        }
        if (!last ||
            (last->end - last->begin >= (uint64_t)SLICE_SECONDS * rate && ends_sentence(text, byte, from)))
            last = add_slice(s, &cap,
                             (struct clip_slice){.from = s->count ? from : 0, .begin = c->from, .first = i});
        last->end = c->until;
        last->last = i + 1;
        done = c->last;
        byte = words->list[c->last - 1].to;
        loose = c->until > c->to || c->open;
    }
    if (s->count && !loose && end_of_gap(text, size, words, done, words->count, byte) > byte) {
        uint64_t end = s->list[s->count - 1].end;
        add_slice(s, &cap, (struct clip_slice){.from = words->list[done].from, .begin = end, .end = end});
    }
    if (s->count)
        s->list[s->count - 1].to = size;
}

/* True if the clip has more sound than its words take. */
static bool is_long(const struct sound_clip *clip, size_t words, uint32_t rate) {
    enum { WORD_SECONDS = 1, MORE_SECONDS = 3 };
    return clip->to - clip->from > (uint64_t)(words * WORD_SECONDS + MORE_SECONDS) * rate;
}

/* True if the clip has words, and sound. */
static bool speaks(const struct spoken *spoken, const struct sound_clip *clips, size_t i) {
    return spoken->begins[i] < spoken->begins[i + 1] && clips[i].to > clips[i].from;
}

/* Finds the clips' words from the word `at` on. Returns the number of clips that have a place, or nothing to
 * say. */
static size_t find_clips(struct clip_slices *s, const struct spoken *spoken, const struct sound_clip *clips,
                         size_t count, const struct text_words *words, size_t at, uint32_t rate) {
    size_t found = 0;
    s->clip_count = 0;
    for (size_t i = 0; i < count; i++) {
        size_t from = spoken->begins[i], to = spoken->begins[i + 1];
        size_t place = speaks(spoken, clips, i) ? find(spoken, from, words, at, LOOK_AHEAD) : SIZE_MAX;
        if (from == to)
            found++; /* nothing to say */
        if (place == SIZE_MAX) {
            if (from < to && s->clip_count)
                s->clips[s->clip_count - 1].until = clips[i].to;
            continue;
        }
        found++;
        at = follow(spoken, from, to, words, place);
        at = at > place ? at : place + 1;
        s->clips[s->clip_count++] =
            (struct clip_bounds){.first = place,
                                 .last = at,
                                 .from = clips[i].from,
                                 .to = clips[i].to,
                                 .until = clips[i].to,
                                 .open = clips[i].open && is_long(&clips[i], to - from, rate)};
    }
    return found;
}

void clip_slices_find(struct clip_slices *s, const struct sound_clip *clips, size_t count, const char *text,
                      size_t size, const struct text_words *words, uint32_t rate) {
    struct spoken spoken = {0};
    size_t found = 0;
    *s = (struct clip_slices){0};
    read_clips(&spoken, clips, count);
    s->clips = mem_alloc((count + 1) * sizeof *s->clips);
    found = find_clips(s, &spoken, clips, count, words, 0, rate);
    for (size_t i = 0, tried = 0; 2 * found < count && i < count && tried < ANCHORS; i++) {
        if (!speaks(&spoken, clips, i))
            continue;
        size_t place = find(&spoken, spoken.begins[i], words, 0, words->count);
        tried++;
        if (place != SIZE_MAX)
            found = find_clips(s, &spoken, clips, count, words, place > LEAD ? place - LEAD : 0, rate);
    }
    if (2 * found >= count)
        divide(s, text, size, words, rate);
    if (!s->count)
        s->clip_count = 0;
    text_words_free(&spoken.words);
    free(spoken.begins);
}

void clip_slices_free(struct clip_slices *s) {
    free(s->clips);
    free(s->list);
    *s = (struct clip_slices){0};
}
