/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Log lines on standard error: "faccia: warning: message", with the priority in brackets when journald reads
 * them, or, where $FACCIA_LOG is "json", as objects: {"time", "level", "pid", "message"}. */
#ifndef FACCIA_BASE_LOG_H
#define FACCIA_BASE_LOG_H

void log_error(const char *format, ...) __attribute__((format(printf, 1, 2)));
void log_warn(const char *format, ...) __attribute__((format(printf, 1, 2)));
void log_info(const char *format, ...) __attribute__((format(printf, 1, 2)));

#endif
