/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/mem.h"
#include "server/base/utf8.h"
#include "server/library/directions.h"
#include "server/library/publish/publish_internal.h"
#include "server/synthesis/media_segment.h"
#include "server/voice/sentence_audio.h"
#include <stdlib.h>
#include <string.h>

/* ---- a text joined from blocks, and where each of its places lies in them ---- */

/* Zeroed: empty. */
struct narration_places {
    const struct block **blocks;
    size_t *numbers, *starts; /* of the section; start bytes in the text */
    size_t count, cap, numbers_cap, starts_cap;
    struct buf joined;
    const char *text; /* the complete text, NUL-terminated */
    struct cast_speech *speeches;
    size_t speech_count, speech_cap;
    struct cast_speech *dialogue; /* of prose */
    size_t dialogue_count, dialogue_cap;
    size_t speech;                     /* the next one of the part */
    struct buf languages;              /* stretches in other languages, in the syntax of a request */
    struct utf16_counter units;        /* units of the text */
    struct utf16_counter speech_units; /* the same, for speeches */
    struct utf16_counter source;       /* of a block in markup */
    size_t at, at_units;               /* position in its text: byte, and UTF-16 units before it */
};

/* ---- sample rates: voices of several languages may differ, a work has one rate ---- */

/* The next higher rate of MPEG audio (ISO 11172-3, 13818-3), at most NARRATION_RATE_MAX. */
static uint32_t narration_rate(uint32_t rate) {
    static const uint32_t rates[] = {16000, 22050, 24000, 32000, 44100, NARRATION_RATE_MAX};
    for (size_t i = 0; i < sizeof rates / sizeof *rates; i++)
        if (rate <= rates[i])
            return rates[i];
    return NARRATION_RATE_MAX;
}

static void *copy(const void *list, size_t count, size_t size) {
    void *made = mem_alloc((count + 1) * size);
    if (count)
        memcpy(made, list, count * size);
    return made;
}

/* Copies the audio without cues, warnings and marks, which are not needed any more. */
static struct sentence_audio *duplicate(const struct sentence_audio *u) {
    struct sentence_audio *d = mem_alloc(sizeof *d);
    d->sample_rate = u->sample_rate;
    d->samples = u->samples;
    d->pcm = u->pcm ? copy(u->pcm, u->samples, sizeof *u->pcm) : mem_alloc((u->samples + 1) * sizeof *u->pcm);
    d->phones = copy(u->phones, u->phone_count, sizeof *u->phones);
    d->phone_count = u->phone_count;
    d->words = copy(u->words, u->word_count, sizeof *u->words);
    d->word_count = u->word_count;
    for (size_t i = 0; i < d->word_count; i++)
        d->words[i].text = NULL;
    memcpy(d->lang, u->lang, sizeof d->lang);
    d->mixed = u->mixed;
    d->from = u->from;
    d->to = u->to;
    return d;
}

/* Converts the segment to that rate. Its audio is shared, so a conversion replaces it by a copy. */
static void narration_convert(struct media_segment *segment, uint32_t rate) {
    if (segment->audio->sample_rate == rate)
        return;
    struct sentence_audio *converted = duplicate(segment->audio);
    sentence_audio_resample(converted, rate);
    sentence_audio_free(segment->audio);
    segment->audio = converted;
}

static void add_language(struct narration_places *p, const struct block *block, const struct block_mark *m) {
    size_t start = p->joined.size - block->text.size;
    if (m->kind != MARK_FOREIGN || !m->value || m->start >= m->end || m->end > block->text.size)
        return;
    size_t from = utf16_offset(&p->units, (char *)p->joined.data, start + m->start);
    buf_printf(&p->languages, "%s%zu-%zu:%s", p->languages.size ? " " : "", from,
               utf16_offset(&p->units, (char *)p->joined.data, start + m->end), m->value);
}

static void add_speech(struct narration_places *p, const struct block *block, const char *affect) {
    char who[CAST_ID_BYTES];
    if (block->source || !cast_id_of_block(block, who))
        return;
    size_t start = utf16_offset(&p->speech_units, (char *)p->joined.data, p->joined.size - block->text.size);
    size_t end = utf16_offset(&p->speech_units, (char *)p->joined.data, p->joined.size);
    p->speeches = mem_grow(p->speeches, &p->speech_cap, p->speech_count + 1, sizeof *p->speeches);
    p->speeches[p->speech_count++] =
        (struct cast_speech){start, end, mem_strdup(who), affect ? mem_strdup(affect) : NULL};
}

/* Adds the dialogue of the block, which is the last one. */
static void narration_places_dialogue(struct narration_places *p, const struct narration_part *part) {
    const size_t number = p->numbers[p->count - 1], start = p->starts[p->count - 1];
    while (p->speech < part->speech_count && part->speeches[p->speech].block < number)
        p->speech++;
    for (; p->speech < part->speech_count && part->speeches[p->speech].block == number; p->speech++) {
        const struct cast_stretch *s = &part->speeches[p->speech];
        size_t from = utf16_offset(&p->speech_units, (char *)p->joined.data, start + s->from);
        size_t to = utf16_offset(&p->speech_units, (char *)p->joined.data, start + s->to);
        p->dialogue = mem_grow(p->dialogue, &p->dialogue_cap, p->dialogue_count + 1, sizeof *p->dialogue);
        p->dialogue[p->dialogue_count++] = (struct cast_speech){from, to, mem_strdup(s->who), NULL};
    }
}

/* An empty line separates blocks. A block with its own source stands alone. */
static void narration_places_add(struct narration_places *p, const struct block *block, size_t number,
                                 const char *affect) {
    if (p->count)
        buf_add(&p->joined, "\n\n", 2);
    p->blocks = mem_grow(p->blocks, &p->cap, p->count + 1, sizeof *p->blocks);
    p->numbers = mem_grow(p->numbers, &p->numbers_cap, p->count + 1, sizeof *p->numbers);
    p->starts = mem_grow(p->starts, &p->starts_cap, p->count + 1, sizeof *p->starts);
    p->blocks[p->count] = block;
    p->numbers[p->count] = number;
    p->starts[p->count++] = p->joined.size;
    if (block->source)
        buf_add(&p->joined, block->source, strlen(block->source));
    else
        block_spoken(block, &p->joined);
    for (size_t i = 0; i < block->mark_count && !block->source; i++)
        add_language(p, block, &block->marks[i]);
    add_speech(p, block, affect);
}

static void narration_places_end(struct narration_places *p) {
    buf_add(&p->joined, "", 1);
    p->text = (const char *)p->joined.data;
}

static void narration_places_free(struct narration_places *p) {
    free(p->blocks);
    free(p->numbers);
    free(p->starts);
    cast_speeches_free(p->speeches, p->speech_count);
    cast_speeches_free(p->dialogue, p->dialogue_count);
    buf_free(&p->joined);
    buf_free(&p->languages);
    *p = (struct narration_places){0};
}

/* Index of the block that contains the byte of the text. */
static size_t block_at(const struct narration_places *p, size_t byte) {
    size_t low = 0, high = p->count;
    while (high - low > 1) {
        size_t middle = (low + high) / 2;
        if (p->starts[middle] <= byte)
            low = middle;
        else
            high = middle;
    }
    return low;
}

/* A block in markup shows a space for each unit of its tags, so source and text agree in UTF-16 units.
 * Fast for ascending places. */
static size_t shown_at(struct narration_places *p, size_t byte) {
    const struct buf *text = &p->blocks[0]->text;
    size_t units = utf16_offset(&p->source, p->text, byte);
    if (units < p->at_units)
        p->at = p->at_units = 0;
    while (p->at_units < units && p->at < text->size) {
        uint32_t cp;
        size_t n = utf8_next((const char *)text->data + p->at, text->size - p->at, &cp);
        p->at += n ? n : 1;
        p->at_units += n == 4 ? 2 : 1;
    }
    return p->at;
}

static size_t place(struct narration_places *p, size_t block, size_t byte) {
    size_t size = p->blocks[block]->text.size;
    size_t at = p->blocks[block]->source ? shown_at(p, byte) : byte - p->starts[block];
    return at < size ? at : size;
}

/* Joins a unit that overlaps the previous one: "1998" is one word here, and several words for the voice. */
static void add(struct narration_part *part, size_t block, size_t from, size_t to, uint64_t start) {
    const struct narration_unit *last = part->count ? &part->units[part->count - 1] : NULL;
    if (to <= from || (last && last->block == block && from < last->to) || (last && block < last->block))
        return;
    if (last && start < last->start)
        start = last->start;
    part->units = mem_grow(part->units, &part->cap, part->count + 1, sizeof *part->units);
    part->units[part->count++] = (struct narration_unit){block, from, to, start};
}

/* End of the line of verse that contains the byte; SIZE_MAX: no lines. */
static size_t line_end(const struct block *b, size_t byte) {
    for (size_t i = 0; i < b->line_count; i++)
        if (byte < b->lines[i].end)
            return b->lines[i].end;
    return SIZE_MAX;
}

/* Adds the units of a sentence that begins at that sample of the section. */
static void narration_units_add(struct narration_places *p, struct narration_part *part,
                                const struct sentence_audio *audio, uint64_t start, bool sentences) {
    size_t until = 0, unit_from = 0, unit_to = 0, unit_block = SIZE_MAX;
    uint64_t unit_start = 0;
    for (size_t i = 0; i < audio->word_count; i++) {
        const struct word *w = &audio->words[i];
        size_t block = block_at(p, w->from);
        size_t from = place(p, block, w->from), to = place(p, block, w->to);
        if (!sentences) {
            add(part, p->numbers[block], from, to, start + w->start);
            continue;
        }
        if (block != unit_block || from >= until) {
            if (unit_block != SIZE_MAX)
                add(part, p->numbers[unit_block], unit_from, unit_to, unit_start);
            unit_block = block;
            unit_from = from;
            unit_start = start + w->start;
            until = line_end(p->blocks[block], from);
        }
        unit_to = to;
    }
    if (sentences && unit_block != SIZE_MAX) {
        size_t end = audio->to > p->starts[unit_block] ? place(p, unit_block, audio->to) : 0;
        unit_to = end > unit_to && end <= until ? end : unit_to; /* include its full stop */
        add(part, p->numbers[unit_block], unit_from, unit_to, unit_start);
    }
}

static bool is_spoken(const struct block *b) {
    return b->text.size && (b->kind == BLOCK_HEAD || b->kind == BLOCK_PARAGRAPH || b->kind == BLOCK_VERSE);
}

/* Blocks that are spoken as one text. */
struct run {
    struct narration *narration;
    struct narration_places places;
    struct narration_part *part;
    struct synthesis *synthesis;
    int64_t before;  /* samples of the work before it */
    uint64_t within; /* samples of the section before it */
    bool finished;
};

static void on_segment(void *ctx, struct media_segment segment) {
    struct run *run = ctx;
    struct narration *r = run->narration;
    if (!r->rate)
        r->rate = narration_rate(segment.audio->sample_rate);
    if (!*r->voice)
        snprintf(r->voice, sizeof r->voice, "%s", synthesis_voice(run->synthesis)->id);
    segment.start = (int64_t)r->samples;
    narration_convert(&segment, r->rate);
    uint64_t start = run->within + r->samples - (uint64_t)run->before;
    narration_units_add(&run->places, run->part, segment.audio, start, r->sentences);
    r->samples += segment.audio->samples;
    if (!r->stopped && r->segment(r->ctx, &segment, run->synthesis))
        r->stopped = true;
    media_segment_free(&segment);
    if (r->stopped)
        run->finished = true;
    else
        synthesis_release(run->synthesis);
}

static void on_problem(void *ctx, const struct error *e, bool warning) {
    struct run *run = ctx;
    if (e->code != ERROR_EMPTY_TEXT) /* a row of asterisks has nothing to speak, which is not an error */
        run->narration->problem(run->narration->ctx, e, warning);
}

static void on_finished(void *ctx, size_t spoken) {
    struct run *run = ctx;
    (void)spoken;
    run->finished = true;
}

static const char *lang_of(const struct narration *r, const struct block *b) {
    return b->lang ? b->lang : r->lang;
}

/* Who speaks the text; NULL: the narrator alone. Free it. */
static char *speakers_of(const struct narration *r, const struct run *run, const char *lang) {
    const struct narration_places *p = &run->places;
    bool voices = r->cast_voices && !strcmp(lang, r->lang);
    if (!r->cast)
        return NULL;
    return p->dialogue_count && voices ? cast_speakers(r->cast, p->dialogue, p->dialogue_count, true)
                                       : cast_speakers(r->cast, p->speeches, p->speech_count, voices);
}

static void request_of(const struct narration *r, const struct run *run, struct speech_request *request) {
    const struct block *b = run->places.blocks[0];
    const char *lang = lang_of(r, b);
    request_copy(request, r->request);
    request->around = r->lexicons;
    free(request->text);
    request->text_size = strlen(run->places.text);
    request->text = mem_strndup(run->places.text, request->text_size);
    free(request->lang);
    request->lang = mem_strdup(lang);
    free(request->languages);
    request->languages = run->places.languages.size && !r->any_lang
                             ? mem_strndup((char *)run->places.languages.data, run->places.languages.size)
                             : NULL;
    request->speakers = speakers_of(r, run, lang);
    free(request->markup);
    request->markup = mem_strdup(b->source ? b->markup : "plain");
    if (!r->any_lang && strcmp(lang, r->lang) != 0) {
        free(request->voice);
        request->voice = NULL;
    }
}

static void speak(struct narration *r, struct run *run) {
    static const struct synthesis_callbacks callbacks = {on_segment, on_problem, on_finished};
    struct speech_request request;
    struct error e;
    narration_places_end(&run->places);
    run->narration = r;
    run->before = (int64_t)r->samples;
    run->within = run->part->samples;
    request_of(r, run, &request);
    run->synthesis = synthesis_open(r->pipeline, &request, &callbacks, run, &e);
    if (run->synthesis) {
        synthesis_start(run->synthesis);
        while (!run->finished && uv_run(r->pipeline->loop, UV_RUN_ONCE))
            ;
        synthesis_free(run->synthesis);
    } else {
        on_problem(run, &e, false);
    }
    run->part->samples += r->samples - (uint64_t)run->before;
    request_free(&request);
}

/* Tells whether both blocks can be spoken as one text: same language, no markup. */
static bool goes_on(const struct narration *r, const struct block *a, const struct block *b) {
    return !a->source && !b->source && !strcmp(lang_of(r, a), lang_of(r, b));
}

void narration_find_speeches(const struct narration *r, const struct section *section,
                             struct narration_part *part) {
    char who[CAST_ID_BYTES];
    bool told = r->request->dialogue == DIALOGUE_VOICES;
    for (size_t i = 0; i < section->count; i++)
        told = told && !cast_id_of_block(&section->blocks[i], who);
    if (told)
        cast_dialogue_stretches(section, r->lang, &part->speeches, &part->speech_count);
}

void narration_section(struct narration *r, const struct section *section, struct narration_part *part) {
    struct direction_mood mood = {.lang = r->lang};
    *part = (struct narration_part){0};
    narration_find_speeches(r, section, part);
    for (size_t i = 0; i < section->count && !r->stopped;) {
        struct run run = {.part = part};
        const struct block *first = &section->blocks[i];
        for (; i < section->count; i++) {
            const struct block *b = &section->blocks[i];
            if (is_spoken(b) && run.places.count && !goes_on(r, first, b))
                break;
            direction_mood_follow(&mood, r->directions, b);
            if (is_spoken(b)) {
                first = run.places.count ? first : b;
                narration_places_add(&run.places, b, i, *mood.who ? mood.affect : NULL);
                narration_places_dialogue(&run.places, part);
            }
        }
        if (run.places.count)
            speak(r, &run);
        narration_places_free(&run.places);
    }
}

void narration_part_free(struct narration_part *part) {
    free(part->units);
    cast_stretches_free(part->speeches, part->speech_count);
    *part = (struct narration_part){0};
}
