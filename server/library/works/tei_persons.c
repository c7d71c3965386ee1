/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The persons of a TEI document: person and personGrp of the header, and castItem of the cast list. */
#include "server/base/mem.h"
#include "server/base/utf8.h"
#include "server/library/works/readers.h"
#include <stdlib.h>
#include <string.h>

enum { PERSON_TEXT_MAX = 200 }; /* bytes of a name or a description */

static enum person_sex sex_of(const char *text) {
    static const char *const female[] = {"f",        "2",          "w",        "female",   "femmina",
                                         "donna",    "femminile",  "feminino", "feminine", "mulher",
                                         "weiblich", "kad\u0131n", "woman",    NULL};
    static const char *const male[] = {"m",        "1",         "male",      "maschio", "uomo",
                                       "maschile", "masculino", "masculine", "homem",   "m\u00E4nnlich",
                                       "erkek",    "man",       NULL};
    char word[24];
    size_t size = 0;
    text += strspn(text, " \t\r\n");
    for (; size + 1 < sizeof word && text[size] && !strchr(" \t\r\n.,;", text[size]); size++)
        word[size] = text[size] >= 'A' && text[size] <= 'Z' ? (char)(text[size] + 32) : text[size];
    word[size] = '\0';
    return xml_is_one(word, female) ? SEX_FEMALE : xml_is_one(word, male) ? SEX_MALE : SEX_UNKNOWN;
}

static void set_sex(struct work_person *p, const char *text) {
    if (text && p->sex == SEX_UNKNOWN)
        p->sex = sex_of(text);
}

static void set_age(struct work_person *p, const char *text) {
    unsigned long age = text ? strtoul(text, NULL, 10) : 0;
    if (!p->age && age && age < 1000)
        p->age = (unsigned)age;
}

/* Takes the text as a string without needless white space, and empties it. NULL: there is none. */
static char *take_text(struct buf *text) {
    char *out = mem_alloc(text->size + 1), *to = out;
    for (size_t i = 0; i < text->size; i++)
        if (!strchr(" \t\r\n", text->data[i]))
            *to++ = (char)text->data[i];
        else if (to > out && to[-1] != ' ')
            *to++ = ' ';
    while (to > out && strchr(" ,;:", to[-1]))
        to--;
    *to = '\0';
    buf_free(text);
    size_t skip = strspn(out, " ,;:");
    memmove(out, out + skip, strlen(out + skip) + 1);
    utf8_mend(out);
    if (*out)
        return out;
    free(out);
    return NULL;
}

static void set_id(struct work_person *p, const char *id) {
    if (id && *id == '#')
        id++;
    if (id && *id && !p->id)
        p->id = mem_strndup(id, strcspn(id, " \t\r\n"));
}

/* Completes the first of two entries about one person. */
static void merge(struct work_person *to, struct work_person *from) {
    if (!*to->name) {
        char *name = to->name;
        to->name = from->name;
        from->name = name;
    }
    if (!to->about) {
        to->about = from->about;
        from->about = NULL;
    }
    to->sex = to->sex == SEX_UNKNOWN ? from->sex : to->sex;
    to->age = to->age ? to->age : from->age;
}

static void keep_person(struct tei_persons *o) {
    struct work_person *p = &o->now;
    p->name = take_text(&o->name);
    p->about = take_text(&o->about);
    bool full = o->count == PERSONS_MAX;
    if (full || (!p->name && !p->id)) {
        free(p->id);
        free(p->name);
        free(p->about);
    } else {
        p->id = p->id ? p->id : mem_strdup("");
        p->name = p->name ? p->name : mem_strdup("");
        o->list = mem_grow(o->list, &o->cap, o->count + 1, sizeof *o->list);
        o->list[o->count++] = *p;
    }
    o->now = (struct work_person){0};
}

void tei_persons_start(struct tei_persons *o, unsigned depth, const char *name, const char **attributes) {
    static const char *const persons[] = {"person", "personGrp", "castItem", NULL};
    static const char *const names[] = {"persName", "name", "role", NULL};
    static const char *const about[] = {"roleDesc", "occupation", "trait", "state", "note", NULL};
    if (!o->at && (xml_is_one(name, persons) || !strcmp(name, "role")))
        o->at = depth;
    if (!o->at)
        return;
    struct work_person *p = &o->now;
    const bool item = xml_is_one(name, persons) || !strcmp(name, "role");
    o->cast_item = o->cast_item || !strcmp(name, "castItem");
    if (item) {
        set_id(p, xml_attribute(attributes, "id"));
        set_id(p, xml_attribute(attributes, "corresp"));
        set_id(p, xml_attribute(attributes, "sameAs"));
        set_sex(p, xml_attribute(attributes, "sex"));
        set_sex(p, xml_attribute(attributes, "gender"));
        set_age(p, xml_attribute(attributes, "age"));
    }
    if (o->name_at || o->about_at || o->sex_at || o->age_at || o->out_at) {
        struct buf *text = o->name_at ? &o->name : &o->about;
        buf_add(text, " ", text->size ? 1 : 0); /* separates the parts of a name */
    } else if (xml_is_one(name, names) && !o->name.size) {
        o->name_at = depth;
    } else if (xml_is_one(name, about)) {
        o->about_at = depth;
        buf_add(&o->about, " ", o->about.size ? 1 : 0);
    } else if (!strcmp(name, "sex") || !strcmp(name, "gender")) {
        set_sex(p, xml_attribute(attributes, "value"));
        o->sex_at = depth;
    } else if (!strcmp(name, "age")) {
        set_age(p, xml_attribute(attributes, "value"));
        o->age_at = depth;
    } else if (!strcmp(name, "actor") || xml_is_one(name, names)) {
        o->out_at = depth;
    }
}

void tei_persons_text(struct tei_persons *o, const char *text, size_t size) {
    struct buf *to = o->name_at                                             ? &o->name
                     : o->sex_at || o->age_at                               ? &o->word
                     : o->about_at || (o->cast_item && o->at && !o->out_at) ? &o->about
                                                                            : NULL;
    if (to && to->size + size < PERSON_TEXT_MAX)
        buf_add(to, text, size);
}

void tei_persons_end(struct tei_persons *o, unsigned depth) {
    unsigned *const ends[] = {&o->name_at, &o->about_at, &o->out_at};
    for (size_t i = 0; i < sizeof ends / sizeof *ends; i++)
        if (*ends[i] == depth)
            *ends[i] = 0;
    if (o->sex_at == depth || o->age_at == depth) {
        char *word = take_text(&o->word);
        if (o->sex_at == depth)
            set_sex(&o->now, word);
        else
            set_age(&o->now, word);
        free(word);
        o->sex_at = o->age_at = 0;
    }
    if (o->at && o->at == depth) {
        keep_person(o);
        o->at = 0;
        o->cast_item = false;
    }
}

static int by_id(const void *a, const void *b) {
    const struct work_person *x = *(struct work_person *const *)a, *y = *(struct work_person *const *)b;
    int order = strcmp(x->id, y->id);
    return order ? order : (x > y) - (x < y);
}

void tei_persons_done(struct tei_persons *o) {
    size_t kept = 0;
    o->by_id = mem_alloc((o->count + 1) * sizeof(struct work_person *));
    for (size_t i = 0; i < o->count; i++)
        if (*o->list[i].id)
            o->by_id[o->id_count++] = &o->list[i];
    if (o->id_count)
        qsort(o->by_id, o->id_count, sizeof *o->by_id, by_id);
    for (size_t i = 0; i < o->id_count; i++)
        if (kept && !strcmp(o->by_id[kept - 1]->id, o->by_id[i]->id))
            merge(o->by_id[kept - 1], o->by_id[i]);
        else
            o->by_id[kept++] = o->by_id[i];
    o->id_count = kept;
}

const struct work_person *tei_persons_find(const struct tei_persons *o, const char *id) {
    const struct work_person key = {.id = (char *)id}, *sought = &key;
    size_t low = 0, high = o->id_count;
    while (low < high) {
        size_t middle = (low + high) / 2;
        int order = strcmp(o->by_id[middle]->id, sought->id);
        if (!order)
            return o->by_id[middle];
        if (order < 0)
            low = middle + 1;
        else
            high = middle;
    }
    return NULL;
}

void tei_persons_take(struct tei_persons *o, struct work_meta *meta) {
    bool *merged = mem_alloc(o->count + 1);
    for (size_t i = 0; i < o->count; i++)
        merged[i] = *o->list[i].id && tei_persons_find(o, o->list[i].id) != &o->list[i];
    meta->persons = mem_alloc((o->count + 1) * sizeof *meta->persons);
    for (size_t i = 0; i < o->count; i++)
        if (!merged[i]) {
            meta->persons[meta->person_count++] = o->list[i];
            o->list[i] = (struct work_person){0};
        }
    o->id_count = 0;
    free(merged);
}

void tei_persons_free(struct tei_persons *o) {
    work_persons_free(o->list, o->count);
    free(o->by_id);
    free(o->now.id);
    free(o->now.name);
    free(o->now.about);
    buf_free(&o->name);
    buf_free(&o->about);
    buf_free(&o->word);
    *o = (struct tei_persons){0};
}
