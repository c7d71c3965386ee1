/* SPDX-License-Identifier: GPL-3.0-or-later */
/* NDJSON: writes one line per event and frame, in order of time, as soon as they are known. Events are those
 * of the stream; a frame has its non-zero FAPs, or values of another format. */
#include "server/base/json/error_json.h"
#include "server/base/mem.h"
#include "server/codec/arkit_weights.h"
#include "server/export/export.h"
#include "server/face/high_level.h"
#include <ctype.h>
#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void put(struct export *x, json_t *line) {
    json_write(&x->out, line);
    buf_add(&x->out, "\n", 1);
}

static double seconds(uint64_t samples, uint32_t rate) {
    return rate ? round((double)samples / rate * 1e6) / 1e6 : 0;
}

/* An event or frame of a segment. */
struct item {
    uint64_t sample; /* of the speech */
    enum { SENTENCE, SPEAKER, WORD, PHONE, VISEME, MARK, FRAME } kind;
    size_t index;
};

static int by_time(const void *a, const void *b) {
    const struct item *p = a, *q = b;
    if (p->sample != q->sample)
        return p->sample < q->sample ? -1 : 1;
    if (p->kind != q->kind)
        return p->kind < q->kind ? -1 : 1;
    return p->index < q->index ? -1 : p->index > q->index;
}

static void put_begin(struct export *x, uint32_t rate) {
    json_t *line = json_pack("{ss si sf}", "type", "begin", "rate", (int)rate, "fps", x->fps);
    if (x->source.play) {
        json_object_set_new(line, "play", json_string(x->source.play));
    } else {
        json_object_set_new(line, "voice", json_string(x->source.voice));
        json_object_set_new(line, "lang", json_string(x->source.lang));
        json_object_set_new(line, "engine", json_string(x->source.engine));
        json_object_set_new(line, "markup", json_string(x->source.markup));
    }
    put(x, line);
}

static json_t *span(struct export *x, const char *type, const struct item *item, uint32_t duration,
                    size_t from, size_t to) {
    const char *text = x->source.text;
    size_t utf16_from = utf16_offset(&x->utf16, text, from);
    return json_pack("{ss sf sf sI sI sI sI}", "type", type, "time", seconds(item->sample, x->sample_rate),
                     "duration", seconds(duration, x->sample_rate), "start", (json_int_t)from, "end",
                     (json_int_t)to, "utf16_start", (json_int_t)utf16_from, "utf16_end",
                     (json_int_t)utf16_offset(&x->utf16, text, to));
}

/* Formatted by hand, because frames are most of the output. */
void export_ndjson_faps(struct export *x, const struct fap_frame *frame) {
    const char *comma = "";
    char text[24]; /* of one parameter */
    buf_printf(&x->out, ",\"faps\":{");
    for (int n = 3; n <= FAP_COUNT; n++)
        if (fap_frame_has(frame, n) && frame->value[n]) {
            buf_add(&x->out, text,
                    (size_t)snprintf(text, sizeof text, "%s\"%d\":%d", comma, n, (int)frame->value[n]));
            comma = ",";
        }
    buf_printf(&x->out, "}");
}

static void put_frame(struct export *x, const struct media_segment *segment, uint32_t k) {
    struct fap_frame f;
    json_t *line =
        json_pack("{ss si sf}", "type", "frame", "frame", (int)k, "time", round(k / x->fps * 1e6) / 1e6);
    put(x, line);
    x->out.size -= 2; /* "}\n" */
    export_frame(x, segment, k, &f);
    x->format->member(x, &f);
    buf_printf(&x->out, "}\n");
}

static const struct viseme_key *visemes_of(const struct export *x, const struct media_segment *segment,
                                           size_t *count) {
    *count = 0;
    return x->format->visemes && segment->track ? face_track_visemes(segment->track, count) : NULL;
}

static void put_viseme(struct export *x, const struct viseme_key *key, double time) {
    put(x, json_pack("{ss sf sf ss si ss}", "type", "viseme", "time", time, "duration",
                     round((key->to - key->from) * 1e6) / 1e6, "viseme", export_viseme_names[key->viseme],
                     "id", key->id, "ipa", key->ipa));
}

static void put_item(struct export *x, const struct media_segment *segment, const struct item *item) {
    const struct sentence_audio *u = segment->audio;
    double time = seconds(item->sample, x->sample_rate);
    switch (item->kind) {
    case SENTENCE:
        put(x, span(x, "sentence", item, u->samples, u->from, u->to));
        break;
    case SPEAKER: {
        const struct speaker *who = export_speaker(x, u->from);
        put(x, json_pack("{ss sf ss ss}", "type", "speaker", "time", time, "speaker", who ? who->id : "",
                         "name", who ? who->name : ""));
        break;
    }
    case WORD: {
        const struct word *w = &u->words[item->index];
        json_t *line = span(x, "word", item, w->end - w->start, w->from, w->to);
        json_object_set_new(line, "text", json_stringn(x->source.text + w->from, w->to - w->from));
        put(x, line);
        break;
    }
    case PHONE: {
        const struct phone *p = &u->phones[item->index];
        put(x, json_pack("{ss sf sf ss}", "type", "phone", "time", time, "duration",
                         seconds(p->end - p->start, x->sample_rate), "ipa", p->ipa));
        break;
    }
    case VISEME: {
        size_t count;
        put_viseme(x, &visemes_of(x, segment, &count)[item->index], time);
        break;
    }
    case MARK:
        put(x, json_pack("{ss sf ss}", "type", "mark", "time", time, "name", u->marks[item->index].name));
        break;
    case FRAME:
        put_frame(x, segment, (uint32_t)item->index);
        break;
    }
}

/* Tells whether what begins at that sample belongs to the piece up to `to`. */
static bool is_in(const struct export *x, const struct sentence_audio *u, uint32_t sample, uint32_t to) {
    return sample >= x->at && (sample < to || to == u->samples);
}

/* Collects the events and frames of the piece up to `to`, sorted by time; the caller frees *out. */
static size_t collect(struct export *x, const struct media_segment *segment, uint32_t to, struct item **out) {
    const struct sentence_audio *u = segment->audio;
    uint64_t start = (uint64_t)segment->start;
    uint32_t first = x->frames, end = x->format->member ? export_frames_until(x, segment, to) : first;
    size_t keys;
    const struct viseme_key *key = visemes_of(x, segment, &keys);
    size_t count = 0, most = 2 + u->word_count + u->phone_count + keys + u->mark_count + (end - first);
    struct item *items = mem_alloc(most * sizeof *items);
    if (!x->source.play && !x->at)
        items[count++] = (struct item){start, SENTENCE, 0};
    if (x->source.speech && !x->at)
        items[count++] = (struct item){start, SPEAKER, 0};
    for (size_t i = 0; i < u->word_count; i++)
        if (is_in(x, u, u->words[i].start, to))
            items[count++] = (struct item){start + u->words[i].start, WORD, i};
    for (size_t i = 0; i < keys; i++)
        if (key[i].to > key[i].from && is_in(x, u, (uint32_t)lround(key[i].from * u->sample_rate), to))
            items[count++] = (struct item){start + (uint64_t)lround(key[i].from * u->sample_rate), VISEME, i};
    for (size_t i = 0; i < u->phone_count && !x->format->visemes; i++)
        if (is_in(x, u, u->phones[i].start, to))
            items[count++] = (struct item){start + u->phones[i].start, PHONE, i};
    for (size_t i = 0; i < u->mark_count; i++)
        if (is_in(x, u, u->marks[i].at, to))
            items[count++] = (struct item){start + u->marks[i].at, MARK, i};
    for (; x->frames < end; x->frames++)
        items[count++] = (struct item){(uint64_t)(x->frames / x->fps * u->sample_rate), FRAME, x->frames};
    qsort(items, count, sizeof *items, by_time);
    *out = items;
    return count;
}

void export_ndjson_piece(struct export *x, const struct media_segment *segment, uint32_t to) {
    struct item *items;
    if (!x->segments && !x->at)
        put_begin(x, segment->audio->sample_rate);
    size_t count = collect(x, segment, to, &items);
    for (size_t i = 0; i < count; i++)
        put_item(x, segment, &items[i]);
    free(items);
}

/* Speech marks of Amazon Polly: one JSON line each, times in ms, places in bytes. */

/* Polly's symbol for a viseme: by its phone, as in the table for en-US in Polly's documentation, or by the
 * viseme of FAP 1, which every phone of every language has. */
static const char *polly_viseme(const struct viseme_key *key) {
    static const struct {
        const char *ipa, *symbol;
    } phones[] = {{"tʃ", "S"}, {"dʒ", "S"}, {"p", "p"}, {"b", "p"}, {"m", "p"}, {"d", "t"}, {"t", "t"},
                  {"l", "t"},  {"n", "t"},  {"ʃ", "S"}, {"ʒ", "S"}, {"ð", "T"}, {"θ", "T"}, {"f", "f"},
                  {"v", "f"},  {"k", "k"},  {"ɡ", "k"}, {"g", "k"}, {"ŋ", "k"}, {"h", "k"}, {"i", "i"},
                  {"ɪ", "i"},  {"j", "i"},  {"ɹ", "r"}, {"r", "r"}, {"s", "s"}, {"z", "s"}, {"u", "u"},
                  {"ʊ", "u"},  {"w", "u"},  {"ə", "@"}, {"ɚ", "@"}, {"a", "a"}, {"æ", "a"}, {"ɑ", "a"},
                  {"e", "e"},  {"ɛ", "E"},  {"ɜ", "E"}, {"ɝ", "E"}, {"ʌ", "E"}, {"o", "o"}, {"ɔ", "O"},
                  {"ɒ", "O"}};
    static const char *const groups[] = {"sil", "p", "f", "T", "t", "k", "S", "s",
                                         "t",   "r", "a", "e", "i", "o", "u"};
    for (size_t i = 0; *key->ipa && i < sizeof phones / sizeof *phones; i++)
        if (!strncmp(key->ipa, phones[i].ipa, strlen(phones[i].ipa)))
            return phones[i].symbol;
    return groups[key->viseme < sizeof groups / sizeof *groups ? key->viseme : 0];
}

static void put_mark(struct export *x, const struct media_segment *segment, const struct item *item) {
    const struct sentence_audio *u = segment->audio;
    json_int_t time = (json_int_t)round((double)item->sample * 1000 / x->sample_rate);
    size_t from = u->from, to = u->to, count;
    switch (item->kind) {
    case WORD:
        from = u->words[item->index].from;
        to = u->words[item->index].to;
        /* fall through */
    case SENTENCE:
        put(x, json_pack("{sI ss sI sI so}", "time", time, "type", item->kind == WORD ? "word" : "sentence",
                         "start", (json_int_t)from, "end", (json_int_t)to, "value",
                         json_stringn(x->source.text + from, to - from)));
        break;
    case VISEME:
        put(x, json_pack("{sI ss ss}", "time", time, "type", "viseme", "value",
                         polly_viseme(&visemes_of(x, segment, &count)[item->index])));
        break;
    case MARK:
        put(x, json_pack("{sI ss ss}", "time", time, "type", "ssml", "value", u->marks[item->index].name));
        break;
    default:
        break;
    }
}

void export_marks_piece(struct export *x, const struct media_segment *segment, uint32_t to) {
    struct item *items;
    size_t count = collect(x, segment, to, &items);
    for (size_t i = 0; i < count; i++)
        put_mark(x, segment, &items[i]);
    free(items);
}

void export_marks_end(struct export *x) {
    if (x->segments)
        put(x, json_pack("{sI ss ss}", "time", (json_int_t)round((double)x->samples * 1000 / x->sample_rate),
                         "type", "viseme", "value", "sil"));
}

void export_ndjson_end(struct export *x) {
    put(x, json_pack("{ss ss sf}", "type", "end", "reason", x->segments ? "done" : "failed", "duration",
                     seconds(x->samples, x->sample_rate)));
}

void export_ndjson_warning(struct export *x, const struct error *e) {
    char text[400];
    put(x, json_pack("{ss ss ss}", "type", "warning", "code", error_name(e->code), "message",
                     error_text(e, text, sizeof text)));
}

/* Curves for other engines: ARKit's 52 shapes as Live Link Face columns or NDJSON members, and visemes as
 * NDJSON members. */

/* Smaller weights count as 0: about a hundredth of a millimetre. */
#define WEIGHT_LEAST 0.00005

enum { TURNS = 9, WHOLE = 63 /* FAP 1: weight of its first viseme */ };

const char *const export_viseme_names[] = {"sil", "PP", "FF", "TH", "DD", "kk", "CH", "SS",
                                           "nn",  "RR", "aa", "E",  "I",  "O",  "U"};
enum { VISEMES = sizeof export_viseme_names / sizeof *export_viseme_names };

static struct arkit_solver *solver_of(struct export *x) {
    if (!x->coder)
        x->coder = arkit_solver_new();
    return x->coder;
}

void export_arkit_free(struct export *x) {
    arkit_solver_free(x->coder);
    x->coder = NULL;
}

static void put_header(struct export *x) {
    static const char *const turns[TURNS] = {"HeadYaw",     "HeadPitch",     "HeadRoll",
                                             "LeftEyeYaw",  "LeftEyePitch",  "LeftEyeRoll",
                                             "RightEyeYaw", "RightEyePitch", "RightEyeRoll"};
    buf_printf(&x->out, "Timecode,BlendShapeCount");
    for (int i = 0; i < ARKIT_SHAPES; i++)
        buf_printf(&x->out, ",%c%s", toupper(arkit_table[i].name[0]), arkit_table[i].name + 1);
    for (int i = 0; i < TURNS; i++)
        buf_printf(&x->out, ",%s", turns[i]);
    buf_printf(&x->out, "\r\n");
}

/* Hours, minutes, seconds, frame within the second, thousandths of a frame. */
static void put_time(struct export *x, uint32_t k) {
    double second = floor(k / x->fps + 1e-9), at = fmax(0, k - second * x->fps);
    unsigned whole = (unsigned)second, thousandths = (unsigned)lround(at * 1000);
    buf_printf(&x->out, "%02u:%02u:%02u:%02u.%03u", whole / 3600, whole / 60 % 60, whole % 60,
               thousandths / 1000, thousandths % 1000);
}

/* As in takes of Live Link Face: radians, positive to the right, down, and towards the left shoulder; the
 * columns of an eye belong to the eye whose shapes have the other name (protocol/arkit.md). */
static void put_turns(struct export *x, const struct fap_frame *frame) {
    struct arkit_turns t = arkit_turns_of(frame);
    const double turns[TURNS] = {t.head_yaw,    -t.head_pitch,  -t.head_roll,
                                 -t.eye_yaw[1], t.eye_pitch[1], 0,
                                 -t.eye_yaw[0], t.eye_pitch[0], 0};
    for (int i = 0; i < TURNS; i++)
        buf_printf(&x->out, ",%.6f", turns[i] + 0.0);
}

static void put_row(struct export *x, const struct fap_frame *frame, uint32_t k) {
    double weights[ARKIT_SHAPES];
    arkit_weights(solver_of(x), frame, weights);
    put_time(x, k);
    buf_printf(&x->out, ",%d", ARKIT_SHAPES + TURNS);
    for (int i = 0; i < ARKIT_SHAPES; i++)
        buf_printf(&x->out, ",%.6f", weights[i]);
    put_turns(x, frame);
    buf_printf(&x->out, "\r\n");
}

void export_arkit_piece(struct export *x, const struct media_segment *segment, uint32_t to) {
    uint32_t end = export_frames_until(x, segment, to);
    if (!x->segments && !x->at)
        put_header(x);
    for (; x->frames < end; x->frames++) {
        struct fap_frame frame;
        export_frame(x, segment, x->frames, &frame);
        put_row(x, &frame, x->frames);
    }
}

void export_arkit_end(struct export *x) {
    (void)x;
}

static void put_weight(struct export *x, const char **comma, const char *name, double weight) {
    char text[64];
    if (weight < WEIGHT_LEAST)
        return;
    buf_add(&x->out, text, (size_t)snprintf(text, sizeof text, "%s\"%s\":%.5g", *comma, name, weight));
    *comma = ",";
}

void export_arkit_weights(struct export *x, const struct fap_frame *frame) {
    struct arkit_turns t = arkit_turns_of(frame);
    const char *comma = "";
    double weights[ARKIT_SHAPES];
    arkit_weights(solver_of(x), frame, weights);
    buf_printf(&x->out, ",\"arkit\":{");
    for (int i = 0; i < ARKIT_SHAPES; i++)
        put_weight(x, &comma, arkit_table[i].name, weights[i]);
    buf_printf(&x->out, "},\"head\":[%.5g,%.5g,%.5g]", t.head_yaw, t.head_pitch, t.head_roll);
}

void export_viseme_weights(struct export *x, const struct fap_frame *frame) {
    double weights[VISEMES] = {0};
    const struct fap_viseme *v = &frame->viseme;
    const char *comma = "";
    if (fap_frame_has(frame, 1)) {
        weights[v->select1 < VISEMES ? v->select1 : 0] += fmin(v->blend, WHOLE) / WHOLE;
        weights[v->select2 < VISEMES ? v->select2 : 0] += 1 - fmin(v->blend, WHOLE) / WHOLE;
    } else {
        weights[0] = 1;
    }
    buf_printf(&x->out, ",\"visemes\":{");
    for (int i = 0; i < VISEMES; i++)
        put_weight(x, &comma, export_viseme_names[i], weights[i]);
    buf_printf(&x->out, "}");
}
