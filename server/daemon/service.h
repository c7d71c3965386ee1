/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Communication with systemd (sd_notify(3), sd_listen_fds(3)). Without systemd the functions do nothing. */
#ifndef FACCIA_DAEMON_SERVICE_H
#define FACCIA_DAEMON_SERVICE_H

#include <uv.h>

/* Returns the sockets passed by systemd; free the list. */
unsigned service_sockets(int **sockets);

void service_ready(const char *status);
void service_reloading(void);
void service_stopping(void);

/* Notifies the watchdog at the required interval. Close the timer with service_watchdog_stop. */
void service_watchdog_start(uv_loop_t *loop, uv_timer_t *timer);
void service_watchdog_stop(uv_timer_t *timer);

#endif
