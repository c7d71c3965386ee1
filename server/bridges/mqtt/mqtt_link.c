/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/log.h"
#include "server/base/mem.h"
#include "server/bridges/mqtt/mqtt_bridge.h"
#include <mosquitto.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

enum {
    KEEPALIVE_SECONDS = 30,
    AGAIN_SECONDS = 1,
    AGAIN_MOST_SECONDS = 30,
    WAIT_MOST = 100,
    ARRIVED_MOST = 1000,
    QOS = 1
};

/* Event from the broker's thread to the loop. */
struct arrived {
    struct arrived *next;
    char *topic; /* NULL: connected */
    char *payload;
    size_t size;
    bool retained;
};

struct mqtt_link {
    struct mosquitto *mosquitto;
    struct mqtt_calls calls;
    void *ctx;
    char *will;
    uv_async_t async;
    uv_thread_t thread;
    bool runs;
    atomic_bool ending;
    uv_mutex_t lock; /* protects what follows */
    struct arrived *first, **last;
    unsigned count;
    bool connected, told; /* told: a refusal was reported */
    unsigned waiting;     /* messages published while disconnected */
};

static void push(struct mqtt_link *l, struct arrived *one) {
    uv_mutex_lock(&l->lock);
    *l->last = one;
    l->last = &one->next;
    l->count++;
    uv_mutex_unlock(&l->lock);
    uv_async_send(&l->async);
}

static void on_connect(struct mosquitto *m, void *ctx, int code) {
    struct mqtt_link *l = ctx;
    if (code) {
        log_error("the broker refused it: %s", mosquitto_connack_string(code));
        return;
    }
    mosquitto_publish(m, NULL, l->will, 6, "online", QOS, true);
    uv_mutex_lock(&l->lock);
    l->connected = l->told = true;
    l->waiting = 0;
    uv_mutex_unlock(&l->lock);
    push(l, mem_alloc(sizeof(struct arrived)));
}

static void on_disconnect(struct mosquitto *m, void *ctx, int code) {
    struct mqtt_link *l = ctx;
    (void)m;
    uv_mutex_lock(&l->lock);
    bool was = l->connected, tell = was || !l->told;
    l->connected = false;
    l->told = true;
    uv_mutex_unlock(&l->lock);
    if (code && tell)
        log_warn("the broker %s: %s", was ? "has gone" : "refused the connection", mosquitto_strerror(code));
}

/* The library reports TLS failures only here, at every attempt. */
static void on_log(struct mosquitto *m, void *ctx, int level, const char *text) {
    (void)m;
    (void)ctx;
    if (level == MOSQ_LOG_ERR)
        log_warn("the broker: %s", text);
}

static void on_message(struct mosquitto *m, void *ctx, const struct mosquitto_message *message) {
    struct mqtt_link *l = ctx;
    (void)m;
    uv_mutex_lock(&l->lock);
    bool full = l->count >= ARRIVED_MOST;
    uv_mutex_unlock(&l->lock);
    if (full) {
        log_warn("%s: dropped: too many messages at once", message->topic);
        return;
    }
    struct arrived *one = mem_alloc(sizeof *one);
    *one = (struct arrived){.topic = mem_strdup(message->topic), .retained = message->retain};
    one->size = (size_t)message->payloadlen;
    if (one->size <= MQTT_PAYLOAD_MOST)
        one->payload = mem_alloc(one->size + 1);
    else
        one->size = 0;
    if (one->size)
        memcpy(one->payload, message->payload, one->size);
    push(l, one);
}

static struct arrived *take(struct mqtt_link *l) {
    uv_mutex_lock(&l->lock);
    struct arrived *all = l->first;
    l->first = NULL;
    l->last = &l->first;
    l->count = 0;
    uv_mutex_unlock(&l->lock);
    return all;
}

static void drop(struct arrived *one) {
    free(one->topic);
    free(one->payload);
    free(one);
}

static void on_async(uv_async_t *async) {
    struct mqtt_link *l = async->data;
    for (struct arrived *one = take(l), *next; one; one = next) {
        next = one->next;
        if (one->topic)
            l->calls.message(l->ctx, one->topic, one->payload, one->size, one->retained);
        else
            l->calls.connected(l->ctx);
        drop(one);
    }
}

static void free_link(uv_handle_t *handle) {
    struct mqtt_link *l = handle->data;
    for (struct arrived *one = take(l), *next; one; one = next) {
        next = one->next;
        drop(one);
    }
    uv_mutex_destroy(&l->lock);
    free(l->will);
    free(l);
}

/* The library's own loop gives up after protocol errors and failed TLS, so the thread retries. */
static void in_thread(void *arg) {
    struct mqtt_link *l = arg;
    while (!atomic_load(&l->ending)) {
        mosquitto_loop_forever(l->mosquitto, -1, 1);
        if (atomic_load(&l->ending))
            return;
        uv_sleep(1000 * AGAIN_SECONDS);
        mosquitto_reconnect_async(l->mosquitto);
    }
}

static int set_up(struct mqtt_link *l, const struct mqtt_options *o) {
    struct mosquitto *m = l->mosquitto;
    int code = mosquitto_will_set(m, o->will, 7, "offline", QOS, true);
    if (!code && o->user)
        code = mosquitto_username_pw_set(m, o->user, o->password);
    if (!code && o->ca_file)
        code = mosquitto_tls_set(m, o->ca_file, NULL, NULL, NULL, NULL);
    mosquitto_connect_callback_set(m, on_connect);
    mosquitto_disconnect_callback_set(m, on_disconnect);
    mosquitto_message_callback_set(m, on_message);
    mosquitto_log_callback_set(m, on_log);
    mosquitto_reconnect_delay_set(m, AGAIN_SECONDS, AGAIN_MOST_SECONDS, true);
    if (!code) /* an unavailable broker is retried */
        mosquitto_connect_async(m, o->host, o->port, KEEPALIVE_SECONDS);
    mosquitto_threaded_set(m, true);
    l->runs = !code && !uv_thread_create(&l->thread, in_thread, l);
    return code ? code : l->runs ? MOSQ_ERR_SUCCESS : MOSQ_ERR_NOMEM;
}

struct mqtt_link *mqtt_link_new(uv_loop_t *loop, const struct mqtt_options *options,
                                const struct mqtt_calls *calls, void *ctx) {
    struct mqtt_link *l = mem_alloc(sizeof *l);
    *l = (struct mqtt_link){.calls = *calls, .ctx = ctx, .will = mem_strdup(options->will)};
    l->last = &l->first;
    mosquitto_lib_init();
    uv_mutex_init(&l->lock);
    uv_async_init(loop, &l->async, on_async);
    l->async.data = l;
    l->mosquitto = mosquitto_new(options->client, false, l);
    int code = l->mosquitto ? set_up(l, options) : MOSQ_ERR_INVAL;
    if (!code)
        return l;
    log_error("the broker is unreachable: %s", mosquitto_strerror(code));
    mqtt_link_free(l);
    return NULL;
}

void mqtt_link_free(struct mqtt_link *l) {
    if (!l)
        return;
    if (l->mosquitto) {
        mosquitto_publish(l->mosquitto, NULL, l->will, 7, "offline", QOS, true);
        atomic_store(&l->ending, true);
        mosquitto_disconnect(l->mosquitto);
        if (l->runs)
            uv_thread_join(&l->thread);
        mosquitto_destroy(l->mosquitto);
    }
    mosquitto_lib_cleanup();
    uv_close((uv_handle_t *)&l->async, free_link);
}

void mqtt_subscribe(struct mqtt_link *l, const char *topic) {
    mosquitto_subscribe(l->mosquitto, NULL, topic, QOS);
}

void mqtt_publish(struct mqtt_link *l, const char *topic, const char *payload, bool retained) {
    uv_mutex_lock(&l->lock);
    bool leave_out = !l->connected && (retained || l->waiting++ >= WAIT_MOST);
    uv_mutex_unlock(&l->lock);
    if (!leave_out)
        mosquitto_publish(l->mosquitto, NULL, topic, (int)strlen(payload), payload, QOS, retained);
}
