/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/library/cast.h"
#include "server/base/lang.h"
#include "server/base/mem.h"
#include "server/library/words.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char *const sexes[] = {[SEX_UNKNOWN] = "", [SEX_FEMALE] = "female", [SEX_MALE] = "male"};
static const char *const ages[] = {
    [AGE_UNKNOWN] = "", [AGE_CHILD] = "child", [AGE_ADULT] = "adult", [AGE_OLD] = "old"};
static const char *const sources[] = {[FROM_NOTHING] = "",
                                      [FROM_SOURCE] = "source",
                                      [FROM_DESCRIPTION] = "description",
                                      [FROM_NAME] = "name",
                                      [FROM_FILE] = "file"};

void cast_id_of_name(const char *name, char out[64]) {
    struct word word;
    size_t length = 0;
    for (size_t at = 0; words_next(name, strlen(name), false, &at, &word);) {
        if (length && length + 1 < 60)
            out[length++] = '-';
        for (const char *c = word.folded; *c && length < 60; c++)
            out[length++] = *c;
    }
    while (length && ((out[length - 1] & 0x80) || out[length - 1] == '-') && length >= 59)
        length--; /* perhaps cut inside a character */
    out[length] = '\0';
}

struct cast_member *cast_add(struct cast *cast, const char *id, const char *name) {
    cast->members = mem_resize(cast->members, (cast->count + 1) * sizeof *cast->members);
    struct cast_member *m = &cast->members[cast->count++];
    *m = (struct cast_member){.id = mem_strdup(id), .name = mem_strdup(name)};
    return m;
}

const struct cast_member *cast_find(const struct cast *cast, const char *id) {
    for (size_t i = 0; i < cast->count; i++)
        if (!strcmp(cast->members[i].id, id))
            return &cast->members[i];
    return NULL;
}

static void member_free(struct cast_member *m) {
    char *const texts[] = {m->id, m->name, m->about, m->voice, m->head, m->affect, m->first};
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++)
        free(texts[i]);
}

void cast_free(struct cast *cast) {
    for (size_t i = 0; i < cast->count; i++)
        member_free(&cast->members[i]);
    member_free(&cast->narrator);
    free(cast->members);
    free(cast->file);
    *cast = (struct cast){0};
}

/* ---- what is known of a person ---- */

static void judge(struct cast_member *m, const char *lang) {
    if (m->sex == SEX_UNKNOWN) {
        m->sex = cast_sex_of_words(m->name);
        if (m->sex == SEX_UNKNOWN)
            m->sex = cast_sex_of_words(m->about);
        m->sex_from = m->sex == SEX_UNKNOWN ? FROM_NOTHING : FROM_DESCRIPTION;
    }
    if (m->sex == SEX_UNKNOWN) {
        m->sex = cast_sex_of_name(m->name, lang);
        m->sex_from = m->sex == SEX_UNKNOWN ? FROM_NOTHING : FROM_NAME;
    }
    if (m->age != AGE_UNKNOWN)
        return;
    m->age = cast_age_of_words(m->about);
    if (m->age == AGE_ADULT)
        m->age = cast_age_of_words(m->name);
}

/* ---- voices ---- */

/* Kinds of voices, best first. Recordings read one work each, so they take no parts. */
static int tier_of(const struct cast_voice *v) {
    return !strncmp(v->id, "recording:", 10) ? -1
           : !strcmp(v->quality, "neural")   ? 0
           : !strcmp(v->quality, "formant")  ? 2
                                             : 1;
}

/* 2: that variety; 1: the language; 0: another one. */
static int fit_of(const char *voice, const char *lang) {
    int fit = lang_fit(voice, lang);
    return fit == LANG_SAME ? 2 : fit > 0;
}

struct choosing {
    const struct cast_offer *offer;
    unsigned *uses;        /* of each voice */
    int *fits, best;       /* of each voice; the best fit of all */
    enum person_sex usual; /* of most persons of the work: that of those whose sex is not known */
};

/* The cost of giving a voice once more: a worse kind counts as three who share a better one. */
static double cost_of(const struct choosing *c, size_t i) {
    return c->uses[i] + 3.0 * tier_of(&c->offer->voices[i]);
}

/* The cheapest voice of that sex ("": any); SIZE_MAX: none. */
static size_t cheapest(const struct choosing *c, const char *gender) {
    size_t found = SIZE_MAX;
    for (size_t i = 0; i < c->offer->voice_count; i++) {
        const struct cast_voice *v = &c->offer->voices[i];
        bool fits = c->fits[i] && c->fits[i] == c->best && tier_of(v) >= 0;
        if (fits && (!*gender || !strcmp(v->gender, gender)) &&
            (found == SIZE_MAX || cost_of(c, i) < cost_of(c, found)))
            found = i;
    }
    return found;
}

/* Factors of those who share a voice, in the order in which they come. */
static const double pitches[] = {1, 0.9, 1.1, 0.83, 1.18, 0.95, 1.05, 0.87, 1.14};
static const double rates[] = {1, 1.06, 0.95, 0.92, 1.08, 0.97, 1.03, 1, 0.94};
enum { VARIANTS = sizeof pitches / sizeof *pitches };

static void set_factors(struct cast_member *m, unsigned use, double shift) {
    double pitch = pitches[use % VARIANTS] * shift, rate = rates[use % VARIANTS];
    if (m->age == AGE_OLD) {
        pitch *= 0.94;
        rate *= 0.9;
    } else if (m->age == AGE_CHILD) {
        pitch *= 1.2;
        rate *= 1.04;
    }
    m->pitch = m->pitch ? m->pitch : (int)(pitch * 100 + 0.5) / 100.0;
    m->rate = m->rate ? m->rate : (int)(rate * 100 + 0.5) / 100.0;
}

static void note(struct cast *cast, const struct cast_member *m, const char *what, const char *name) {
    if (cast->problem_count == CAST_PROBLEMS)
        return;
    char field[64];
    if (m->id)
        snprintf(field, sizeof field, "cast.%.40s.%s", m->id, what);
    else
        snprintf(field, sizeof field, "narrator.%s", what);
    error_in_field(&cast->problems[cast->problem_count++], ERROR_BAD_CAST, field,
                   "there is no %s \"%.80s\"; another is used", what, name);
}

/* Keeps a voice of the file if there is one of that id. True: it is kept. */
static bool keep_voice(struct cast *cast, struct cast_member *m, struct choosing *c) {
    if (!m->voice)
        return false;
    for (size_t i = 0; i < c->offer->voice_count; i++)
        if (!strcmp(c->offer->voices[i].id, m->voice)) {
            c->uses[i]++;
            return true;
        }
    note(cast, m, "voice", m->voice);
    free(m->voice);
    m->voice = NULL;
    return false;
}

static void give_voice(struct cast_member *m, struct choosing *c) {
    size_t i = cheapest(c, sexes[m->sex == SEX_UNKNOWN ? c->usual : m->sex]);
    double shift = 1;
    if (i == SIZE_MAX) {
        i = cheapest(c, "");
        if (i != SIZE_MAX && m->sex == SEX_MALE && !strcmp(c->offer->voices[i].gender, "female"))
            shift = 0.72;
        else if (i != SIZE_MAX && m->sex == SEX_FEMALE && !strcmp(c->offer->voices[i].gender, "male"))
            shift = 1.4;
    }
    if (i == SIZE_MAX) {
        set_factors(m, 0, 1);
        return;
    }
    m->voice = mem_strdup(c->offer->voices[i].id);
    set_factors(m, c->uses[i]++, shift);
}

/* ---- heads ---- */

static void give_head(struct cast *cast, struct cast_member *m, const struct cast_offer *o,
                      enum person_sex usual, unsigned *uses) {
    const char *gender = sexes[m->sex == SEX_UNKNOWN ? usual : m->sex];
    size_t found = SIZE_MAX;
    for (size_t i = 0; m->head && i < o->head_count; i++)
        if (!strcmp(o->heads[i].name, m->head)) {
            uses[i]++;
            return;
        }
    if (m->head) {
        note(cast, m, "head", m->head);
        free(m->head);
        m->head = NULL;
    }
    for (int any = 0; any < 2 && found == SIZE_MAX; any++)
        for (size_t i = 0; i < o->head_count; i++) {
            const struct cast_head *head = &o->heads[i];
            bool child = !strcmp(head->age, "child");
            bool fits = any || (child == (m->age == AGE_CHILD) &&
                                (child || !*gender || !strcmp(head->gender, gender)));
            if (fits && (found == SIZE_MAX || uses[i] < uses[found]))
                found = i;
        }
    if (found == SIZE_MAX)
        return;
    m->head = mem_strdup(o->heads[found].name);
    uses[found]++;
}

/* Those who are not named speak with the narrator's voice, higher or lower. */
static bool is_unnamed(const struct cast_member *m) {
    return !strcmp(m->id, "voice-1") || !strcmp(m->id, "voice-2");
}

static void set_second(struct cast_member *m) {
    m->pitch = m->pitch ? m->pitch : m->id[6] == '1' ? 1.14 : 0.86;
    m->rate = m->rate ? m->rate : 1;
}

void cast_choose(struct cast *cast, const char *lang, const struct cast_offer *offer) {
    struct choosing c = {.offer = offer};
    unsigned *heads = mem_alloc((offer->head_count + 1) * sizeof *heads);
    c.uses = mem_alloc((offer->voice_count + 1) * sizeof *c.uses);
    c.fits = mem_alloc((offer->voice_count + 1) * sizeof *c.fits);
    for (size_t i = 0; i < offer->voice_count; i++) {
        c.fits[i] = fit_of(offer->voices[i].lang, lang);
        if (c.fits[i] > c.best && tier_of(&offer->voices[i]) >= 0)
            c.best = c.fits[i];
    }
    keep_voice(cast, &cast->narrator, &c);
    int men = 0;
    for (size_t i = 0; i < cast->count; i++) {
        judge(&cast->members[i], lang);
        men += cast->members[i].sex == SEX_MALE ? 1 : cast->members[i].sex == SEX_FEMALE ? -1 : 0;
    }
    c.usual = men > 0 ? SEX_MALE : men < 0 ? SEX_FEMALE : SEX_UNKNOWN;
    for (size_t i = 0; i < cast->count; i++) {
        struct cast_member *m = &cast->members[i];
        if (keep_voice(cast, m, &c))
            set_factors(m, 0, 1);
        else if (cast->told && is_unnamed(m))
            set_second(m);
        else
            give_voice(m, &c);
        give_head(cast, m, offer, c.usual, heads);
    }
    if (cast->narrator.head)
        give_head(cast, &cast->narrator, offer, SEX_UNKNOWN, heads);
    cast->narrator.pitch = cast->narrator.pitch ? cast->narrator.pitch : 1;
    cast->narrator.rate = cast->narrator.rate ? cast->narrator.rate : 1;
    free(c.uses);
    free(c.fits);
    free(heads);
}

/* ---- as JSON ---- */

static void set_text(json_t *to, const char *name, const char *text) {
    if (text && *text)
        json_object_set_new(to, name, json_string(text));
}

static json_t *member_json(const struct cast_member *m) {
    json_t *out = json_object();
    set_text(out, "id", m->id);
    set_text(out, "name", m->name);
    set_text(out, "about", m->about);
    set_text(out, "sex", sexes[m->sex]);
    set_text(out, "sex_from", sources[m->sex_from]);
    set_text(out, "age", ages[m->age]);
    set_text(out, "voice", m->voice);
    set_text(out, "head", m->head);
    json_object_set_new(out, "pitch", json_real(m->pitch));
    json_object_set_new(out, "rate", json_real(m->rate));
    set_text(out, "affect", m->affect);
    set_text(out, "first", m->first);
    return out;
}

json_t *cast_json(const struct cast *cast) {
    json_t *members = json_array(), *problems = json_array();
    for (size_t i = 0; i < cast->count; i++) {
        json_t *m = member_json(&cast->members[i]);
        json_object_set_new(m, "passages", json_integer((json_int_t)cast->members[i].passages));
        json_object_set_new(m, "characters", json_integer((json_int_t)cast->members[i].characters));
        json_array_append_new(members, m);
    }
    for (size_t i = 0; i < cast->problem_count; i++) {
        const struct error *e = &cast->problems[i];
        json_t *p = json_pack("{ss ss}", "code", error_name(e->code), "message", e->message);
        if (e->place == PLACE_LINE) {
            json_object_set_new(p, "line", json_integer((json_int_t)e->line));
            json_object_set_new(p, "column", json_integer((json_int_t)e->column));
        } else if (e->place == PLACE_FIELD) {
            json_object_set_new(p, "field", json_string(e->field));
        }
        json_array_append_new(problems, p);
    }
    return json_pack("{ss? sb so so so}", "file", cast->file, "told", cast->told, "narrator",
                     member_json(&cast->narrator), "cast", members, "problems", problems);
}
