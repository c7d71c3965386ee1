/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/codec/opus_audio.h"
#include "server/net/net_internal.h"
#include "server/net/surrogates.h"
#include <stdio.h>
#include <string.h>

static int append(const char *text, size_t size, void *buf) {
    buf_add(buf, text, size);
    return 0;
}

void message_write(struct buf *out, json_t *object) {
    json_dump_callback(object, append, out, JSON_COMPACT | JSON_REAL_PRECISION(12));
    json_decref(object);
}

static void set_int(json_t *object, const char *name, size_t value) {
    json_object_set_new_nocheck(object, name, json_integer((json_int_t)value));
}

/* Input that is quoted in a message may not be UTF-8, or may have been cut inside a character. */
static json_t *quoted(const char *value) {
    char copy[512];
    json_t *string = json_string(value);
    if (string)
        return string;
    snprintf(copy, sizeof copy, "%s", value);
    for (char *c = copy; *c; c++)
        if ((unsigned char)*c >= 0x80)
            *c = '?';
    return json_string(copy);
}

static void set_string(json_t *object, const char *name, const char *value) {
    if (value)
        json_object_set_new(object, name, quoted(value));
}

static void set_error(json_t *object, const struct error *e) {
    set_string(object, "code", error_name(e->code));
    set_string(object, "message", e->message);
    if (e->place == PLACE_BYTE)
        set_int(object, "byte", e->byte);
    if (e->place == PLACE_FIELD)
        set_string(object, "field", e->field);
    if (e->place == PLACE_LINE) {
        set_int(object, "line", e->line);
        set_int(object, "column", e->column);
    }
}

json_t *message_error(const struct error *e) {
    json_t *object = json_pack("{ss}", "type", "error");
    set_error(object, e);
    return object;
}

json_t *message_rooms(const struct net *net, const char *only) {
    json_t *rooms = json_array();
    for (const struct channel *c = net->rooms; c; c = channel_next(c))
        if (!only || !*only || !strcmp(only, channel_name(c)))
            json_array_append_new(rooms, json_pack("{ss si si sb}", "name", channel_name(c), "followers",
                                                   (int)channel_followers(c), "listeners",
                                                   (int)channel_listeners(c), "speaks", channel_speaks(c)));
    return rooms;
}

json_t *message_models(const struct net *net) {
    json_t *models = json_array();
    for (size_t i = 0; i < net->assets.model_count; i++) {
        const struct model *m = &net->assets.models[i];
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

static const struct offer *offer_of(const struct net *net) {
    return net->offer.now(net->offer.ctx);
}

json_t *message_expressions(const struct net *net) {
    const struct offer *offer = offer_of(net);
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

/* Those that may be asked for already. */
static const struct offer_voice *voices_of(const struct net *net, size_t *count) {
    const struct offer *offer = offer_of(net);
    *count = net->ready ? offer->voice_count : 0;
    return net->ready ? offer->voices : NULL;
}

json_t *message_voices(const struct net *net) {
    json_t *voices = json_array();
    size_t count;
    const struct offer_voice *v = voices_of(net, &count);
    for (size_t i = 0; i < count; i++)
        json_array_append_new(voices, json_pack("{ss ss ss ss ss ss ss si si}", "id", v[i].id, "name",
                                                v[i].name, "lang", v[i].lang, "gender", v[i].gender,
                                                "quality", v[i].quality, "licence", v[i].licence, "plugin",
                                                v[i].plugin, "rate", (int)v[i].sample_rate,
                                                "words_per_minute", (int)v[i].words_per_minute));
    return voices;
}

json_t *message_health(const struct net *net) {
    const char *status = net->ready ? "ok" : net->unavailable ? "unavailable" : "starting";
    const char *cluster = net->pipeline->metrics->values[METRIC_CLUSTER_UP] > 0 &&
                                  net->pipeline->metrics->values[METRIC_BUS_UP] > 0 &&
                                  net->pipeline->metrics->values[METRIC_BOARD_UP] > 0
                              ? "up"
                              : "away";
    return json_pack("{ss ss* ss si ss*}", "status", status, "reason", net->unavailable, "server",
                     "faccia/" FACCIA_VERSION, "connections", (int)net->connections, "cluster",
                     net->options.shares ? cluster : NULL);
}

/* Those that a voice speaks and that share the general pack: found once for each list of voices. */
static json_t *more_languages(struct net *net) {
    size_t count;
    const struct offer_voice *v = voices_of(net, &count);
    if (net->more_languages && net->languages_of == v)
        return json_incref(net->more_languages);
    json_t *tags = json_array();
    json_decref(net->more_languages);
    net->more_languages = tags;
    net->languages_of = v;
    for (size_t i = 0; i < count; i++) {
        bool listed = !v[i].shares;
        for (size_t k = 0; k < i && !listed; k++)
            listed = !strcmp(v[k].lang, v[i].lang);
        if (!listed)
            json_array_append_new(tags, json_string(v[i].lang));
    }
    return json_incref(tags);
}

json_t *message_hello(struct net *net, const char *stream) {
    const struct offer *offer = offer_of(net);
    json_t *languages = json_array();
    for (size_t i = 0; i < offer->language_count; i++)
        json_array_append_new(languages, json_pack("{ss ss so}", "tag", offer->languages[i].tag, "name",
                                                   offer->languages[i].name, "engines",
                                                   strings(offer->languages[i].engines)));
    const struct net_options *o = &net->options;
    json_t *hello =
        json_pack("{ss si ss ss si s[sss] s[sss] s[ss] si sb ss}", "type", "hello", "protocol", 1, "server",
                  "faccia/" FACCIA_VERSION, "stream", stream, "fps", 25, "audio", "opus", "pcm_s16le", "none",
                  "fap", "fapc", "plain", "none", "events", "text", "packed", "opus_skip", OPUS_SKIP,
                  "tokens", o->secrets != NULL, "lang", offer->default_lang);
    json_object_set_new(hello, "languages", languages);
    json_object_set_new(hello, "more_languages", more_languages(net));
    json_object_set_new(hello, "engines", strings(offer->engines));
    json_object_set_new(hello, "expressions", affects(offer));
    json_object_set_new(hello, "models", message_models(net));
    json_object_set_new(hello, "limits",
                        json_pack("{si si si si si si si}", "text_bytes", (int)o->text_bytes, "message_bytes",
                                  (int)o->message_bytes, "queue", (int)o->queue, "open", (int)o->open,
                                  "connections", (int)o->connections, "rooms", (int)o->rooms, "play_bytes",
                                  (int)o->play_bytes));
    return hello;
}

int message_bad_json(const json_error_t *why, struct error *e) {
    /* jansson counts the character that it stumbled over, unless it was the end */
    size_t at = (size_t)why->position;
    if (at && json_error_code(why) != json_error_premature_end_of_input)
        at--;
    return error_at_byte(e, ERROR_BAD_JSON, at, "%s", why->text);
}

struct request_value message_value(const json_t *value) {
    if (json_is_string(value))
        return (struct request_value){REQUEST_STRING, json_string_value(value), json_string_length(value), 0};
    if (json_is_number(value))
        return (struct request_value){REQUEST_NUMBER, NULL, 0, json_number_value(value)};
    if (json_is_boolean(value))
        return (struct request_value){REQUEST_BOOL, NULL, 0, json_is_true(value)};
    return (struct request_value){REQUEST_STRUCTURE, NULL, 0, 0};
}

/* One that is null is as if it were not there. */
static int set_field(struct speech_request *request, const char *name, const json_t *value, struct error *e) {
    return !json_is_null(value) && request_set(request, name, message_value(value), e) < 0 ? -1 : 0;
}

/* The halves of characters in the text; the last one of a text that is being written may get its other half
 * (request->half). */
static void join_halves(struct speech_request *request) {
    struct buf joined = {0};
    uint16_t half = 0;
    if (!request->text)
        return;
    surrogates_join(request->text, request->text_size, &half, &joined);
    if (half && !request->open)
        buf_add(&joined, "\xEF\xBF\xBD", 3); /* U+FFFD */
    request->half = request->open ? half : 0;
    if (joined.size <= request->text_size)
        memcpy(request->text, joined.size ? joined.data : (const uint8_t *)"", joined.size);
    request->text_size = joined.size;
    request->text[joined.size] = '\0';
    buf_free(&joined);
}

int request_from_json(struct speech_request *request, const json_t *object, struct error *e) {
    const char *name;
    const json_t *id = json_object_get(object, "id");
    if (id && set_field(request, "id", id, e)) /* first, so that what is refused has it */
        return -1;
    for (size_t i = 0; (name = request_field(i)); i++) {
        const json_t *value = json_object_get(object, name);
        if (value && set_field(request, name, value, e))
            return -1;
    }
    join_halves(request);
    return 0;
}

json_t *request_to_json(const struct speech_request *request) {
    json_t *object = json_object();
    struct request_value v;
    for (size_t i = 0; request_field(i); i++) {
        if (!request_get(request, i, &v))
            continue;
        json_t *value = v.type == REQUEST_STRING   ? json_stringn(v.string, v.size)
                        : v.type == REQUEST_NUMBER ? json_real(v.number)
                                                   : json_boolean(v.number != 0);
        if (!value) {
            json_decref(object);
            return NULL;
        }
        json_object_set_new(object, request_field(i), value);
    }
    return object;
}

int request_from_query(struct speech_request *request, const struct http_request *from, const char *except,
                       struct error *e) {
    for (size_t i = 0; i < from->member_count; i++) {
        const struct http_member *m = &from->members[i];
        const struct request_value value = {REQUEST_WORD, m->value, m->size, 0};
        if ((except && !strcmp(m->name, except)) || !strcmp(m->name, "text"))
            continue;
        if (request_set(request, m->name, value, e) < 0)
            return -1;
    }
    return 0;
}
