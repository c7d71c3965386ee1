/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Log lines on standard error: "faccia: warning: message", with the priority in brackets for journald, or as
 * objects: {"time", "level", "pid", "message"}. */
#ifndef FACCIA_BASE_LOG_H
#define FACCIA_BASE_LOG_H

#include <stdbool.h>

enum log_format { LOG_TEXT, LOG_JSON, LOG_JOURNAL };

/* As the process says it from now on; until then, as text. Like standard error, this is one for the whole
 * process: main decides it. Any thread may log meanwhile. */
void log_open(enum log_format format);

/* The same by its name, which is what a process tells another that it starts. False: there is no such. */
bool log_open_named(const char *name);
const char *log_format_name(void);

void log_error(const char *format, ...) __attribute__((format(printf, 1, 2)));
void log_warn(const char *format, ...) __attribute__((format(printf, 1, 2)));
void log_info(const char *format, ...) __attribute__((format(printf, 1, 2)));

#endif
