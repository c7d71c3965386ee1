/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Resolves times of behaviours ("1.5", "s1:tm2", "s1:tm2+0.3", "g1:end-0.2") when all text is in the
 * score, and turns the behaviours into cues. */
#include "server/base/mem.h"
#include "server/markup/languages/bml.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

/* Longest chain of references between behaviours. */
enum { CHAIN = 64 };

static const char sync_kind[] = "sync";

static void add_sync(struct markup_reader *r, const char *name, size_t cue, double clock) {
    struct bml *b = r->bml;
    b->syncs = mem_grow(b->syncs, &b->sync_cap, b->sync_count + 1, sizeof *b->syncs);
    b->syncs[b->sync_count++] =
        (struct bml_sync){b->speech ? b->speech : "", reader_keep(r, name), cue, clock};
}

void bml_point(struct markup_reader *r, size_t at, const char *name) {
    reader_point(r, at, sync_kind, "");
    add_sync(r, name, r->score->cue_count - 1, -1);
}

void bml_begin_point(struct markup_reader *r, struct tag *tag) {
    const char *id = tag_take(tag, "id"), *name = tag_take(tag, "name"), *time = tag_take(tag, "time");
    double seconds;
    name = id ? id : name;
    if (!name || !*name)
        score_warn(r->score, tag->at, ERROR_MISSING_ATTRIBUTE, "a sync point needs an id");
    else if (time && quantity_plain(time, 0, 1e6, &seconds))
        add_sync(r, name, 0, seconds);
    else if (strcmp(tag->frame->element->name, "mark") != 0)
        bml_point(r, tag->at, name);
    else
        reader_mark(r, tag->at, name);
}

static int compare_syncs(const void *a, const void *b) {
    const struct bml_sync *x = a, *y = b;
    int speeches = strcmp(x->speech, y->speech);
    return speeches ? speeches : strcmp(x->name, y->name);
}

/* Part of a reference, NUL-terminated. */
struct name {
    char text[128];
};

static struct name name_of(const char *s, size_t length) {
    struct name name = {""};
    if (length < sizeof name.text)
        memcpy(name.text, s, length);
    return name;
}

static bool find_sync(struct markup_reader *r, const char *speech, const char *name, struct bml_place *out) {
    const struct bml_sync wanted = {.speech = speech, .name = name};
    struct bml *b = r->bml;
    const struct bml_sync *found =
        b->sync_count ? bsearch(&wanted, b->syncs, b->sync_count, sizeof wanted, compare_syncs) : NULL;
    if (!found)
        return false;
    *out = found->clock >= 0 ? (struct bml_place){BML_CLOCK, 0, found->clock}
                             : (struct bml_place){BML_ITEM, r->score->cues[found->cue].first, 0};
    return true;
}

static void resolve(struct markup_reader *r, struct bml_behaviour *behaviour, int chain);

static struct bml_behaviour *find_behaviour(struct bml *b, const char *id) {
    size_t low = 0, high = b->by_id_count;
    while (low < high) {
        size_t middle = (low + high) / 2;
        if (strcmp(b->behaviours[b->by_id[middle]].id, id) < 0)
            low = middle + 1;
        else
            high = middle;
    }
    struct bml_behaviour *found = low < b->by_id_count ? &b->behaviours[b->by_id[low]] : NULL;
    return found && !strcmp(found->id, id) ? found : NULL;
}

/* Finds a sync point of a speech, or the beginning or end of a behaviour. Points in between map to the
 * nearer of the two. */
static bool find_point(struct markup_reader *r, const char *id, const char *sync, int chain,
                       struct bml_place *out) {
    static const char *const late[] = {"end", "relax", "strokeEnd", "stroke_end"},
                             *const early[] = {"start",  "ready",      "strokeStart", "stroke_start",
                                               "stroke", "attackPeak", "attack_peak"};
    struct bml_behaviour *other = find_behaviour(r->bml, id);
    if (find_sync(r, id, sync, out) || (!other && find_sync(r, "", sync, out)))
        return true;
    if (!other || other->is_speech || other->state == BML_BUSY || chain == CHAIN)
        return false;
    resolve(r, other, chain + 1);
    for (size_t i = 0; i < sizeof late / sizeof *late; i++)
        if (!strcasecmp(sync, late[i]))
            *out = other->to;
    for (size_t i = 0; i < sizeof early / sizeof *early; i++)
        if (!strcasecmp(sync, early[i]))
            *out = other->from;
    return out->kind != BML_NOWHERE;
}

static bool find_place(struct markup_reader *r, const char *ref, int chain, struct bml_place *out) {
    const char *colon = strrchr(ref, ':'), *id = ref;
    double seconds;
    *out = (struct bml_place){0};
    while (*id == ' ' || (*id >= '\t' && *id <= '\r'))
        id++;
    if (quantity_seconds(id, 1, &seconds)) {
        *out = (struct bml_place){BML_CLOCK, 0, seconds};
        return seconds >= 0 && seconds < 1e6;
    }
    if (!colon)
        return find_point(r, name_of(id, strcspn(id, " \t\r\n")).text, "start", chain, out);
    for (const char *c = id; c < colon; c++) /* skip the name of the block */
        if (*c == ':')
            id = c + 1;
    struct name behaviour = name_of(id, (size_t)(colon - id));
    const char *sync = colon + 1, *sign = sync + strlen(sync);
    size_t length = strcspn(sync, " \t\r\n");
    if (find_point(r, behaviour.text, name_of(sync, length).text, chain, out))
        return true;
    while (sign > sync && *sign != '+' && *sign != '-')
        sign--;
    if (sign == sync || !quantity_seconds(sign, 1, &seconds))
        return false;
    length = (size_t)(sign - sync) < length ? (size_t)(sign - sync) : length;
    if (!find_point(r, behaviour.text, name_of(sync, length).text, chain, out))
        return false;
    out->seconds += seconds;
    return true;
}

static void resolve(struct markup_reader *r, struct bml_behaviour *b, int chain) {
    struct score *score = r->score;
    if (b->state == BML_DONE)
        return;
    b->state = BML_BUSY;
    if (b->start && !find_place(r, b->start, chain, &b->from)) {
        score_warn(score, b->start_at, ERROR_BAD_VALUE,
                   "start=\"%.60s\" is not a known time: it begins at once", b->start);
        b->start = NULL;
    }
    if (!b->start)
        b->from = (struct bml_place){b->usual > 0 ? BML_CLOCK : BML_ITEM, 0, 0};
    struct bml_place usual = b->from;
    usual.seconds += b->usual;
    if (!(b->usual > 0))
        usual = (struct bml_place){BML_ITEM, score->item_count, 0};
    b->to = usual;
    if (b->end && !find_place(r, b->end, chain, &b->to)) {
        score_warn(score, b->end_at, ERROR_BAD_VALUE, "end=\"%.60s\" is not a known time: it ends as usual",
                   b->end);
        b->to = usual;
    }
    if (b->from.kind == BML_ITEM && b->to.kind == BML_ITEM && b->to.item < b->from.item) {
        score_warn(score, b->end_at, ERROR_BAD_VALUE, "end=\"%.60s\" precedes the start: it ends as usual",
                   b->end);
        b->to = usual;
    }
    /* Greta writes a length in place of the end */
    bool length =
        b->end && b->to.kind == BML_CLOCK && (b->from.kind == BML_ITEM || b->to.seconds <= b->from.seconds);
    if (length) {
        usual = b->from;
        usual.seconds += b->to.seconds;
        b->to = usual;
    }
    if (b->from.kind == BML_CLOCK && b->to.kind == BML_ITEM)
        b->from.kind = BML_ITEM; /* seconds after the beginning of the text */
    b->state = BML_DONE;
}

static void add_cue(struct score *score, const struct bml_behaviour *b, const struct bml_sign *sign) {
    double intensity = b->intensity * sign->intensity;
    if (b->from.kind == BML_CLOCK) {
        struct score_cue *timed = score_add_timed(score, sign->kind, sign->name, b->at, b->from.seconds,
                                                  b->to.seconds - b->from.seconds);
        if (timed)
            timed->intensity = intensity;
        else
            score_warn(score, b->at, ERROR_IGNORED,
                       "more than %d behaviours at absolute times: this one is dropped", SCORE_TIMED);
        return;
    }
    struct score_cue *cue = score_add_cue(score, sign->kind, sign->name, b->at);
    cue->intensity = intensity;
    cue->first = b->from.item;
    cue->last = b->to.item > cue->first ? b->to.item : cue->first;
    if (b->is_boundary) { /* the tone applies to the item before it */
        cue->last = b->from.item;
        cue->first = cue->last ? cue->last - 1 : 0;
        return;
    }
    cue->delay.seconds = b->from.seconds;
    cue->duration.seconds = b->to.seconds - b->from.seconds;
    if (cue->first == cue->last && !(cue->duration.seconds > 0))
        cue->duration.seconds = b->usual > 0 ? b->usual : 1;
}

static void lower(char *to, const char *from, size_t cap) {
    size_t n = 0;
    for (; *from && n < cap - 1; from++)
        to[n++] = *from >= 'A' && *from <= 'Z' ? (char)(*from | 32) : *from;
    to[n] = '\0';
}

static int compare_ids(const void *a, const void *b, void *behaviours) {
    const struct bml_behaviour *all = behaviours;
    size_t x = *(const size_t *)a, y = *(const size_t *)b;
    int ids = strcmp(all[x].id, all[y].id);
    return ids ? ids : (x > y) - (x < y);
}

static void sort_ids(struct bml *b) {
    b->by_id = mem_alloc((b->behaviour_count + 1) * sizeof *b->by_id);
    for (size_t i = 0; i < b->behaviour_count; i++)
        if (*b->behaviours[i].id)
            b->by_id[b->by_id_count++] = i;
    if (b->by_id_count)
        qsort_r(b->by_id, b->by_id_count, sizeof *b->by_id, compare_ids, b->behaviours);
}

/* Removes the placeholder cues of sync points. */
static void drop_syncs(struct score *score) {
    size_t kept = 0;
    for (size_t i = 0; i < score->cue_count; i++)
        if (score->cues[i].kind != sync_kind)
            score->cues[kept++] = score->cues[i];
    score->cue_count = kept;
}

/* A document without speech becomes a silence that lasts until its last behaviour ends. */
static void add_silence(struct markup_reader *r) {
    const struct bml *b = r->bml;
    double seconds = 0;
    for (size_t i = 0; i < b->behaviour_count; i++)
        if (b->behaviours[i].sign_count)
            seconds = fmax(seconds, fmax(1, b->behaviours[i].to.seconds));
    if (!(seconds > 0))
        return;
    struct score_item *item = score_add(r->score, SCORE_BREAK, b->behaviours[0].at, b->behaviours[0].at);
    item->seconds = fmin(seconds, READER_SECONDS);
    score_end_sentence(r->score);
}

void bml_finish(struct markup_reader *r) {
    struct bml *b = r->bml;
    if (b->sync_count)
        qsort(b->syncs, b->sync_count, sizeof *b->syncs, compare_syncs);
    sort_ids(b);
    for (size_t i = 0; i < b->behaviour_count; i++)
        if (!b->behaviours[i].is_speech)
            resolve(r, &b->behaviours[i], 0);
    drop_syncs(r->score);
    if (!r->score->item_count)
        add_silence(r);
    for (size_t i = 0; i < b->behaviour_count; i++)
        for (size_t k = 0; k < b->behaviours[i].sign_count; k++) {
            struct bml_sign sign = b->behaviours[i].signs[k];
            char name[BML_NAME];
            lower(name, sign.name, sizeof name);
            sign.name = name;
            add_cue(r->score, &b->behaviours[i], &sign);
        }
}
