/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/net/scenes.h"
#include "server/net/shelf_http.h"
#include <string.h>

enum { LINES_MOST = 500, VARIANTS_MOST = 20, CHOICES_MOST = 8 };

/* A member of an object, and where that is: "lines.3.choices.0.". */
struct member {
    const json_t *of;
    const char *place, *name;
    struct error *e;
};

static int fail(const struct member *m, const char *what) {
    char field[64];
    snprintf(field, sizeof field, "%s%s", m->place, m->name);
    return error_in_field(m->e, ERROR_BAD_FIELD, field, "%s", what);
}

static bool is_text(const json_t *value) {
    const char *text = json_string_value(value);
    return text && text[strspn(text, " \t\r\n")];
}

/* A text that is not empty; it may be left out, or not. */
static int check_text(const struct member *m, bool needed) {
    const json_t *value = json_object_get(m->of, m->name);
    if (!value && !needed)
        return 0;
    return is_text(value) ? 0 : fail(m, "must be a text that is not empty");
}

static int check_list(const struct member *m, size_t most) {
    const json_t *list = json_object_get(m->of, m->name);
    char what[64];
    snprintf(what, sizeof what, "must be a list of at most %zu", most);
    return !list || (json_is_array(list) && json_array_size(list) <= most) ? 0 : fail(m, what);
}

/* Where a line or an answer leads to. */
static int check_next(const struct member *m, const json_t *ids) {
    const json_t *next = json_object_get(m->of, "next");
    if (check_text(m, false))
        return -1;
    return !next || json_object_get(ids, json_string_value(next)) ? 0
                                                                  : fail(m, "there is no line of that id");
}

static int check_choices(const json_t *choices, const char *line, const json_t *ids, struct error *e) {
    char place[64];
    for (size_t i = 0; i < json_array_size(choices); i++) {
        const json_t *choice = json_array_get(choices, i);
        snprintf(place, sizeof place, "%schoices.%zu.", line, i);
        if (check_text(&(struct member){choice, place, "text", e}, true) ||
            check_next(&(struct member){choice, place, "next", e}, ids))
            return -1;
    }
    return 0;
}

static int check_line(const json_t *line, const char *place, const json_t *ids, struct error *e) {
    struct member variants = {line, place, "variants", e}, mood = {line, place, "mood", e};
    if (check_text(&(struct member){line, place, "text", e}, true) || check_list(&variants, VARIANTS_MOST) ||
        check_list(&(struct member){line, place, "choices", e}, CHOICES_MOST))
        return -1;
    const json_t *list = json_object_get(line, "variants"), *affects = json_object_get(line, "mood");
    for (size_t i = 0; i < json_array_size(list); i++)
        if (!is_text(json_array_get(list, i)))
            return fail(&variants, "must be texts that are not empty");
    if (affects && !json_is_string(affects))
        return fail(&mood, "must be a text");
    return check_next(&(struct member){line, place, "next", e}, ids) ||
                   check_choices(json_object_get(line, "choices"), place, ids, e)
               ? -1
               : 0;
}

/* The ids of all lines, each once, as members of an object. */
static int collect(const json_t *lines, json_t *ids, struct error *e) {
    char place[32];
    for (size_t i = 0; i < json_array_size(lines); i++) {
        struct member id = {json_array_get(lines, i), place, "id", e};
        snprintf(place, sizeof place, "lines.%zu.", i);
        if (check_text(&id, true))
            return -1;
        const char *text = json_string_value(json_object_get(id.of, "id"));
        if (json_object_get(ids, text))
            return fail(&id, "another line has the same");
        json_object_set_new(ids, text, json_true());
    }
    return 0;
}

static int check_lines(const json_t *lines, struct error *e) {
    char place[32];
    json_t *ids = json_object();
    int failed = collect(lines, ids, e);
    for (size_t i = 0; !failed && i < json_array_size(lines); i++) {
        snprintf(place, sizeof place, "lines.%zu.", i);
        failed = check_line(json_array_get(lines, i), place, ids, e);
    }
    json_decref(ids);
    return failed;
}

static int check_scene(const json_t *scene, struct error *e) {
    const json_t *title = json_object_get(scene, "title");
    if (!json_is_object(scene))
        return error_set(e, ERROR_BAD_FIELD, "a scene is an object with 'lines'");
    if (title && !json_is_string(title))
        return fail(&(struct member){scene, "", "title", e}, "must be a text");
    if (!json_object_get(scene, "lines"))
        return error_plain_in_field(e, ERROR_MISSING_FIELD, "lines");
    if (check_list(&(struct member){scene, "", "lines", e}, LINES_MOST))
        return -1;
    return check_lines(json_object_get(scene, "lines"), e);
}

int scene_check(const char *name, const void *data, size_t size, struct error *e) {
    json_error_t why;
    (void)name; /* a scene has none of its own */
    json_t *scene = json_loadb(size ? data : "", size, JSON_REJECT_DUPLICATES, &why);
    int failed = scene ? check_scene(scene, e) : message_bad_json(&why, e);
    json_decref(scene);
    return failed;
}

int scenes_serve(struct exchange *x) {
    static const struct shelf_service scenes = {"/v1/scenes", "scenes", "application/json", scene_check,
                                                NULL};
    const struct net_options *options = &exchange_net(x)->options;
    struct document_store shelf = {options->scenes, ".json", ERROR_UNKNOWN_SCENE, options->scene_bytes,
                                   options->scene_count};
    return shelf_serve(x, &scenes, &shelf, (struct document_store_listener){0});
}
