/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/voice/voice_selection.h"
#include "server/base/mem.h"
#include <stdlib.h>

struct voice_selection *voice_selection_new(size_t count) {
    struct voice_selection *selection = mem_alloc(sizeof *selection);
    selection->voices = mem_alloc(count * sizeof *selection->voices);
    selection->sounds = mem_alloc(count * sizeof *selection->sounds);
    selection->count = count;
    return selection;
}

void voice_selection_free(struct voice_selection *selection) {
    if (!selection)
        return;
    for (size_t i = 0; i < selection->count; i++)
        free(selection->sounds[i]);
    free(selection->sounds);
    free(selection->voices);
    free(selection);
}

void voice_selection_append(struct voice_selection *s, struct voice_selection *more) {
    size_t count = s->count + more->count;
    if (count > s->cap) {
        s->cap = 2 * count;
        s->voices = mem_resize(s->voices, s->cap * sizeof *s->voices);
        s->sounds = mem_resize(s->sounds, s->cap * sizeof *s->sounds);
    }
    for (size_t i = 0; i < more->count; i++, s->count++) {
        s->voices[s->count] = more->voices[i];
        s->sounds[s->count] = more->sounds[i];
        more->sounds[i] = NULL;
    }
}

struct cutter {
    const struct voice_selection *selection;
    const struct score *score;
    struct voice_part *parts;
    size_t count, cap;
};

static struct voice_part *add(struct cutter *c, int kind, size_t first, size_t count, size_t instead_of) {
    c->parts = mem_grow(c->parts, &c->cap, c->count + 1, sizeof *c->parts);
    struct voice_part *part = &c->parts[c->count++];
    *part = (struct voice_part){.kind = kind, .first = first, .count = count, .instead_of = instead_of};
    return part;
}

static enum score_kind kind(const struct cutter *c, size_t item) {
    return c->score->items[item].kind;
}

static bool is_sound(const struct cutter *c, size_t item) {
    return kind(c, item) == SCORE_AUDIO && c->selection->sounds[item];
}

static bool is_text(const struct cutter *c, size_t item) {
    return kind(c, item) == SCORE_TEXT && c->score->items[item].text && *c->score->items[item].text;
}

/* Items without a text. */
static void add_silence(struct cutter *c, size_t first, size_t end, size_t instead_of) {
    if (first < end)
        add(c, PART_SILENCE, first, end - first, instead_of);
}

/* s: a pause that is as long or longer is no business of a voice: it is silence that is made here, and costs
 * a worker nothing. A shorter one may lie in a sentence's melody. */
static const double LONG_PAUSE = 1;

/* The pause between the item (not included) and the next text, s. */
static double pause_after(const struct cutter *c, size_t item, size_t end) {
    double seconds = 0;
    for (size_t i = item + 1; i < end && !is_text(c, i); i++)
        if (kind(c, i) == SCORE_BREAK && c->score->items[i].seconds > 0)
            seconds += c->score->items[i].seconds;
    return seconds;
}

/* Items without a playable sound: a part for each voice. Marks go with the text around them; breaks between
 * two voices, and long ones, are silences of their own, so that each has its full length. */
static void cut_texts(struct cutter *c, size_t first, size_t end, size_t instead_of) {
    while (first < end) {
        size_t text = first;
        while (text < end && !is_text(c, text))
            text++;
        if (text == end) {
            add_silence(c, first, end, instead_of);
            return;
        }
        size_t begin = text, last = text;
        while (begin > first && kind(c, begin - 1) != SCORE_BREAK)
            begin--;
        add_silence(c, first, begin, instead_of);
        for (size_t i = text;
             i < end && (!is_text(c, i) || c->selection->voices[i] == c->selection->voices[text]); i++)
            if (is_text(c, i)) {
                last = i;
                if (pause_after(c, i, end) >= LONG_PAUSE)
                    break;
            }
        add(c, PART_TEXT, begin, last + 1 - begin, instead_of);
        first = last + 1;
    }
}

static void cut(struct cutter *c, size_t first, size_t end, size_t instead_of) {
    size_t texts = first;
    for (size_t i = first; i < end; i++) {
        if (!is_sound(c, i))
            continue;
        size_t fallback = c->score->items[i].fallback, after = i + 1;
        after = fallback < end - after ? after + fallback : end;
        cut_texts(c, texts, i, instead_of);
        size_t sound = c->count;
        add(c, PART_SOUND, i, 1, instead_of);
        cut(c, i + 1, after, sound);
        texts = after;
        i = after - 1;
    }
    cut_texts(c, texts, end, instead_of);
}

struct voice_part *voice_selection_parts(const struct voice_selection *selection, const struct score *score,
                                         size_t sentence, size_t *count) {
    const struct score_sentence *s = &score->sentences[sentence];
    struct cutter c = {.selection = selection, .score = score};
    size_t end = s->first + s->count, texts = 0;
    bool simple = true;
    const struct voice *voice = NULL;
    double pause = 0; /* since the last text, s */
    for (size_t i = s->first; i < end && simple; i++) {
        simple = !is_sound(&c, i) && (!is_text(&c, i) || !texts++ || selection->voices[i] == voice);
        voice = is_text(&c, i) ? selection->voices[i] : voice;
        pause = is_text(&c, i) ? 0 : pause + (kind(&c, i) == SCORE_BREAK ? score->items[i].seconds : 0);
        simple = simple && pause < LONG_PAUSE;
    }
    if (simple && (texts || pause <= 0))
        add(&c, PART_TEXT, s->first, s->count, SIZE_MAX);
    else
        cut(&c, s->first, end, SIZE_MAX);
    *count = c.count;
    return c.parts;
}
