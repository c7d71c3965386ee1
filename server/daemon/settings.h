/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Settings of the programs: one table, read from a JSON file, the environment and options, each overriding
 * the one before. */
#ifndef FACCIA_DAEMON_SETTINGS_H
#define FACCIA_DAEMON_SETTINGS_H

#include "server/api/api.h"
#include "server/base/buf.h"
#include "server/base/error.h"
#include "server/base/log.h"
#include "server/base/paths.h"
#include "server/voice/voice_pool.h"
#include <stdbool.h>

/* One section per component; members that are not settings are 0. The settings own strings and lists. */
struct settings {
    struct settings *before; /* replaced by these; NULL: none */
    struct api_options api;
    struct voice_pool_options voices;
    const char *models, *sounds; /* folders; sounds NULL = none */
    const char *gestures;        /* folder; NULL = only those of the models */
    const char *library;         /* folder of works; NULL = none */
    const char *index;           /* path of its index; NULL = in the cache folder of the user or service */
    const char *ahead;           /* voice that prerenders the library; NULL = none */
    uint64_t ahead_bytes;        /* limit of prerendered sound; 0 = three quarters of the sentence cache */
    unsigned align_percent;      /* of a processor, for aligning the library's recordings; 0 = off */
    const char *cluster;         /* address of the cluster's state; NULL = none */
    unsigned cluster_keep_hours;
    unsigned cluster_queue; /* sentences that may wait for remote workers, per voice queue */
    const char *lang;
    char *const *lexicons;          /* files of pronunciations, by precedence; NULL = none */
    const char *lexicon_folder;     /* files that texts may refer to; NULL = none */
    enum face_contacts contacts;    /* for requests that say "engine" */
    const char *secret_file;        /* NULL = none */
    const char *revoked_file;       /* NULL = none */
    const char *tls_cert, *tls_key; /* paths; both NULL = no TLS, unless */
    const char *tls_self_signed;    /* certificate is created in this folder; NULL = no */
    unsigned log_format;            /* 0 text, 1 JSON */
    unsigned stop_seconds;
    unsigned live_voices;             /* live voices at a time */
    unsigned live_voices_per_address; /* live voices per address or subject; 0 = unlimited */
    unsigned live_voice_seconds;      /* buffered sound of each live voice */
    const char *recogniser;           /* command or address; NULL = none */
    unsigned hear_seconds;            /* longest utterance of a listener */
};

/* Each program has the settings that apply to it. */
enum program { PROGRAM_DAEMON, PROGRAM_COMMANDS, PROGRAM_WORKER };

/* Options that are not settings. */
struct settings_request {
    bool help, version, print, schema;
    const char *file; /* --config; NULL = none */
    int rest;         /* index of the first argument that is not an option */
};

/* Reads defaults, the file named by --config or $FACCIA_CONFIG, the environment, and argv (for commands:
 * up to the command). paths gives default folders. -1 with *e, whose field names the option, variable or
 * member ("--port", "FACCIA_PORT", "listen.port") and whose message begins with the file, if any. Call
 * settings_free in either case. */
int settings_read(struct settings *settings, struct settings_request *request, enum program program, int argc,
                  char **argv, const struct paths *paths, struct error *e);
void settings_free(struct settings *settings);

/* Keeps the replaced settings: members that change only at a restart may still point into them. */
void settings_follow(struct settings *settings, const struct settings *before);

/* True when they differ in a setting that needs a restart. */
bool settings_need_restart(const struct settings *old, const struct settings *now);

/* Log format; switches to journald's if that reads the log. */
enum log_format settings_log_format(const struct settings *settings);

/* Returns the cache folder of the service (systemd) or the user. Free it; NULL if neither is set. */
char *settings_cache_folder(void);

/* Prints all settings as a configuration file. */
void settings_print(const struct settings *settings, struct buf *out);

/* Prints the JSON Schema of the configuration file. */
void settings_schema(struct buf *out);

/* Prints the options with their defaults, and the other ways to set them. */
void settings_help(enum program program, struct buf *out);

#endif
