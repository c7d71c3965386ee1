/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/log.h"
#include "server/base/mem.h"
#include "server/base/program.h"
#include "server/bridges/speechd/speechd_module.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { WAV_HEAD = 44, PIECE = 4410 /* samples sent to the server at a time */ };

static void tell_marks(struct reader_module *m, double until) {
    for (; m->marks_told < m->mark_count && m->marks[m->marks_told].time <= until; m->marks_told++)
        reader_mark(m->marks[m->marks_told].name);
}

/* Sends sound up to each mark in turn. */
static void give_sound(struct reader_module *m, size_t least) {
    size_t at = 0;
    if (!m->rate && m->sound.size >= WAV_HEAD) {
        const uint8_t *head = m->sound.data;
        m->rate = head[24] | (unsigned)head[25] << 8 | (unsigned)head[26] << 16;
        at = WAV_HEAD;
        module_begin(m);
    }
    while (m->rate && m->sound.size - at >= 2 * least && m->sound.size - at >= 2) {
        size_t count = (m->sound.size - at) / 2;
        double now = (double)m->samples / m->rate;
        tell_marks(m, now);
        if (m->marks_told < m->mark_count) {
            size_t until = (size_t)((m->marks[m->marks_told].time - now) * m->rate) + 1;
            count = count < until ? count : until;
        }
        count = count < PIECE ? count : PIECE;
        int16_t piece[PIECE];
        memcpy(piece, m->sound.data + at, 2 * count);
        reader_sound(piece, count, m->rate);
        m->samples += count;
        at += 2 * count;
    }
    buf_consume(&m->sound, at);
}

static void on_sound(void *ctx, const void *bytes, size_t size) {
    struct reader_module *m = ctx;
    buf_add(&m->sound, bytes, size);
    if (!m->rooms)
        give_sound(m, PIECE);
}

/* Sends the rest of the sound once it is complete, and known that no face speaks the text. */
static void conclude(struct reader_module *m) {
    if (m->rooms || !m->ended)
        return;
    give_sound(m, 1);
    tell_marks(m, 1e9);
    module_finish(m, m->ended);
}

static void module_speak_alone(struct reader_module *m);

/* True if the daemon did not speak the text: it is empty, refused, or tried again without its markup. */
static bool was_refused(struct reader_module *m, const struct remote_answer *answer) {
    const char *code = json_string_value(json_object_get(answer->body, "code"));
    if (answer->status == 200)
        return false;
    if (code && !strcmp(code, "empty-text")) /* for example a space */
        m->ended = "702 END";
    else if (module_give_up_markup(m, answer))
        module_speak_alone(m);
    else
        m->ended = "703 STOP", log_warn("not spoken: %s", answer->why);
    conclude(m);
    return true;
}

static void on_sound_end(void *ctx, const struct remote_answer *answer) {
    struct reader_module *m = ctx;
    m->fetch = NULL;
    if (was_refused(m, answer))
        return;
    m->ended = "702 END";
    conclude(m);
}

static void on_marks(void *ctx, const struct remote_answer *answer) {
    struct reader_module *m = ctx;
    struct remote_member members[READER_MEMBERS + 1] = {{0}};
    json_t *one;
    size_t i;
    m->fetch = NULL;
    if (was_refused(m, answer))
        return;
    json_array_foreach(json_object_get(answer->body, "marks"), i, one) {
        const char *name = json_string_value(json_object_get(one, "name"));
        m->marks = mem_grow(m->marks, &m->mark_cap, m->mark_count + 1, sizeof *m->marks);
        m->marks[m->mark_count++] =
            (struct mark){mem_strdup(name ? name : ""), json_number_value(json_object_get(one, "time"))};
    }
    manner_members(&m->manner, members);
    module_ask(m, "/v1/speech", members, on_sound, on_sound_end);
}

/* ---- no viewer in the room: fetches the times of the marks, if there are any, then the sound, and passes
 * both to speech-dispatcher ---- */
static void module_speak_alone(struct reader_module *m) {
    struct remote_member members[READER_MEMBERS + 1] = {{0}};
    manner_members(&m->manner, members);
    size_t last = 0;
    while (members[last].name)
        last++;
    m->rate = 0;
    if (!strstr(m->text, "<mark")) {
        module_ask(m, "/v1/speech", members, on_sound, on_sound_end);
        return;
    }
    members[last] = (struct remote_member){"format", "json"};
    module_ask(m, "/v1/speech", members, NULL, on_marks);
}

/* sd_faccia: an output module of speech-dispatcher. A room's face speaks what a screen reader reads, so
 * that its lips can be read; if nobody is watching, only the sound goes to speech-dispatcher. */

static void say_in_room(struct reader_module *m);

static void on_said(void *ctx, const struct remote_answer *answer) {
    struct reader_module *m = ctx;
    const char *code = json_string_value(json_object_get(answer->body, "code"));
    m->fetch = NULL;
    if (code && !strcmp(code, "empty-text")) {
        module_finish(m, "702 END");
        return;
    }
    if (module_give_up_markup(m, answer)) {
        say_in_room(m);
        return;
    }
    if (answer->status == 202 && !json_integer_value(json_object_get(answer->body, "listeners")) &&
        !json_object_get(answer->body, "held")) { /* the last viewer has just left */
        m->face = false;
        module_speak_alone(m);
        return;
    }
    if (answer->status == 202)
        return; /* the room's events tell the rest */
    log_warn("not spoken: %s", answer->why);
    module_finish(m, "703 STOP");
}

static void on_rooms(void *ctx, const struct remote_answer *answer) {
    struct reader_module *m = ctx;
    json_t *one;
    size_t i;
    m->rooms = NULL;
    m->face = false;
    json_array_foreach(json_object_get(answer->body, "rooms"), i, one) {
        const char *name = json_string_value(json_object_get(one, "name"));
        m->face |= name && !strcmp(name, m->room) && json_integer_value(json_object_get(one, "listeners"));
    }
    if (m->face) {
        module_drop_sound(m);
        say_in_room(m);
    } else if (m->early) {
        give_sound(m, PIECE);
        conclude(m);
    } else {
        module_speak_alone(m);
    }
    m->watched = m->face;
}

static void say_in_room(struct reader_module *m) {
    struct remote_member members[READER_MEMBERS + 3] = {{0}};
    size_t last = 0;
    manner_members(&m->manner, members);
    while (members[last].name)
        last++;
    members[last] = (struct remote_member){"room", m->room};
    members[last + 1] = (struct remote_member){"id", m->id};
    module_ask(m, "/v1/say", members, NULL, on_said);
}

static bool speak(void *ctx, enum reader_kind kind, const char *text) {
    struct reader_module *m = ctx;
    if (m->text)
        return false;
    m->text = manner_text(&m->manner, kind, text);
    m->begun = m->plain = m->face = false;
    m->samples = m->marks_told = 0;
    daemon_address_make_id(m->id, sizeof m->id);
    m->ended = NULL;
    reader_say("200 OK SPEAKING");
    m->rooms = remote_fetch(m->remote, "/v1/rooms", NULL, NULL, NULL, NULL, on_rooms, m);
    /* Most likely nobody watches still. After a message that was cut short this one may be, too: then the
     * daemon gets no work before that is certain. */
    m->early = !m->watched && !m->hurried;
    m->hurried = false;
    if (m->early)
        module_speak_alone(m);
    return true;
}

static void on_stopped(void *ctx, const struct remote_answer *answer) {
    (void)ctx;
    (void)answer;
}

static void cut(struct reader_module *m, const char *event) {
    const struct remote_member members[] = {{"room", m->room}, {NULL, NULL}};
    if (m->text && m->face)
        remote_ask(m->remote, "/v1/stop", members, "text/plain", "", on_stopped, m);
    m->hurried |= m->text != NULL;
    module_finish(m, event);
}

static void stop(void *ctx) {
    cut(ctx, "703 STOP");
}

/* After a pause, speech-dispatcher continues from the last mark. */
static void halt(void *ctx) {
    cut(ctx, "704 PAUSE");
}

static bool set(void *ctx, const char *name, const char *value) {
    struct reader_module *m = ctx;
    return manner_set(&m->manner, name, value);
}

static void quit(void *ctx) {
    struct reader_module *m = ctx;
    module_finish(m, "703 STOP");
    reader_say("210 OK QUIT");
    uv_stop(&m->loop);
}

static const char *text_of(const json_t *object, const char *name) {
    const char *text = json_string_value(json_object_get(object, name));
    return text ? text : "";
}

static void on_voices(void *ctx, const struct remote_answer *answer) {
    json_t *one, *voices = json_object_get(answer->body, "voices");
    size_t i;
    (void)ctx;
    json_array_foreach(voices, i, one) reader_list(200, text_of(one, "id"), text_of(one, "lang"), "none");
    reader_say("%s", json_array_size(voices) ? "200 OK VOICE LIST SENT" : "304 CANT LIST VOICES");
}

static void list_voices(void *ctx) {
    struct reader_module *m = ctx;
    remote_ask(m->remote, "/v1/voices", NULL, NULL, NULL, on_voices, m);
}

static void on_event(void *ctx, const char *type, const json_t *message) {
    struct reader_module *m = ctx;
    const char *id = json_string_value(json_object_get(message, "id"));
    const char *name = json_string_value(json_object_get(message, "name"));
    const char *reason = json_string_value(json_object_get(message, "reason"));
    const char *code = json_string_value(json_object_get(message, "code"));
    if (!id || !m->text || strcmp(id, m->id))
        return;
    if (!strcmp(type, "begin"))
        module_begin(m);
    else if (!strcmp(type, "mark") && name)
        reader_mark(name);
    else if (!strcmp(type, "error") && !m->begun) {
        log_warn("the face did not speak it: %s", code ? code : type);
        if (m->fetch) /* the room's event came before the answer */
            remote_give_up(m->fetch);
        *m->id = '\0'; /* the room's end is not the message's */
        m->face = false;
        module_speak_alone(m);
    } else if (!strcmp(type, "end"))
        module_finish(m, reason && !strcmp(reason, "done") ? "702 END" : "703 STOP");
}

static void on_following(void *ctx, const char *why) {
    struct reader_module *m = ctx;
    if (why && m->text && m->face)
        module_finish(m, "703 STOP");
}

static void on_alloc(uv_handle_t *handle, size_t wanted, uv_buf_t *buf) {
    struct reader_module *m = handle->data;
    (void)wanted;
    *buf = uv_buf_init(m->bytes, sizeof m->bytes);
}

static void on_input(uv_stream_t *stream, ssize_t count, const uv_buf_t *buf) {
    struct reader_module *m = stream->data;
    if (count < 0)
        uv_stop(&m->loop);
    else
        reader_take(&m->protocol, buf->base, (size_t)count);
}

/* "FacciaRoom reader": a line of the module's configuration file. */
static int read_config(struct reader_module *m, const char *file) {
    char line[4096], name[64], value[4000];
    FILE *f = fopen(file, "r");
    int failed = 0;
    while (f && !failed && fgets(line, sizeof line, f)) {
        if (*line == '#' || sscanf(line, "%63s \"%3999[^\"]\"", name, value) +
                                    sscanf(line, "%63s %3999[^\"\n]", name, value) <
                                3)
            continue;
        if (!strcmp(name, "FacciaUrl"))
            free(m->url), m->place.url = m->url = mem_strdup(value);
        else if (!strcmp(name, "FacciaRoom"))
            free(m->room), m->room = mem_strdup(value);
        else if (!strcmp(name, "FacciaTokenFile"))
            failed = daemon_address_read_token(&m->place, value);
    }
    if (f)
        fclose(f);
    return failed;
}

/* A regular file as standard input cannot be polled. */
static bool is_started_by_hand(void) {
    uv_handle_type input = uv_guess_handle(0);
    return input != UV_NAMED_PIPE && input != UV_TTY;
}

int main(int argc, char **argv) {
    static const struct remote_events events = {on_event, on_following};
    static struct reader_module m;
    program_begin();
    if (is_started_by_hand()) {
        fputs("sd_faccia is started by speech-dispatcher: see protocol/speech-dispatcher.md\n", stderr);
        return 2;
    }
    m.protocol = (struct reader_protocol){.calls = {speak, stop, halt, list_voices, set, quit}, .ctx = &m};
    m.room = mem_strdup("reader");
    daemon_address_open(&m.place);
    int failed = argc > 1 && read_config(&m, argv[1]);
    uv_loop_init(&m.loop);
    m.remote = failed ? NULL : remote_new(&m.loop, m.place.url, m.place.token);
    if (m.remote) {
        uv_pipe_init(&m.loop, &m.input, 0);
        m.input.data = &m;
        uv_pipe_open(&m.input, 0);
        uv_read_start((uv_stream_t *)&m.input, on_alloc, on_input);
        remote_follow(m.remote, m.room, &events, &m);
        uv_run(&m.loop, UV_RUN_DEFAULT);
        module_finish(&m, "703 STOP");
        remote_free(m.remote);
        uv_close((uv_handle_t *)&m.input, NULL);
        uv_run(&m.loop, UV_RUN_DEFAULT);
    }
    uv_loop_close(&m.loop);
    reader_free(&m.protocol);
    buf_free(&m.sound);
    free(m.marks);
    free(m.room);
    free(m.url);
    daemon_address_close(&m.place);
    return m.remote ? 0 : 1;
}
