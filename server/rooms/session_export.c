/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/rooms/session_export.h"
#include "server/base/mem.h"
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

struct span {
    double from, to;
    const char *text; /* borrowed */
};

struct tier {
    const char *name;
    bool points;
    struct span *spans;
    size_t count, cap;
};

enum { HEARD, SENTENCES, WORDS, EVENTS, TIERS };

/* Spans of a tier may not overlap: a later one begins where the one before ends. */
static struct span *add(struct tier *tier, double from, double to, const char *text) {
    tier->spans = mem_grow(tier->spans, &tier->cap, tier->count + 1, sizeof *tier->spans);
    if (tier->count && from < tier->spans[tier->count - 1].to)
        from = tier->spans[tier->count - 1].to;
    tier->spans[tier->count] = (struct span){from, to > from ? to : from, text ? text : ""};
    return &tier->spans[tier->count++];
}

static const char *string_of(const json_t *event, const char *name) {
    const char *text = json_string_value(json_object_get(event, name));
    return text ? text : "";
}

static double number_of(const json_t *event, const char *name) {
    return json_number_value(json_object_get(event, name));
}

static bool is(const json_t *event, const char *type) {
    return !strcmp(string_of(event, "type"), type);
}

/* ---- what was heard ---- */

/* The final words of an utterance of a listener. */
static const char *words_of(const json_t *events, size_t from, const char *id) {
    const json_t *event;
    for (size_t i = from; (event = json_array_get(events, i)); i++)
        if (is(event, "heard") && json_is_true(json_object_get(event, "final")) &&
            !strcmp(string_of(event, "id"), id))
            return string_of(event, "text");
    return "?";
}

/* Where the utterance that begins with an event ends. */
static double end_of(const json_t *events, size_t from, const char *id, double seconds) {
    const double begin = number_of(json_array_get(events, from), "time");
    const json_t *event;
    for (size_t i = from; (event = json_array_get(events, i)); i++)
        if (is(event, "hearing") && json_object_get(event, "seconds") && !strcmp(string_of(event, "id"), id))
            return begin + number_of(event, "seconds");
    return seconds;
}

/* ---- what the face said ---- */

/* The clock of the current utterance. */
struct clock {
    double begin, paused;
};

static void cut(struct tier *tier, double at) {
    while (tier->count && tier->spans[tier->count - 1].from >= at)
        tier->count--;
    if (tier->count && tier->spans[tier->count - 1].to > at)
        tier->spans[tier->count - 1].to = at;
}

static void take_speech(struct tier tiers[TIERS], struct clock *clock, const json_t *event) {
    const double time = number_of(event, "time"), at = clock->begin + number_of(event, "at");
    const bool sentence = is(event, "sentence");
    if (is(event, "begin"))
        clock->begin = time;
    else if (is(event, "paused"))
        clock->paused = time;
    else if (is(event, "resumed"))
        clock->begin += time - clock->paused;
    else if (sentence || is(event, "word"))
        add(&tiers[sentence ? SENTENCES : WORDS], at, at + number_of(event, "duration"),
            string_of(event, "text"));
    else if (is(event, "end") && !strcmp(string_of(event, "reason"), "stopped"))
        for (int i = SENTENCES; i <= WORDS; i++)
            cut(&tiers[i], time);
}

/* ---- the grid ---- */

static void write_text(struct buf *out, const char *text) {
    buf_add(out, "\"", 1);
    for (; *text; text++)
        buf_add(out, *text == '"' ? "\"\"" : *text == '\n' ? " " : text, *text == '"' ? 2 : 1);
    buf_add(out, "\"", 1);
}

static void write_interval(struct buf *out, size_t number, const struct span *span) {
    buf_printf(
        out,
        "        intervals [%zu]:\n            xmin = %.3f\n            xmax = %.3f\n            text = ",
        number, span->from, span->to);
    write_text(out, span->text);
    buf_add(out, "\n", 1);
}

/* The intervals cover all the time: what lies between the spans is empty. */
static size_t write_intervals(struct buf *out, const struct tier *tier, double seconds) {
    size_t number = 0;
    double at = 0;
    for (size_t i = 0; i < tier->count; i++) {
        struct span span = tier->spans[i];
        if (span.to > seconds)
            span.to = seconds;
        if (span.to - span.from < 0.0005 || span.from < at)
            continue;
        if (span.from - at >= 0.0005)
            write_interval(out, ++number, &(struct span){at, span.from, ""});
        else
            span.from = at;
        write_interval(out, ++number, &span);
        at = span.to;
    }
    if (seconds - at >= 0.0005 || !number)
        write_interval(out, ++number, &(struct span){at, seconds, ""});
    return number;
}

static size_t write_points(struct buf *out, const struct tier *tier, double seconds) {
    size_t number = 0;
    double before = -1;
    for (size_t i = 0; i < tier->count; i++) {
        const struct span *span = &tier->spans[i];
        const double at = span->from > before ? span->from : before + 0.001; /* times must rise */
        if (at > seconds)
            break;
        buf_printf(out, "        points [%zu]:\n            number = %.3f\n            mark = ", ++number,
                   at);
        write_text(out, span->text);
        buf_add(out, "\n", 1);
        before = at;
    }
    return number;
}

static void write_tier(struct buf *out, size_t number, const struct tier *tier, double seconds) {
    struct buf body = {0};
    size_t count = tier->points ? write_points(&body, tier, seconds) : write_intervals(&body, tier, seconds);
    buf_printf(out,
               "    item [%zu]:\n        class = \"%s\"\n        name = \"%s\"\n        xmin = 0\n"
               "        xmax = %.3f\n        %s: size = %zu\n",
               number, tier->points ? "TextTier" : "IntervalTier", tier->name, seconds,
               tier->points ? "points" : "intervals", count);
    buf_add(out, body.data, body.size);
    buf_free(&body);
}

static bool is_point(const json_t *event) {
    static const char *const types[] = {"choices", "chosen",   "state", "expressed",
                                        "consent", "answered", "asked", "mark"};
    for (size_t i = 0; i < sizeof types / sizeof *types; i++)
        if (is(event, types[i]))
            return true;
    return false;
}

/* Text of an event in the files: its text, question, name, state or reason. */
static const char *shown(const json_t *event) {
    static const char *const members[] = {"text", "question", "name", "state", "consent", "reason", "voice"};
    for (size_t i = 0; i < sizeof members / sizeof *members; i++)
        if (*string_of(event, members[i]))
            return string_of(event, members[i]);
    return "";
}

/* "type: text"; kept in `kept`, since tiers borrow. */
static const char *label(const json_t *event, json_t *kept) {
    const char *text = shown(event);
    json_t *whole = json_sprintf("%s%s%s", string_of(event, "type"), *text ? ": " : "", text);
    json_array_append_new(kept, whole);
    return json_string_value(whole);
}

void session_grid(struct buf *out, const json_t *events, double seconds) {
    struct tier tiers[TIERS] = {
        {.name = "heard"}, {.name = "said"}, {.name = "words"}, {.name = "events", .points = true}};
    struct clock clock = {0};
    json_t *kept = json_array();
    const json_t *event;
    for (size_t i = 0; (event = json_array_get(events, i)); i++) {
        const double time = number_of(event, "time");
        const char *id = string_of(event, "id");
        take_speech(tiers, &clock, event);
        if (is_point(event))
            add(&tiers[EVENTS], time, time, label(event, kept));
        else if (is(event, "hearing") && !json_object_get(event, "seconds"))
            add(&tiers[HEARD], time, end_of(events, i, id, seconds), words_of(events, i, id));
    }
    buf_printf(out,
               "File type = \"ooTextFile\"\nObject class = \"TextGrid\"\n\nxmin = 0\nxmax = %.3f\n"
               "tiers? <exists>\nsize = %d\nitem []:\n",
               seconds, (int)TIERS);
    for (int i = 0; i < TIERS; i++) {
        write_tier(out, (size_t)i + 1, &tiers[i], seconds);
        free(tiers[i].spans);
    }
    json_decref(kept);
}

/* ---- the table ---- */

/* Spreadsheets evaluate a cell that begins like this as a formula. */
static void write_cell(struct buf *out, const char *text) {
    buf_add(out, ",\"", 2);
    if (strchr("=+-@\t", *text) && *text)
        buf_add(out, "'", 1);
    for (; *text; text++)
        buf_add(out, *text == '"' ? "\"\"" : text, *text == '"' ? 2 : 1);
    buf_add(out, "\"", 1);
}

void session_table(struct buf *out, const json_t *events) {
    const json_t *event;
    buf_printf(out, "time,type,text,by,id\r\n");
    for (size_t i = 0; (event = json_array_get(events, i)); i++) {
        if (is(event, "heard") && !json_is_true(json_object_get(event, "final")))
            continue; /* a preview */
        buf_printf(out, "%.3f", number_of(event, "time"));
        write_cell(out, string_of(event, "type"));
        write_cell(out, shown(event));
        write_cell(out, string_of(event, "by"));
        write_cell(out, string_of(event, "id"));
        buf_printf(out, "\r\n");
    }
}
