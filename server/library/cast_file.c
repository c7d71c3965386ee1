/* SPDX-License-Identifier: GPL-3.0-or-later */
/* WORK.cast.json: what an editor decides about a cast. Its schema is protocol/schema/cast.json. */
#include "server/base/json/json_place.h"
#include "server/base/mem.h"
#include "server/library/cast.h"
#include <stdlib.h>
#include <string.h>

enum { TEXT_BYTES = 128 };

static int read_text(const struct json_place *at, char **out) {
    const char *text;
    if (!at->json)
        return 0;
    if (json_place_text(at, &text))
        return -1;
    if (strlen(text) > TEXT_BYTES)
        return json_place_fail(at, "must have at most %d bytes", TEXT_BYTES);
    free(*out);
    *out = mem_strdup(text);
    return 0;
}

static int read_factor(const struct json_place *at, double least, double most, double *out) {
    return at->json ? json_place_real(at, least, most, out) : 0;
}

/* Reads what a person and the narrator may have. */
static int read_manner(const struct json_place *at, struct cast_member *m) {
    const struct json_place voice = json_place_key(at, "voice"), head = json_place_key(at, "head"),
                            affect = json_place_key(at, "affect"), pitch = json_place_key(at, "pitch"),
                            rate = json_place_key(at, "rate");
    return read_text(&voice, &m->voice) || read_text(&head, &m->head) || read_text(&affect, &m->affect) ||
                   read_factor(&pitch, 0.25, 4, &m->pitch) || read_factor(&rate, 0.25, 4, &m->rate)
               ? -1
               : 0;
}

static int read_member(const struct json_place *at, struct cast_member *m) {
    static const char *const known[] = {"name",   "sex",   "age",  "voice", "head",
                                        "affect", "pitch", "rate", NULL};
    static const char *const sexes[] = {"female", "male", NULL};
    static const char *const ages[] = {"child", "adult", "old", NULL};
    size_t choice;
    if (json_place_keys(at, known))
        return -1;
    const struct json_place name = json_place_key(at, "name"), sex = json_place_key(at, "sex"),
                            age = json_place_key(at, "age");
    if (read_text(&name, &m->name))
        return -1;
    if (sex.json && json_place_choice(&sex, sexes, &choice))
        return -1;
    if (sex.json) {
        m->sex = choice ? SEX_MALE : SEX_FEMALE;
        m->sex_from = FROM_FILE;
    }
    if (age.json && json_place_choice(&age, ages, &choice))
        return -1;
    if (age.json)
        m->age = (enum cast_age)(AGE_CHILD + choice);
    return read_manner(at, m);
}

/* A person who does not speak in the work: perhaps the name is misspelt. */
static void note_unknown(struct cast *cast, const char *id) {
    char field[64];
    if (cast->problem_count == CAST_PROBLEMS)
        return;
    snprintf(field, sizeof field, "cast.%.50s", id);
    error_in_field(&cast->problems[cast->problem_count++], ERROR_BAD_CAST, field,
                   "nobody of that id speaks in the work");
}

static int read_root(struct cast *cast, bool check, const struct json_place *root) {
    static const char *const known[] = {"$schema", "narrator", "cast", NULL};
    static const char *const manner[] = {"voice", "head", "affect", "pitch", "rate", NULL};
    const char *id;
    json_t *value;
    if (json_place_keys(root, known))
        return -1;
    const struct json_place narrator = json_place_key(root, "narrator"), list = json_place_key(root, "cast");
    if (narrator.json && (json_place_keys(&narrator, manner) || read_manner(&narrator, &cast->narrator)))
        return -1;
    if (list.json && json_place_object(&list))
        return -1;
    json_object_foreach(list.json, id, value) {
        const struct json_place at = json_place_key(&list, id);
        struct cast_member *m = (struct cast_member *)cast_find(cast, id), spare = {0};
        int result = read_member(&at, m ? m : &spare);
        if (!m) {
            char *const texts[] = {spare.name, spare.voice, spare.head, spare.affect};
            for (size_t i = 0; i < sizeof texts / sizeof *texts; i++)
                free(texts[i]);
            if (!check && !result)
                note_unknown(cast, id);
        }
        if (result)
            return -1;
    }
    return 0;
}

static int read_all(struct cast *cast, bool check, const void *data, size_t size, struct error *e) {
    struct json_place root;
    if (size > CAST_FILE_BYTES)
        return error_set(e, ERROR_BAD_CAST, "a cast may have at most %d bytes", CAST_FILE_BYTES);
    if (json_place_parse(data, size, ERROR_BAD_CAST, &root, e))
        return -1;
    int result = read_root(cast, check, &root);
    json_decref(root.json);
    return result;
}

bool cast_file_is(const char *path) {
    size_t size = strlen(path), ending = strlen(CAST_FILE_ENDING);
    return size > ending && !strcmp(path + size - ending, CAST_FILE_ENDING);
}

int cast_read(struct cast *cast, const void *data, size_t size, struct error *e) {
    return read_all(cast, false, data, size, e);
}

int cast_check(const void *data, size_t size, struct error *e) {
    struct cast none = {0};
    int result = read_all(&none, true, data, size, e);
    cast_free(&none);
    return result;
}
