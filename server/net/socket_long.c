/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Long messages of a WebSocket client: their JSON is read, and freed, in another thread. What the client says
 * meanwhile waits: messages are acted on in their order. */
#include "server/base/mem.h"
#include "server/net/socket_internal.h"
#include "server/net/surrogates.h"
#include <stdlib.h>

struct long_message {
    uv_work_t work;
    struct socket *socket; /* NULL: it is gone */
    long_message_done *done;
    struct buf text;
    json_t *message;
    json_error_t why;
    atomic_bool given_up; /* for the thread: the socket is gone */
};

static void parse(uv_work_t *work) {
    struct long_message *m = work->data;
    struct work_limit limit = work_limit_begin(&m->given_up, 0); /* its bound is the message's size */
    m->message = surrogates_load_until((const char *)m->text.data, m->text.size, &limit, &m->why);
}

static void drop(uv_work_t *work) {
    struct long_message *m = work->data;
    json_decref(m->message);
    buf_free(&m->text);
}

static void after_drop(uv_work_t *work, int status) {
    if (status) /* the other thread never came to it */
        drop(work);
    free(work->data);
}

/* What came meanwhile; in it may be another long one. */
static void go_on(struct socket *s) {
    struct buf unread = s->unread;
    s->unread = (struct buf){0};
    s->reader.held = false;
    size_t taken = websocket_reader_feed(&s->reader, unread.data, unread.size);
    if (taken < unread.size)
        buf_add(&s->unread, unread.data + taken, unread.size - taken);
    buf_free(&unread);
    socket_listen(s);
}

static void after_parse(uv_work_t *work, int status) {
    struct long_message *m = work->data;
    struct socket *s = m->socket;
    uv_loop_t *loop = work->loop;
    if (s) {
        s->reading = NULL;
        if (!status && !s->closing)
            m->done(s, m->message, &m->why, (const char *)m->text.data, m->text.size);
        go_on(s);
    }
    if (uv_queue_work(loop, &m->work, drop, after_drop))
        after_drop(&m->work, UV_ECANCELED);
}

void socket_read_long(struct socket *s, struct buf *message, long_message_done *done) {
    struct long_message *m = mem_alloc(sizeof *m);
    m->socket = s;
    m->done = done;
    m->text = *message;
    m->work.data = m;
    *message = (struct buf){0};
    s->reading = m;
    s->reader.held = true;
    socket_listen(s);
    uv_queue_work(s->net->pipeline->loop, &m->work, parse, after_parse);
}

void socket_forget_long(struct socket *s) {
    if (!s->reading)
        return;
    s->reading->socket = NULL;
    atomic_store(&s->reading->given_up, true);
    uv_cancel((uv_req_t *)&s->reading->work); /* when it runs already, it ends soon */
}
