/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The settings of the daemon and of the command line: one table of all, read from a JSON file, the
 * environment and the options, each of which overrides the one before. */
#ifndef FACCIA_APP_SETTINGS_H
#define FACCIA_APP_SETTINGS_H

#include "server/base/buf.h"
#include "server/base/error.h"
#include "server/base/log.h"
#include "server/base/paths.h"
#include "server/api/api.h"
#include "server/voice/voice_pool.h"
#include <stdbool.h>

/* Each stage's own section; what a stage is not told by settings is 0 in it. Texts and lists belong to the
 * settings. */
struct settings {
    struct settings *before; /* that these came in place of; NULL: none */
    struct api_options api;
    struct voice_pool_options voices;
    const char *models, *sounds; /* folders; sounds NULL = none */
    const char *gestures;        /* folder; NULL = none besides those of models */
    const char *library;         /* folder of works; NULL = none */
    const char *index;      /* the file of its index; NULL = in the user's or the service's cache folder */
    const char *ahead;      /* the voice that speaks the library's works ahead; NULL = none */
    uint64_t ahead_bytes;   /* of sound, at most; 0 = three quarters of what is kept of sentences */
    unsigned align_percent; /* of a processor, for aligning the library's recordings; 0 = none is */
    const char *cluster;    /* where the daemons have what they share; NULL = it is alone */
    unsigned cluster_keep_hours;
    unsigned cluster_queue; /* sentences that may wait for workers elsewhere, for each kind of voices */
    const char *lang;
    enum face_contacts contacts;    /* of requests that say "engine" */
    const char *secret_file;        /* NULL = none */
    const char *revoked_file;       /* NULL = none */
    const char *tls_cert, *tls_key; /* files; NULL = no TLS, or that of */
    const char *tls_self_signed;    /* this folder; NULL = none */
    unsigned log_format;            /* 0 text, 1 JSON */
    unsigned stop_seconds;
    unsigned heard_most;    /* people's own voices, at a time */
    unsigned heard_address; /* of one address or subject; 0 = no limit of its own */
    unsigned heard_seconds; /* of sound that waits, of each */
};

/* The others have those of the settings that concern them. */
enum program { PROGRAM_DAEMON, PROGRAM_COMMANDS, PROGRAM_WORKER };

/* What the command line asks for besides settings. */
struct settings_request {
    bool help, version, print, schema;
    const char *file; /* --config; NULL = none */
    int rest;         /* the first argument that is no option */
};

/* Reads all: the defaults, the file that --config or $FACCIA_CONFIG names, the environment, argv, of the
 * commands' up to the command. paths are the defaults of the folders. -1 with *e, whose field names the
 * option, the variable or the member ("--port", "FACCIA_PORT", "listen.port") and whose message begins with
 * the file when it stands in one; call settings_free all the same. */
int settings_read(struct settings *settings, struct settings_request *request, enum program program, int argc,
                  char **argv, const struct paths *paths, struct error *e);
void settings_free(struct settings *settings);

/* Takes over those before: what waits for a restart may point into them as long as the program runs. */
void settings_follow(struct settings *settings, const struct settings *before);

/* Does the second differ from the first in what counts at the start only? */
bool settings_need_restart(const struct settings *old, const struct settings *now);

/* How the log is written: as the settings say, and for journald where that reads it. */
enum log_format settings_log_format(const struct settings *settings);

/* Where programs keep what can be made again: systemd's folder for that, else the user's. To be freed; NULL:
 * there is none. */
char *settings_cache_folder(void);

/* As a configuration file that says all. */
void settings_print(const struct settings *settings, struct buf *out);

/* The JSON Schema of such a file. */
void settings_schema(struct buf *out);

/* The options with their defaults, one in each line, and how else they can be given. */
void settings_help(enum program program, struct buf *out);

#endif
