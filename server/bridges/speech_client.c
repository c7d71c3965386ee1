/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/bridges/speech_client.h"
#include "server/base/buf.h"
#include "server/base/log.h"
#include "server/base/mem.h"
#include "server/bridges/remote_internal.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* Texts kept for a possible retry. */
enum { KEPT = 16 };

struct said_text {
    char id[48]; /* "": none */
    struct fetch *fetch;
    struct remote_member *members;
    char *type, *other;
    struct buf text;
    bool writes;  /* still being written */
    bool refused; /* to be retried when it is complete */
};

struct speech_client {
    struct remote *remote;
    char *room;
    struct follow *follow;
    unsigned long count;
    struct said_text kept[KEPT];
};

static char *copy(const char *text) {
    return text ? mem_strdup(text) : NULL;
}

static void forget(struct said_text *t) {
    remote_free_members(t->members);
    free(t->type);
    free(t->other);
    buf_free(&t->text);
    *t = (struct said_text){0};
}

static struct fetch *ask(struct speech_client *s, struct said_text *t, remote_answered *answered, void *ctx) {
    if (t->writes)
        return remote_begin(s->remote, "/v1/say", t->members, t->type, NULL, answered, ctx);
    buf_add(&t->text, "", 1);
    t->text.size--;
    return remote_ask(s->remote, "/v1/say", t->members, t->type, (char *)t->text.data, answered, ctx);
}

static void on_answered(void *ctx, const struct remote_answer *answer) {
    (void)ctx;
    if (answer->status != 202)
        log_warn("the room did not speak it: %s", answer->why);
}

static void say_again(struct speech_client *s, struct said_text *t) {
    t->refused = false;
    t->fetch = NULL;
    remote_drop_member(t->members, "open"); /* it is complete now */
    ask(s, t, on_answered, NULL);
}

static const char *member(const json_t *message, const char *name) {
    const char *text = json_string_value(json_object_get(message, name));
    return text ? text : "";
}

static void on_event(void *ctx, const char *type, const json_t *message) {
    struct speech_client *s = ctx;
    const char *id = member(message, "id");
    struct said_text *t = s->kept;
    if (strcmp(type, "error") != 0 || !*id)
        return;
    while (t < s->kept + KEPT && strcmp(t->id, id) != 0)
        t++;
    if (t == s->kept + KEPT)
        return;
    bool again = remote_leave_out(t->members, member(message, "code"), member(message, "field"), t->other);
    log_warn("%s: %s", member(message, "message"),
             again ? "it is spoken without" : "the room did not speak it");
    if (again && t->writes)
        t->refused = true;
    else if (again)
        say_again(s, t);
}

static void on_following(void *ctx, const char *why) {
    (void)ctx, (void)why; /* it retries by itself */
}

struct speech_client *speech_client_new(struct remote *remote, const char *room) {
    static const struct remote_events events = {on_event, on_following};
    struct speech_client *s = mem_alloc(sizeof *s);
    s->remote = remote;
    s->room = mem_strdup(room);
    s->follow = remote_follow(remote, room, &events, s);
    return s;
}

void speech_client_free(struct speech_client *s) {
    if (!s)
        return;
    remote_unfollow(s->follow);
    for (unsigned i = 0; i < KEPT; i++)
        forget(&s->kept[i]);
    free(s->room);
    free(s);
}

struct fetch *speech_client_say(struct speech_client *s, const struct speech_text *text,
                                remote_answered *answered, void *ctx) {
    struct said_text *t = &s->kept[s->count % KEPT];
    forget(t);
    *t = (struct said_text){.type = copy(text->type), .other = copy(text->other), .writes = !text->text};
    snprintf(t->id, sizeof t->id, "door-%ld-%lu", (long)getpid(), s->count++);
    const struct remote_member members[] = {{"room", s->room},
                                            {"id", t->id},
                                            {"voice", text->voice},
                                            {"lang", text->lang},
                                            {"markup", text->markup},
                                            {"priority", text->priority},
                                            {"open", t->writes ? "1" : NULL},
                                            {NULL, NULL}};
    t->members = remote_copy_members(members);
    if (text->text)
        buf_add(&t->text, text->text, strlen(text->text));
    struct fetch *fetch = ask(s, t, answered, ctx);
    for (unsigned i = 0; i < KEPT; i++) /* an earlier request in the same slot */
        if (s->kept[i].fetch == fetch)
            s->kept[i].fetch = NULL;
    return t->fetch = fetch;
}

static struct said_text *written(struct speech_client *s, const struct fetch *fetch) {
    for (struct said_text *t = s->kept; t < s->kept + KEPT; t++)
        if (t->writes && t->fetch == fetch)
            return t;
    return NULL;
}

void speech_client_write(struct speech_client *s, struct fetch *fetch, const char *text, size_t size) {
    struct said_text *t = written(s, fetch);
    if (t)
        buf_add(&t->text, text, size);
    remote_write(fetch, text, size);
}

void speech_client_close(struct speech_client *s, struct fetch *fetch) {
    struct said_text *t = written(s, fetch);
    remote_close(fetch);
    if (!t)
        return;
    t->writes = false;
    t->fetch = NULL;
    if (t->refused)
        say_again(s, t);
}
