/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Messages that put something beside what is said: choices, the choice, what the assistant is doing,
 * whose face it has. */
#include "server/net/notices.h"
#include "server/net/socket_internal.h"

void notice_offer(struct socket *s, const json_t *message) {
    struct error e;
    if (socket_may_direct(s, &e) || notice_choices(s->follower.channel, message, &e))
        socket_complain(s, &e);
}

/* Whoever hears the question may answer it. */
void notice_answer(struct socket *s, const json_t *message) {
    const char *subject = s->principal.token.subject;
    struct error e;
    if (notice_choose(s->follower.channel, message, *subject ? subject : s->name, &e))
        socket_complain(s, &e);
}

void notice_show(struct socket *s, const json_t *message) {
    struct error e;
    if (socket_may_direct(s, &e) || notice_state(s->follower.channel, message, &e))
        socket_complain(s, &e);
}

void notice_fit(struct socket *s, const json_t *message) {
    struct error e;
    if (socket_may_direct(s, &e) || notice_calibrate(s->follower.channel, message, &e))
        socket_complain(s, &e);
}
