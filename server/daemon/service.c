/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/daemon/service.h"
#include "server/base/mem.h"
#include <stdlib.h>

#ifdef HAVE_SYSTEMD
#include <systemd/sd-daemon.h>

unsigned service_sockets(int **sockets) {
    int count = sd_listen_fds(1);
    *sockets = NULL;
    if (count <= 0)
        return 0;
    *sockets = mem_alloc((size_t)count * sizeof **sockets);
    for (int i = 0; i < count; i++)
        (*sockets)[i] = SD_LISTEN_FDS_START + i;
    return (unsigned)count;
}

void service_ready(const char *status) {
    sd_notifyf(0, "READY=1\nSTATUS=%s", status);
}

void service_reloading(void) {
    sd_notify(0, "RELOADING=1");
}

void service_stopping(void) {
    sd_notify(0, "STOPPING=1");
}

static void on_alive(uv_timer_t *timer) {
    (void)timer;
    sd_notify(0, "WATCHDOG=1");
}

void service_watchdog_start(uv_loop_t *loop, uv_timer_t *timer) {
    uint64_t microseconds = 0;
    uv_timer_init(loop, timer);
    if (sd_watchdog_enabled(1, &microseconds) > 0)
        uv_timer_start(timer, on_alive, microseconds / 2000, microseconds / 2000);
}
#else
unsigned service_sockets(int **sockets) {
    *sockets = NULL;
    return 0;
}

void service_ready(const char *status) {
    (void)status;
}

void service_reloading(void) {}

void service_stopping(void) {}

void service_watchdog_start(uv_loop_t *loop, uv_timer_t *timer) {
    uv_timer_init(loop, timer);
}
#endif

void service_watchdog_stop(uv_timer_t *timer) {
    uv_close((uv_handle_t *)timer, NULL);
}
