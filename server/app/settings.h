/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The settings of the daemon: one table of all, read from a JSON file, the environment and the options, each
 * of which overrides the one before. */
#ifndef FACCIA_APP_SETTINGS_H
#define FACCIA_APP_SETTINGS_H

#include "server/base/buf.h"
#include "server/base/error.h"
#include "server/base/paths.h"
#include <jansson.h>
#include <stdbool.h>

struct settings {
    char *host;
    unsigned port;
    bool remote;
    char **origins, **host_names, **embed; /* NULL-terminated */
    char *token_file;
    char *lang;
    unsigned workers, spare_workers;
    double start_seconds;
    double deadline_base, deadline_per_byte; /* s */
    double deadline_most, worker_processor;  /* in multiples of them */
    unsigned worker_megabytes;
    char *sandbox;  /* "on", "off" */
    char *contacts; /* "engine", "on", "off" */
    unsigned cache_megabytes, cache_file_megabytes;
    char *cache_file;
    json_t *voices; /* plugin name -> its own configuration */
    unsigned text_bytes, message_bytes, play_bytes, queue, connections, rooms, address_connections,
        address_requests;
    unsigned send_bytes, send_bytes_max;
    unsigned lag_seconds, stall_seconds, ping_seconds, stop_seconds, hold_seconds;
    char *log;
    char *models, *web, *media, *plugins, *worker, *audio;
};

/* What the command line asks for besides settings. */
struct settings_request {
    bool help, version, print;
    const char *file; /* --config; NULL = none */
};

/* Reads all: the defaults, the file that --config or $FACCIA_CONFIG names, the environment, argv. paths are
 * the defaults of the folders. -1 with *e, whose field names the option, the variable or the member
 * ("--port", "FACCIA_PORT", "listen.port") and whose message begins with the file when it stands in one;
 * call settings_free all the same. */
int settings_read(struct settings *settings, struct settings_request *request, int argc, char **argv,
                  const struct paths *paths, struct error *e);
void settings_free(struct settings *settings);

/* Does the second differ from the first in what counts at the start only? */
bool settings_need_restart(const struct settings *old, const struct settings *now);

/* Lets the log be written as the settings say. */
void settings_apply_log(const struct settings *settings);

/* As a configuration file that says all. */
void settings_print(const struct settings *settings, struct buf *out);

/* The options with their defaults. */
void settings_help(struct buf *out);

#endif
