/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/mem.h"
#include "server/daemon/settings_internal.h"
#include <stdlib.h>
#include <string.h>

#define MEMBER(name) offsetof(struct settings, name)

/* All settings and limits with their defaults. */
const struct setting settings_table[] = {
    {"listen.host", "host", SETTING_STRING, MEMBER(api.http.host), FOR_DAEMON, 0, 0, "127.0.0.1", "ADDRESS",
     "address, host name or network interface to listen on; * = all addresses"},
    {"listen.port", "port", SETTING_NUMBER, MEMBER(api.http.port), FOR_DAEMON, 0, 65535, "8080", "N",
     "port to listen on; 0 = any free port"},
    {"listen.remote", "remote", SETTING_FLAG, MEMBER(api.http.remote), FOR_DAEMON, 0, 0, "false", NULL,
     "allow a --host that other machines can reach"},
    {"listen.tls_cert", "tls-cert", SETTING_STRING, MEMBER(tls_cert), FOR_DAEMON, 0, 0, NULL, "FILE",
     "serve TLS (https:, wss:) with this certificate and its chain, in PEM; other machines are redirected to "
     "https:"},
    {"listen.tls_key", "tls-key", SETTING_STRING, MEMBER(tls_key), FOR_DAEMON, 0, 0, NULL, "FILE",
     "private key of --tls-cert, in PEM"},
    {"listen.tls_self_signed", "tls-self-signed", SETTING_STRING, MEMBER(tls_self_signed), FOR_DAEMON, 0, 0,
     NULL, "FOLDER",
     "serve TLS with a self-made certificate, created in FOLDER when there is none or it expires: for a home "
     "whose devices trust it once they have installed FOLDER/ca.pem"},
    {"listen.hsts", "hsts", SETTING_NUMBER, MEMBER(api.http.hsts), FOR_DAEMON, 0, 63072000, "0", "SECONDS",
     "tell browsers to use only TLS for this time (Strict-Transport-Security); 0 = off"},
    {"access.origins", "origin", SETTING_LIST, MEMBER(api.origins), FOR_DAEMON, 0, 0, NULL, "ORIGIN",
     "allow pages of this origin, such as https://example.org; null = local files; * = all; may be repeated"},
    {"access.host_names", "host-name", SETTING_LIST, MEMBER(api.host_names), FOR_DAEMON, 0, 0, NULL, "NAME",
     "a host name or address by which clients reach this daemon, in addition to localhost and, with "
     "--remote, the machine's own name and addresses; * = any; may be repeated"},
    {"access.embed", "embed", SETTING_LIST, MEMBER(api.embed), FOR_DAEMON, 0, 0, NULL, "ORIGIN",
     "allow pages of this origin to embed the reading and face pages in a frame; * = all; may be repeated"},
    {"access.editing", "editing", SETTING_FLAG, MEMBER(api.editing), FOR_DAEMON, 0, 0, "false", NULL,
     "let operators save gestures and library works over HTTP"},
    {"access.open_reports", "open-reports", SETTING_FLAG, MEMBER(api.open_reports), FOR_DAEMON, 0, 0, "false",
     NULL, "let readers report misread words without a token (see --reports)"},
    {"access.secret_file", "secret-file", SETTING_STRING, MEMBER(secret_file), FOR_DAEMON, 0, 0, NULL, "FILE",
     "require tokens signed with a secret from this file (one per line)"},
    {"access.revoked_file", "revoked-file", SETTING_STRING, MEMBER(revoked_file), FOR_DAEMON, 0, 0, NULL,
     "FILE", "revoked tokens, as written by 'faccia token --revoke' (one per line)"},
    {"speech.lang", "lang", SETTING_STRING, MEMBER(lang), FOR_BOTH, 0, 0, "it", "TAG",
     "language of requests that do not name one"},
    {"speech.lexicons", "lexicon", SETTING_LIST, MEMBER(lexicons), FOR_BOTH, 0, 0, NULL, "FILE",
     "pronunciation lexicon for all texts (W3C PLS); may be repeated: the first file that contains a word "
     "decides"},
    {"speech.contacts", "contacts", SETTING_CHOICE, MEMBER(contacts), FOR_BOTH, 0, 0, "engine",
     "engine|on|off",
     "force the lips to touch where sounds require it, for requests that do not set it: on, off, or as the "
     "engine does"},
    {"speech.recogniser", "recogniser", SETTING_STRING, MEMBER(recogniser), FOR_DAEMON, 0, 0, NULL, "COMMAND",
     "recognise what listeners say: a command that reads 16 kHz 16-bit mono samples and prints the words, or "
     "tcp://HOST:PORT, a server of the Wyoming protocol"},
    {"voices.workers", "workers", SETTING_NUMBER, MEMBER(voices.workers), FOR_DAEMON, 1, 64, "1", "N",
     "worker processes of each voice plugin"},
    {"voices.spare_workers", "spare-workers", SETTING_NUMBER, MEMBER(voices.spare_workers), FOR_DAEMON, 0, 64,
     "1", "N", "additional workers while one is slow or does not respond and sentences are queued; 0 = none"},
    {"voices.start_seconds", "voice-start", SETTING_REAL, MEMBER(voices.start_seconds), FOR_BOTH, 0.1, 3600,
     "30", "S", "how long requests wait for voices that are still starting"},
    {"voices.deadline_base", "deadline-base", SETTING_REAL, MEMBER(voices.deadline_base), FOR_BOTH, 0.1, 3600,
     "10", "S", "give up a sentence and kill its worker when no sound has arrived for this time"},
    {"voices.deadline_per_byte", "deadline-per-byte", SETTING_REAL, MEMBER(voices.deadline_per_byte),
     FOR_BOTH, 0, 10, "0.05", "S", "added to --deadline-base for each byte of the sentence's text"},
    {"voices.deadline_most", "deadline-most", SETTING_REAL, MEMBER(voices.deadline_most), FOR_BOTH, 1, 1000,
     "10", "X", "total time limit of a sentence, in multiples of its deadline"},
    {"voices.processor", "worker-processor", SETTING_REAL, MEMBER(voices.processor), FOR_BOTH, 0.01, 1000,
     "20", "X", "processor time limit of a sentence, in multiples of its deadline"},
    {"voices.memory_megabytes", "worker-memory", SETTING_NUMBER, MEMBER(voices.megabytes), FOR_BOTH, 64,
     1048576, "4096", "N", "address space of a worker, in megabytes"},
    {"voices.sandbox", "sandbox", SETTING_CHOICE, MEMBER(voices.unconfined), FOR_BOTH, 0, 0, "on", "on|off",
     "deny workers the network, other programs, and system calls that their plugin does not need"},
    {"voices.boundaries", "boundaries", SETTING_CHOICE, MEMBER(voices.own_boundaries), FOR_BOTH, 0, 0,
     "heard", "heard|own",
     "phone boundaries: heard = corrected as measured for the voice, own = as the voice reports them"},
    {"voices.cache_megabytes", "cache", SETTING_MEGABYTES, MEMBER(voices.cache.bytes), FOR_DAEMON, 0, 65536,
     "64", "N", "size of the sentence cache in memory, in megabytes; 0 = off"},
    {"voices.cache_file", "cache-file", SETTING_STRING, MEMBER(voices.cache.file), FOR_DAEMON, 0, 0, NULL,
     "FILE", "also cache sentences on disk, in this file: an existing cache or a new file"},
    {"voices.cache_file_megabytes", "cache-file-size", SETTING_MEGABYTES, MEMBER(voices.cache.file_bytes),
     FOR_DAEMON, 1, 1048576, "1024", "N", "size limit of --cache-file, in megabytes"},
    {"voices.plugins", "voice-config", SETTING_OBJECT, MEMBER(voices.config), FOR_BOTH, 0, 0, NULL, "FILE",
     "JSON object with the settings of each plugin, by plugin name"},
    {"cluster.address", "cluster", SETTING_STRING, MEMBER(cluster), FOR_DAEMON, 0, 0, NULL, "URL",
     "share rooms and finished sentences with other daemons, and use the voices of faccia-worker, through "
     "the Redis at redis://[[USER]:PASSWORD@]HOST[:PORT][/N]"},
    {"cluster.keep_hours", "cluster-keep", SETTING_NUMBER, MEMBER(cluster_keep_hours), FOR_DAEMON, 1, 100000,
     "168", "N", "how long Redis keeps a sentence that is not requested, in hours"},
    {"cluster.queue", "cluster-queue", SETTING_NUMBER, MEMBER(cluster_queue), FOR_DAEMON, 1, 100000, "1000",
     "N",
     "sentences that may be queued for the workers of one voice plugin; prerendering may use half of them"},
    {"limits.text_bytes", "max-text", SETTING_NUMBER, MEMBER(api.text_bytes), FOR_DAEMON, 1, 100 << 20,
     "100000", "N", "longest text of a request, in bytes"},
    {"limits.message_bytes", "max-message", SETTING_NUMBER, MEMBER(api.http.message_bytes), FOR_DAEMON, 64,
     200 << 20, "262144", "N", "longest message of a client, in bytes"},
    {"limits.play_bytes", "max-play", SETTING_NUMBER, MEMBER(api.play_bytes), FOR_DAEMON, 1024, 1 << 30,
     "16777216", "N", "largest uploaded recording, or .fap file in --media, in bytes"},
    {"limits.scene_bytes", "max-scene", SETTING_NUMBER, MEMBER(api.scene_bytes), FOR_DAEMON, 64, 1 << 24,
     "262144", "N", "largest scene, in bytes"},
    {"limits.scenes", "max-scenes", SETTING_NUMBER, MEMBER(api.scene_count), FOR_DAEMON, 1, 10000, "200", "N",
     "number of scenes that can be saved"},
    {"limits.queue", "max-queue", SETTING_NUMBER, MEMBER(api.rooms.queue), FOR_DAEMON, 1, 10000, "32", "N",
     "utterances that may be queued on one stream"},
    {"limits.open", "max-open", SETTING_NUMBER, MEMBER(api.open), FOR_DAEMON, 1, 1000, "8", "N",
     "open texts of one client at a time"},
    {"limits.open_seconds", "open-seconds", SETTING_NUMBER, MEMBER(api.open_seconds), FOR_DAEMON, 0, 86400,
     "20", "S", "close an open text after this many idle seconds; 0 = never"},
    {"limits.voices", "max-voices", SETTING_NUMBER, MEMBER(live_voices), FOR_DAEMON, 0, 10000, "16", "N",
     "live voices that may be open at a time"},
    {"limits.voice_seconds", "voice-seconds", SETTING_NUMBER, MEMBER(live_voice_seconds), FOR_DAEMON, 1, 60,
     "2", "S", "when this many seconds of a live voice are buffered, drop all but the last 0.2 s"},
    {"limits.hear_seconds", "hear-seconds", SETTING_NUMBER, MEMBER(hear_seconds), FOR_DAEMON, 1, 600, "30",
     "S",
     "longest utterance of a listener that is recognised; the recogniser has this long after its end, too"},
    {"limits.films", "max-films", SETTING_NUMBER, MEMBER(api.films), FOR_DAEMON, 0, 1000, "8", "N",
     "films that clients have ordered, finished ones included: the oldest of these makes room; 0 = none can "
     "be ordered"},
    {"limits.films_per_client", "max-films-per-client", SETTING_NUMBER, MEMBER(api.films_of_client),
     FOR_DAEMON, 1, 1000, "4", "N", "the same of one client: the oldest finished one of its own makes room"},
    {"limits.coach_seconds", "coach-seconds", SETTING_NUMBER, MEMBER(api.coach_seconds), FOR_DAEMON, 0, 60,
     "20", "S", "longest recording that is compared with its text (POST /v1/coach); 0 = none is"},
    {"limits.film_seconds", "film-seconds", SETTING_NUMBER, MEMBER(api.film_seconds), FOR_DAEMON, 1, 7200,
     "600", "S", "longest film that a client can order"},
    {"limits.connections", "max-connections", SETTING_NUMBER, MEMBER(api.http.connections), FOR_DAEMON, 1,
     100000, "1000", "N", "connections that may be open at a time"},
    {"limits.rooms", "max-rooms", SETTING_NUMBER, MEMBER(api.rooms.rooms), FOR_DAEMON, 1, 100000, "100", "N",
     "rooms that may be in use at a time"},
    {"limits.address_rooms", "max-rooms-per-address", SETTING_NUMBER, MEMBER(api.rooms.address_rooms),
     FOR_DAEMON, 0, 100000, "25", "N",
     "rooms that one address, or one token's subject, may create; 0 = only --max-rooms applies"},
    {"limits.address_voices", "max-voices-per-address", SETTING_NUMBER, MEMBER(live_voices_per_address),
     FOR_DAEMON, 0, 10000, "8", "N", "live voices of one address or subject; 0 = only --max-voices applies"},
    {"limits.address_connections", "max-per-address", SETTING_NUMBER, MEMBER(api.http.address_connections),
     FOR_DAEMON, 0, 100000, "250", "N",
     "connections of one address, or of one token's subject, across the cluster; 0 = only --max-connections "
     "applies"},
    {"limits.address_requests", "max-requests", SETTING_NUMBER, MEMBER(api.address_requests), FOR_DAEMON, 0,
     1000000, "1200", "N",
     "utterances and POST requests of one address or subject per minute, across the cluster; 0 = no limit"},
    {"limits.send_bytes", "send-bytes", SETTING_NUMBER, MEMBER(api.http.send_bytes), FOR_DAEMON, 4096,
     1 << 30, "262144", "N", "hold back media for a client while this many bytes are unsent"},
    {"limits.send_bytes_max", "send-bytes-max", SETTING_NUMBER, MEMBER(api.http.send_bytes_max), FOR_DAEMON,
     65536, 1 << 30, "4194304", "N", "close a client as too slow when this many bytes are unsent"},
    {"limits.lag_seconds", "lag-seconds", SETTING_NUMBER, MEMBER(api.lag_seconds), FOR_DAEMON, 1, 3600, "5",
     "N", "in a room, drop media that have waited for this many seconds"},
    {"limits.stall_seconds", "stall-seconds", SETTING_NUMBER, MEMBER(api.http.stall_seconds), FOR_DAEMON, 1,
     3600, "10", "N", "close a client that reads nothing for this many seconds"},
    {"limits.ping_seconds", "ping-seconds", SETTING_NUMBER, MEMBER(api.http.ping_seconds), FOR_DAEMON, 1,
     3600, "30", "N",
     "ping a socket that is silent for this many seconds; close it if it stays silent for a third of that "
     "time longer"},
    {"limits.stop_seconds", "stop-seconds", SETTING_NUMBER, MEMBER(stop_seconds), FOR_DAEMON, 0, 3600, "5",
     "N", "how long speech may continue after SIGTERM, in seconds"},
    {"limits.hold_seconds", "hold", SETTING_NUMBER, MEMBER(api.rooms.hold_seconds), FOR_DAEMON, 0, 86400, "0",
     "S", "how long speech requested over HTTP for an empty room waits for a listener; 0 = not at all"},
    {"library.align_percent", "library-align", SETTING_NUMBER, MEMBER(align_percent), FOR_DAEMON, 0, 100,
     "50", "N",
     "align the library's recordings to their texts in the background, with at most this percentage of one "
     "processor and only while it is idle; 0 = only when a recording is requested"},
    {"library.ahead", "library-ahead", SETTING_STRING, MEMBER(ahead), FOR_DAEMON, 0, 0, NULL, "VOICE",
     "prerender the library's works in this voice's language into the sentence cache while the voice is "
     "idle, so that they start at once"},
    {"library.ahead_megabytes", "library-ahead-size", SETTING_MEGABYTES, MEMBER(ahead_bytes), FOR_DAEMON, 0,
     1048576, "0", "N", "limit of prerendered sound, in megabytes; 0 = three quarters of the sentence cache"},
    {"log.format", "log", SETTING_CHOICE, MEMBER(log_format), FOR_BOTH, 0, 0, "text", "text|json",
     "format of log lines"},
    {"paths.models", "models", SETTING_STRING, MEMBER(models), FOR_BOTH, 0, 0, NULL, "DIR",
     "heads and language packs"},
    {"paths.web", "web", SETTING_STRING, MEMBER(api.web), FOR_BOTH, 0, 0, NULL, "DIR",
     "web pages and their scripts"},
    {"paths.media", "media", SETTING_FOLDER, MEMBER(api.media), FOR_DAEMON, 0, 0, NULL, "DIR",
     "recordings that can be played: .fap files with their sound"},
    {"paths.scenes", "scenes", SETTING_FOLDER, MEMBER(api.scenes), FOR_DAEMON, 0, 0, NULL, "DIR",
     "scenes, which operators can save"},
    {"paths.sessions", "sessions", SETTING_FOLDER, MEMBER(api.sessions), FOR_DAEMON, 0, 0, NULL, "DIR",
     "recorded sessions of studies, while the listener consents; without this folder none is recorded"},
    {"paths.reports", "reports", SETTING_FOLDER, MEMBER(api.reports), FOR_DAEMON, 0, 0, NULL, "DIR",
     "reports of misread words by readers of the library; without this folder nothing can be reported"},
    {"paths.plugins", "plugins", SETTING_STRING, MEMBER(voices.plugin_dir), FOR_BOTH, 0, 0, NULL, "DIR",
     "voice plugins"},
    {"paths.worker", "worker", SETTING_STRING, MEMBER(voices.worker), FOR_BOTH, 0, 0, NULL, "FILE",
     "program that runs voice plugins"},
    {"paths.film_program", "film-program", SETTING_STRING, MEMBER(api.film_program), FOR_DAEMON, 0, 0, NULL,
     "FILE", "program that makes films: faccia"},
    {"paths.gestures", "gestures", SETTING_FOLDER, MEMBER(gestures), FOR_BOTH, 0, 0, NULL, "DIR",
     "your own gestures, as saved by the Face Player, in addition to those of the models"},
    {"paths.library", "library", SETTING_FOLDER, MEMBER(library), FOR_DAEMON, 0, 0, NULL, "DIR",
     "works to read, search and listen to: TEI, EPUB, Markdown, text, APML, JSML, SSML"},
    {"paths.library_index", "library-index", SETTING_STRING, MEMBER(index), FOR_DAEMON, 0, 0, NULL, "FILE",
     "index of the library, created if it is missing (default: in systemd's cache folder, or faccia/ in "
     "$XDG_CACHE_HOME or ~/.cache)"},
    {"paths.lexicons", "lexicons", SETTING_FOLDER, MEMBER(lexicon_folder), FOR_BOTH, 0, 0, NULL, "DIR",
     "pronunciation lexicons (.pls) that texts may refer to with SSML's lexicon"},
    {"paths.audio", "audio", SETTING_FOLDER, MEMBER(sounds), FOR_BOTH, 0, 0, NULL, "DIR",
     "sound files that texts may refer to with SSML's audio"},
};
const size_t settings_count = sizeof settings_table / sizeof *settings_table;

/* ---- the JSON Schema of the configuration file, for editors ---- */

/* Accepted by lang_read (base/lang.h): a BCP 47 tag, or a POSIX locale. */
#define TAG_PATTERN                                                                                          \
    "^(?:[A-Za-z]{2,8}(?:-[A-Za-z0-9]{1,8})*|[xXiI](?:-[A-Za-z0-9]{1,8})+|[A-Za-z]{2,3}_[A-Za-z0-9]{2})"     \
    "(?:\\.[A-Za-z0-9-]+(?:@[A-Za-z0-9-]+)?|@[A-Za-z0-9-]+)?$"

/* null means no value. */
static json_t *or_null(const char *type) {
    return json_pack("{s[ss]}", "type", type, "null");
}

static json_t *choice(const char *words) {
    json_t *list = json_array();
    for (size_t n; *words; words += n + (words[n] == '|')) {
        n = strcspn(words, "|");
        json_array_append_new(list, json_stringn(words, n));
    }
    json_array_append_new(list, json_null());
    return json_pack("{so}", "enum", list);
}

static json_t *type_of(const struct setting *setting) {
    json_t *value;
    switch (setting->type) {
    case SETTING_STRING:
    case SETTING_FOLDER:
        value = or_null("string");
        if (setting_is_tag(setting))
            json_object_set_new(value, "pattern", json_string(TAG_PATTERN));
        return value;
    case SETTING_CHOICE:
        return choice(setting->shape);
    case SETTING_FLAG:
        return or_null("boolean");
    case SETTING_NUMBER:
    case SETTING_REAL:
    case SETTING_MEGABYTES:
        value = or_null(setting->type == SETTING_REAL ? "number" : "integer");
        json_object_set_new(value, "minimum", json_real(setting->min));
        json_object_set_new(value, "maximum", json_real(setting->max));
        return value;
    case SETTING_LIST:
        value = or_null("array");
        json_object_set_new(value, "items", json_pack("{ss}", "type", "string"));
        return value;
    case SETTING_OBJECT:
        break;
    }
    value = or_null("object");
    json_object_set_new(value, "additionalProperties", json_pack("{ss}", "type", "object"));
    return value;
}

static json_t *described(const struct setting *setting) {
    json_t *value = type_of(setting);
    json_object_set_new(value, "description", json_string(setting->help));
    return value;
}

void settings_schema(struct buf *out) {
    json_t *groups = json_object();
    for (size_t i = 0; i < settings_count; i++) {
        const struct setting *setting = &settings_table[i];
        size_t length = strcspn(setting->path, ".");
        char *group = mem_strndup(setting->path, length);
        json_t *members = json_object_get(json_object_get(groups, group), "properties");
        if (!members) {
            members = json_object();
            json_object_set_new(
                groups, group,
                json_pack("{ss sb so}", "type", "object", "additionalProperties", 0, "properties", members));
        }
        json_object_set_new(members, setting->path + length + 1, described(setting));
        free(group);
    }
    json_t *root = json_pack("{ss ss ss ss sb so}", "$schema", "https://json-schema.org/draft/2020-12/schema",
                             "$id", "faccia/settings.json", "title", "The settings of facciad and faccia",
                             "type", "object", "additionalProperties", 0, "properties", groups);
    char *text = json_dumps(root, JSON_INDENT(1) | JSON_REAL_PRECISION(12));
    buf_printf(out, "%s\n", text);
    free(text);
    json_decref(root);
}
