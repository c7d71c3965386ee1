/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/net/models.h"
#include "server/base/mem.h"
#include <jansson.h>
#include <stdlib.h>
#include <string.h>

enum { RANK_LAST = 1000000 };

static void add_part(struct model *m, const char *kind, const char *name, const json_t *value) {
    struct model_part *p = &m->parts[m->part_count++];
    p->kind = mem_strdup(kind);
    p->name = mem_strdup(name);
    p->json = json_dumps(value, JSON_COMPACT | JSON_ENCODE_ANY); /* whatever it is */
}

int model_split(struct model *m, const char *wanted, const void *text, size_t size, const char *file,
                struct error *e) {
    json_error_t why;
    json_t *head = json_loadb(text, size, 0, &why);
    json_t *parts = json_object_get(head, "parts"), *textures = json_object_get(head, "textures");
    const char *format = json_string_value(json_object_get(head, "format"));
    const char *name = json_string_value(json_object_get(head, "name"));
    const char *title = json_string_value(json_object_get(head, "title"));
    if (!head || !format || strcmp(format, "faccia-head") || !name || strcmp(name, wanted) ||
        !json_is_array(parts) || !json_is_object(textures)) {
        json_decref(head);
        return error_set(e, ERROR_BAD_MODEL, "%s: %s", file,
                         head ? "not a faccia-head of that name with parts and textures" : why.text);
    }
    m->name = mem_strdup(name);
    m->title = mem_strdup(title ? title : name);
    const char *about = json_string_value(json_object_get(head, "about"));
    m->about = about ? mem_strdup(about) : NULL;
    const json_t *rank = json_object_get(head, "rank"), *voice = json_object_get(head, "voice");
    m->rank = json_is_number(rank) ? json_number_value(rank) : RANK_LAST;
    m->voice = json_is_object(voice) ? json_dumps(voice, JSON_COMPACT) : NULL;
    m->parts = mem_alloc((1 + json_object_size(textures) + json_array_size(parts)) * sizeof *m->parts);
    json_incref(parts);
    json_incref(textures);
    json_object_del(head, "parts");
    json_object_del(head, "textures");
    add_part(m, "head", name, head);
    const char *key;
    json_t *value;
    json_object_foreach(textures, key, value) add_part(m, "texture", key, value);
    size_t i;
    json_array_foreach(parts, i, value) {
        const char *part = json_string_value(json_object_get(value, "name"));
        add_part(m, "part", part ? part : "", value);
    }
    json_decref(parts);
    json_decref(textures);
    json_decref(head);
    return 0;
}

void model_free(struct model *m) {
    for (size_t i = 0; i < m->part_count; i++) {
        free(m->parts[i].kind);
        free(m->parts[i].name);
        free(m->parts[i].json);
    }
    free(m->parts);
    free(m->name);
    free(m->title);
    free(m->about);
    free(m->voice);
    *m = (struct model){0};
}
