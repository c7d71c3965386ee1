/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Messages that put something beside what is said: choices, the choice, what the assistant is doing,
 * whose face it has, whether the listener consents. */
#include "server/net/consent.h"
#include "server/net/notices.h"
#include "server/net/socket_internal.h"

void notice_offer(struct socket *s, const json_t *message) {
    struct error e;
    if (socket_may_direct(s, &e) || notice_choices(s->follower.channel, message, &e))
        socket_complain(s, &e);
}

/* Whoever hears the question may answer it. */
void notice_answer(struct socket *s, const json_t *message) {
    struct error e;
    if (notice_choose(s->follower.channel, message, socket_called(s), &e))
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

/* Nobody consents for another: who looks on cannot answer. */
void notice_consent(struct socket *s, const json_t *message) {
    struct error e;
    bool answer;
    int refused = consent_is_answer(message, &answer, &e);
    if (!refused && !answer)
        refused = socket_may_direct(s, &e);
    if (!refused && answer && s->follower.watches)
        refused = error_set(&e, ERROR_FORBIDDEN, "only who listens can consent");
    if (refused || consent_take(s->follower.channel, message, socket_called(s), &e))
        socket_complain(s, &e);
}
