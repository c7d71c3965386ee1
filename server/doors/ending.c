/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/doors/ending.h"
#include <signal.h>

static void on_signal(uv_signal_t *signal, int number) {
    (void)number;
    uv_stop(signal->loop);
}

void ending_open(struct ending *e, uv_loop_t *loop) {
    static const int numbers[2] = {SIGINT, SIGTERM};
    for (int i = 0; i < 2; i++) {
        uv_signal_init(loop, &e->signals[i]);
        uv_signal_start(&e->signals[i], on_signal, numbers[i]);
    }
}

void ending_run(struct ending *e) {
    for (int i = 0; i < 2; i++)
        if (!uv_is_closing((uv_handle_t *)&e->signals[i]))
            uv_close((uv_handle_t *)&e->signals[i], NULL);
    uv_run(e->signals[0].loop, UV_RUN_DEFAULT);
}

void ending_close(struct ending *e) {
    uv_loop_t *loop = e->signals[0].loop;
    ending_run(e);
    uv_loop_close(loop);
}
