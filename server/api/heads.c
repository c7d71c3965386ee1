/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "protocol/documents.h"
#include "server/api/api_internal.h"
#include "server/base/log.h"
#include "server/base/mem.h"
#include "server/base/suggest.h"
#include <glob.h>
#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { RANK_LAST = 1000000 };

static void add_part(struct model *m, const char *kind, const char *name, const json_t *value) {
    struct model_part *p = &m->parts[m->part_count++];
    p->kind = mem_strdup(kind);
    p->name = mem_strdup(name);
    p->json = json_dumps(value, JSON_COMPACT | JSON_ENCODE_ANY); /* of any JSON type */
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

static void add_documents(struct heads *heads) {
    for (const struct document *d = documents; d->name; d++) {
        char path[64];
        uint8_t *data = mem_alloc(d->size);
        memcpy(data, d->data, d->size);
        snprintf(path, sizeof path, "/v1/%s", d->name);
        static_files_add_bytes(&heads->files, path, "application/json", data, d->size);
    }
}

/* Adds the poster beside the head's file, under the head's address. */
static const struct static_file *add_poster(struct heads *heads, const char *head, const char *address) {
    char file[4096], path[512];
    snprintf(file, sizeof file, "%.*s.webp", (int)(strlen(head) - strlen(".json")), head);
    snprintf(path, sizeof path, "%s.webp", address);
    return static_files_add(&heads->files, path, "image/webp", file);
}

/* Adds the set of pictures from the folder beside the heads. */
static const struct static_file *add_pictures(struct heads *heads, const char *models, const char *head) {
    char file[4096], path[512];
    snprintf(file, sizeof file, "%s/pictures/%s.json", models, head);
    snprintf(path, sizeof path, "/v1/pictures/%s", head);
    return static_files_add(&heads->files, path, "application/json", file);
}

static int load_head(struct heads *heads, const char *models, const char *file, struct error *e) {
    const char *name = strrchr(file, '/') + 1;
    char path[256];
    snprintf(path, sizeof path, "/v1/models/%.*s", (int)strcspn(name, "."), name);
    struct model model = {.asset = static_files_add(&heads->files, path, "application/json", file)};
    if (!model.asset)
        return error_set(e, ERROR_BAD_MODEL, "%s: cannot be read", file);
    heads->list = mem_grow(heads->list, &heads->cap, heads->count + 1, sizeof model);
    struct model *kept = &heads->list[heads->count++];
    *kept = model;
    if (model_split(kept, strrchr(path, '/') + 1, model.asset->data, model.asset->size, file, e))
        return -1;
    kept->poster = add_poster(heads, file, path);
    kept->pictures = add_pictures(heads, models, kept->name);
    return 0;
}

static int by_rank(const void *a, const void *b) {
    const struct model *one = a, *other = b;
    return one->rank != other->rank ? (one->rank > other->rank) - (one->rank < other->rank)
                                    : strcmp(one->name, other->name);
}

int heads_load(struct heads *heads, const char *web, const char *models, struct error *e) {
    char pattern[4096];
    glob_t found;
    int failed = 0;
    *heads = (struct heads){0};
    add_documents(heads);
    static_files_add_folder(&heads->files, web);
    snprintf(pattern, sizeof pattern, "%s/heads/*.json", models);
    if (!glob(pattern, 0, NULL, &found)) {
        for (size_t i = 0; i < found.gl_pathc && !failed; i++)
            failed = load_head(heads, models, found.gl_pathv[i], e);
        globfree(&found);
        if (!failed && heads->count)
            qsort(heads->list, heads->count, sizeof *heads->list, by_rank);
    }
    if (!static_files_find(&heads->files, "/"))
        log_warn("no page to serve: '%s' contains no index.html", web);
    if (!heads->count)
        log_warn("no head model in '%s/heads'", models);
    if (failed)
        heads_free(heads);
    return failed;
}

void heads_free(struct heads *heads) {
    for (size_t i = 0; i < heads->count; i++)
        model_free(&heads->list[i]);
    free(heads->list);
    static_files_free(&heads->files);
    *heads = (struct heads){0};
}

const struct model *heads_find(const struct heads *heads, const char *name) {
    for (size_t i = 0; i < heads->count; i++)
        if (!strcmp(heads->list[i].name, name))
            return &heads->list[i];
    return NULL;
}

int heads_unknown(const struct heads *heads, const char *name, const char *field, struct error *e) {
    struct suggestions near = suggestions_for(name);
    char text[SUGGESTIONS_TEXT];
    for (size_t i = 0; i < heads->count; i++)
        suggest_name(&near, heads->list[i].name, heads->list[i].name);
    return error_in_field(e, ERROR_UNKNOWN_MODEL, field, "no model '%.80s'%s", near.wanted,
                          suggestions_text(&near, text));
}
