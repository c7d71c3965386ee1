/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Log lines on standard error: "faccia: warning: message", with the priority in brackets for journald, or as
 * objects: {"time", "level", "pid", "message"}. */
#ifndef FACCIA_BASE_LOG_H
#define FACCIA_BASE_LOG_H

#include <stdbool.h>

enum log_format { LOG_TEXT, LOG_JSON, LOG_JOURNAL };

/* Sets the format; text by default. Like standard error, it is global to the process: call it in main.
 * Other threads may log meanwhile. */
void log_open(enum log_format format);

/* Set the format by name, and return its name, to pass it to a child process. False: unknown name. */
bool log_open_named(const char *name);
const char *log_format_name(void);

void log_error(const char *format, ...) __attribute__((format(printf, 1, 2)));
void log_warn(const char *format, ...) __attribute__((format(printf, 1, 2)));
void log_info(const char *format, ...) __attribute__((format(printf, 1, 2)));

#endif
