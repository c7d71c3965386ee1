/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A head model for a WebSocket client, part by part. */
#include "server/base/suggest.h"
#include "server/net/socket_internal.h"
#include <string.h>

static void push_part(struct socket *s) {
    const struct model *m = s->model;
    const struct model_part *part = &m->parts[s->model_part];
    struct buf text = {0};
    message_write(&text, json_pack("{ss ss ss si si ss ss}", "type", "model", "name", m->name, "hash",
                                   m->asset->hash, "index", (int)s->model_part, "count", (int)m->part_count,
                                   "kind", part->kind, "part", part->name));
    text.size--; /* the object goes on */
    buf_printf(&text, ",\"data\":");
    buf_add(&text, part->json, strlen(part->json));
    buf_add(&text, "}", 1);
    if (++s->model_part == m->part_count) /* before it is said: the next one may follow at once */
        s->more = NULL;
    socket_say_text(s, &text);
    buf_free(&text);
}

void socket_send_model(struct socket *s, const json_t *message) {
    const json_t *wanted = json_object_get(message, "name");
    const char *name = json_string_value(wanted);
    const struct assets *assets = &s->net->assets;
    struct error e;
    if (wanted && !name) {
        error_in_field(&e, ERROR_BAD_FIELD, "name", "must be a string");
        socket_complain(s, &e);
        return;
    }
    s->model = name ? assets_model(assets, name) : assets->model_count ? &assets->models[0] : NULL;
    s->model_part = 0;
    s->more = s->model ? push_part : NULL;
    if (s->model) {
        push_part(s);
    } else {
        struct suggestions near = suggestions_for(name ? name : "");
        char text[SUGGESTIONS_TEXT];
        for (size_t i = 0; i < assets->model_count; i++)
            suggest_name(&near, assets->models[i].name, assets->models[i].name);
        error_in_field(&e, ERROR_UNKNOWN_MODEL, "name", "no model '%.80s'%s", near.wanted,
                       suggestions_text(&near, text));
        socket_complain(s, &e);
    }
}
