/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/log.h"
#include "server/base/mem.h"
#include "server/doors/speechd/reader_module.h"
#include <string.h>

enum { WAV_HEAD = 44, PIECE = 4410 /* samples that go to the server together */ };

static void tell_marks(struct reader_module *m, double until) {
    for (; m->marks_told < m->mark_count && m->marks[m->marks_told].time <= until; m->marks_told++)
        reader_mark(m->marks[m->marks_told].name);
}

/* Sound up to the next mark, and so on. */
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
    give_sound(m, PIECE);
}

static void on_sound_end(void *ctx, const struct remote_answer *answer) {
    struct reader_module *m = ctx;
    m->fetch = NULL;
    if (answer->status != 200) {
        log_warn("it is not spoken: %s", answer->why);
        module_finish(m, "703 STOP");
        return;
    }
    give_sound(m, 1);
    tell_marks(m, 1e9);
    module_finish(m, "702 END");
}

static void on_marks(void *ctx, const struct remote_answer *answer) {
    struct reader_module *m = ctx;
    struct remote_member members[READER_MEMBERS + 1] = {{0}};
    const char *code = json_string_value(json_object_get(answer->body, "code"));
    json_t *one;
    size_t i;
    m->fetch = NULL;
    if (code && !strcmp(code, "empty-text")) { /* a space, say */
        module_finish(m, "702 END");
        return;
    }
    if (module_give_up_markup(m, answer)) {
        module_speak_alone(m);
        return;
    }
    json_array_foreach(json_object_get(answer->body, "marks"), i, one) {
        const char *name = json_string_value(json_object_get(one, "name"));
        m->marks = mem_grow(m->marks, &m->mark_cap, m->mark_count + 1, sizeof *m->marks);
        m->marks[m->mark_count++] =
            (struct mark){mem_strdup(name ? name : ""), json_number_value(json_object_get(one, "time"))};
    }
    manner_members(&m->manner, members);
    module_ask(m, "/v1/speech", members, on_sound, on_sound_end);
}

void module_speak_alone(struct reader_module *m) {
    struct remote_member members[READER_MEMBERS + 1] = {{0}};
    manner_members(&m->manner, members);
    size_t last = 0;
    while (members[last].name)
        last++;
    members[last] = (struct remote_member){"format", "json"};
    m->rate = 0;
    module_ask(m, "/v1/speech", members, NULL, on_marks);
}
