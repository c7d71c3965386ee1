/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/api/api_internal.h"
#include "server/base/json/surrogates.h"
#include "server/codec/opus_audio.h"
#include <stdio.h>
#include <string.h>

json_t *message_rooms(const struct api *api, const char *only) {
    json_t *rooms = json_array();
    for (const struct channel *c = rooms_first(api->rooms); c; c = channel_next(c))
        if (!only || !*only || !strcmp(only, channel_name(c)))
            json_array_append_new(rooms, json_pack("{ss si si sb}", "name", channel_name(c), "followers",
                                                   (int)channel_followers(c), "listeners",
                                                   (int)channel_listeners(c), "speaks", channel_speaks(c)));
    return rooms;
}

json_t *message_models(const struct api *api) {
    json_t *models = json_array();
    for (size_t i = 0; i < api->heads.count; i++) {
        const struct model *m = &api->heads.list[i];
        json_t *model = json_pack("{ss ss ss sI ss*}", "name", m->name, "title", m->title, "hash",
                                  m->asset->hash, "bytes", (json_int_t)m->asset->size, "about", m->about);
        if (m->voice)
            json_object_set_new(model, "voice", json_loads(m->voice, 0, NULL));
        if (m->poster)
            json_object_set_new(model, "poster", json_string(m->poster->path + strlen("/v1/")));
        if (m->pictures)
            json_object_set_new(model, "pictures", json_string(m->pictures->path + strlen("/v1/")));
        json_array_append_new(models, model);
    }
    return models;
}

static const struct offer *offer_of(const struct api *api) {
    return api->offer.now(api->offer.ctx);
}

json_t *message_expressions(const struct api *api) {
    const struct offer *offer = offer_of(api);
    json_t *list = json_array();
    for (size_t i = 0; i < offer->expression_count; i++) {
        const struct offer_expression *x = &offer->expressions[i];
        json_array_append_new(list,
                              json_pack("{ss ss sf sf sb}", "kind", x->kind, "name", x->name, "activation",
                                        x->activation, "evaluation", x->evaluation, "basic", x->basic));
    }
    return list;
}

static json_t *affects(const struct offer *offer) {
    json_t *names = json_array();
    for (size_t i = 0; i < offer->expression_count; i++)
        if (!strcmp(offer->expressions[i].kind, "affect"))
            json_array_append_new(names, json_string(offer->expressions[i].name));
    return names;
}

static json_t *strings(const char *const *list) {
    json_t *array = json_array();
    for (; *list; list++)
        json_array_append_new(array, json_string(*list));
    return array;
}

/* The voices that can be used already. */
static const struct offer_voice *voices_of(const struct api *api, size_t *count) {
    const struct offer *offer = offer_of(api);
    *count = api->ready ? offer->voice_count : 0;
    return api->ready ? offer->voices : NULL;
}

json_t *message_voices(const struct api *api) {
    json_t *voices = json_array();
    size_t count;
    const struct offer_voice *v = voices_of(api, &count);
    for (size_t i = 0; i < count; i++)
        json_array_append_new(voices, json_pack("{ss ss ss ss ss ss ss si si}", "id", v[i].id, "name",
                                                v[i].name, "lang", v[i].lang, "gender", v[i].gender,
                                                "quality", v[i].quality, "licence", v[i].licence, "plugin",
                                                v[i].plugin, "rate", (int)v[i].sample_rate,
                                                "words_per_minute", (int)v[i].words_per_minute));
    return voices;
}

json_t *message_health(const struct api *api) {
    const char *status = api->ready ? "ok" : api->unavailable ? "unavailable" : "starting";
    const char *cluster = api->pipeline->metrics->values[METRIC_CLUSTER_UP] > 0 &&
                                  api->pipeline->metrics->values[METRIC_BUS_UP] > 0 &&
                                  api->pipeline->metrics->values[METRIC_PRESENCE_UP] > 0
                              ? "up"
                              : "away";
    return json_pack("{ss ss* ss si ss*}", "status", status, "reason", api->unavailable, "server",
                     "faccia/" FACCIA_VERSION, "connections", (int)http_server_connections(api->http),
                     "cluster", api->options.shares ? cluster : NULL);
}

/* Languages that only have a voice and share the general pack; computed once for each list of voices. */
static json_t *more_languages(struct api *api) {
    size_t count;
    const struct offer_voice *v = voices_of(api, &count);
    if (api->more_languages && api->languages_of == v)
        return json_incref(api->more_languages);
    json_t *tags = json_array();
    json_decref(api->more_languages);
    api->more_languages = tags;
    api->languages_of = v;
    for (size_t i = 0; i < count; i++) {
        bool listed = !v[i].shares;
        for (size_t k = 0; k < i && !listed; k++)
            listed = !strcmp(v[k].lang, v[i].lang);
        if (!listed)
            json_array_append_new(tags, json_string(v[i].lang));
    }
    return json_incref(tags);
}

json_t *message_hello(struct api *api, const char *stream) {
    const struct offer *offer = offer_of(api);
    json_t *languages = json_array();
    for (size_t i = 0; i < offer->language_count; i++)
        json_array_append_new(languages, json_pack("{ss ss so}", "tag", offer->languages[i].tag, "name",
                                                   offer->languages[i].name, "engines",
                                                   strings(offer->languages[i].engines)));
    const struct api_options *o = &api->options;
    json_t *hello = json_pack("{ss si ss ss si s[sss] s[sss] s[ss] si sb sb ss}", "type", "hello", "protocol",
                              1, "server", "faccia/" FACCIA_VERSION, "stream", stream, "fps", 25, "audio",
                              "opus", "pcm_s16le", "none", "fap", "fapc", "plain", "none", "events", "text",
                              "packed", "opus_skip", OPUS_SKIP, "tokens", o->secrets != NULL, "hears",
                              o->hears, "lang", offer->default_lang);
    json_object_set_new(hello, "languages", languages);
    json_object_set_new(hello, "more_languages", more_languages(api));
    json_object_set_new(hello, "engines", strings(offer->engines));
    json_object_set_new(hello, "expressions", affects(offer));
    json_object_set_new(hello, "models", message_models(api));
    json_object_set_new(hello, "limits",
                        json_pack("{si si si si si si si}", "text_bytes", (int)o->text_bytes, "message_bytes",
                                  (int)o->http.message_bytes, "queue", (int)o->rooms.queue, "open",
                                  (int)o->open, "connections", (int)o->http.connections, "rooms",
                                  (int)o->rooms.rooms, "play_bytes", (int)o->play_bytes));
    return hello;
}
