/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/app/cli_written.h"
#include "server/app/cli.h"
#include <errno.h>
#include <stdint.h>
#include <string.h>
#include <unistd.h>

static void finish(struct cli_written *w) {
    if (w->watches)
        uv_poll_stop(&w->poll);
    synthesis_close(w->synthesis);
}

/* False: there is no more. */
static bool take(struct cli_written *w) {
    char bytes[65536], text[400];
    struct error e;
    ssize_t size = read(STDIN_FILENO, bytes, sizeof bytes);
    if (size < 0 && (errno == EINTR || errno == EAGAIN))
        return true;
    if (size < 0)
        cli_complain("-: %s", strerror(errno));
    bool wrong = size > 0 && synthesis_write(w->synthesis, bytes, (size_t)size, SIZE_MAX, &e);
    if (wrong)
        cli_complain("%s", error_text(&e, text, sizeof text));
    w->failed |= size < 0 || wrong;
    if (size > 0 && !wrong)
        return true;
    finish(w);
    return false;
}

static void on_poll(uv_poll_t *poll, int status, int events) {
    (void)status;
    (void)events;
    take(poll->data);
}

void cli_written_begin(struct cli_written *w, uv_loop_t *loop, struct synthesis *synthesis) {
    w->synthesis = synthesis;
    w->poll.data = w;
    w->watches = !uv_poll_init(loop, &w->poll, STDIN_FILENO);
    if (w->watches && !uv_poll_start(&w->poll, UV_READABLE, on_poll))
        return;
    while (take(w)) /* a file, which cannot be watched, is there as a whole */
        ;
}

void cli_written_end(struct cli_written *w) {
    if (w->watches)
        uv_close((uv_handle_t *)&w->poll, NULL);
    w->watches = false;
}
