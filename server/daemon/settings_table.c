/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/mem.h"
#include "server/daemon/settings_internal.h"
#include <stdlib.h>
#include <string.h>

#define MEMBER(name) offsetof(struct settings, name)

/* All settings and limits with their defaults. */
const struct setting settings_table[] = {
    {"listen.host", "host", SETTING_STRING, MEMBER(api.http.host), FOR_DAEMON, 0, 0, "127.0.0.1", "ADDRESS",
     "listen on this address, on all that a name or an interface has, or with * on all"},
    {"listen.port", "port", SETTING_NUMBER, MEMBER(api.http.port), FOR_DAEMON, 0, 65535, "8080", "N",
     "listen on this port; 0 = any free one"},
    {"listen.remote", "remote", SETTING_FLAG, MEMBER(api.http.remote), FOR_DAEMON, 0, 0, "false", NULL,
     "allow an ADDRESS that other machines can reach"},
    {"listen.tls_cert", "tls-cert", SETTING_STRING, MEMBER(tls_cert), FOR_DAEMON, 0, 0, NULL, "FILE",
     "speak TLS (https:, wss:) with this certificate and its chain, in PEM; other machines that come without "
     "TLS are sent to https:"},
    {"listen.tls_key", "tls-key", SETTING_STRING, MEMBER(tls_key), FOR_DAEMON, 0, 0, NULL, "FILE",
     "the key of --tls-cert, in PEM"},
    {"listen.tls_self_signed", "tls-self-signed", SETTING_STRING, MEMBER(tls_self_signed), FOR_DAEMON, 0, 0,
     NULL, "FOLDER",
     "speak TLS with a certificate of its own, made in FOLDER when there is none that is still good: for a "
     "home, whose devices trust it once they have taken FOLDER/ca.pem"},
    {"listen.hsts", "hsts", SETTING_NUMBER, MEMBER(api.http.hsts), FOR_DAEMON, 0, 63072000, "0", "SECONDS",
     "tell browsers that came by TLS to use nothing else for so long (Strict-Transport-Security); 0 = off"},
    {"access.origins", "origin", SETTING_LIST, MEMBER(api.origins), FOR_DAEMON, 0, 0, NULL, "ORIGIN",
     "let pages from there in, e.g. https://example.org; null = files; * = all; may be repeated"},
    {"access.host_names", "host-name", SETTING_LIST, MEMBER(api.host_names), FOR_DAEMON, 0, 0, NULL, "NAME",
     "a name or address by which others ask for this daemon, besides localhost and, with --remote, the "
     "machine's own name and its addresses; * = any; may be repeated"},
    {"access.embed", "embed", SETTING_LIST, MEMBER(api.embed), FOR_DAEMON, 0, 0, NULL, "ORIGIN",
     "pages from there may frame the daemon's pages of texts and of the face; * = all; may be repeated"},
    {"access.editing", "editing", SETTING_FLAG, MEMBER(api.editing), FOR_DAEMON, 0, 0, "false", NULL,
     "let who may operate save gestures, and works into the library, over HTTP"},
    {"access.open_reports", "open-reports", SETTING_FLAG, MEMBER(api.open_reports), FOR_DAEMON, 0, 0, "false",
     NULL, "let readers report misread words without a token (--reports)"},
    {"access.secret_file", "secret-file", SETTING_STRING, MEMBER(secret_file), FOR_DAEMON, 0, 0, NULL, "FILE",
     "demand tokens signed with a secret of this file (one in each line)"},
    {"access.revoked_file", "revoked-file", SETTING_STRING, MEMBER(revoked_file), FOR_DAEMON, 0, 0, NULL,
     "FILE", "tokens that count no more, as 'faccia token --revoke' writes them (one in each line)"},
    {"speech.lang", "lang", SETTING_STRING, MEMBER(lang), FOR_BOTH, 0, 0, "it", "TAG",
     "language of requests that name none"},
    {"speech.lexicons", "lexicon", SETTING_LIST, MEMBER(lexicons), FOR_BOTH, 0, 0, NULL, "FILE",
     "pronunciations for all texts, in the Pronunciation Lexicon Specification of the W3C (PLS); may be "
     "repeated: for the same words, the first file has the say"},
    {"speech.contacts", "contacts", SETTING_CHOICE, MEMBER(contacts), FOR_BOTH, 0, 0, "engine",
     "engine|on|off",
     "whether lips that must touch do so whatever the engine makes, in requests that do not say on or off"},
    {"voices.workers", "workers", SETTING_NUMBER, MEMBER(voices.workers), FOR_DAEMON, 1, 64, "1", "N",
     "processes for each voice plugin"},
    {"voices.spare_workers", "spare-workers", SETTING_NUMBER, MEMBER(voices.spare_workers), FOR_DAEMON, 0, 64,
     "1", "N",
     "as many more while one takes long over a sentence and others wait, or does not answer; 0 = none"},
    {"voices.start_seconds", "voice-start", SETTING_REAL, MEMBER(voices.start_seconds), FOR_BOTH, 0.1, 3600,
     "30", "S", "requests wait so long for voices that are still starting; then they do without those"},
    {"voices.deadline_base", "deadline-base", SETTING_REAL, MEMBER(voices.deadline_base), FOR_BOTH, 0.1, 3600,
     "10", "S", "a sentence of which nothing has come for so long is given up, and its worker is killed"},
    {"voices.deadline_per_byte", "deadline-per-byte", SETTING_REAL, MEMBER(voices.deadline_per_byte),
     FOR_BOTH, 0, 10, "0.05", "S", "added to that for each byte of the sentence's text"},
    {"voices.deadline_most", "deadline-most", SETTING_REAL, MEMBER(voices.deadline_most), FOR_BOTH, 1, 1000,
     "10", "X", "the longest that a sentence may take in all, in multiples of that time"},
    {"voices.processor", "worker-processor", SETTING_REAL, MEMBER(voices.processor), FOR_BOTH, 0.01, 1000,
     "20", "X", "the processor time that it may take, in multiples of the same time"},
    {"voices.memory_megabytes", "worker-memory", SETTING_NUMBER, MEMBER(voices.megabytes), FOR_BOTH, 64,
     1048576, "4096", "N", "address space of a worker, megabytes"},
    {"voices.sandbox", "sandbox", SETTING_CHOICE, MEMBER(voices.unconfined), FOR_BOTH, 0, 0, "on", "on|off",
     "workers are refused the network, programs and other system calls that their plugin does not need"},
    {"voices.boundaries", "boundaries", SETTING_CHOICE, MEMBER(voices.own_boundaries), FOR_BOTH, 0, 0,
     "heard", "heard|own",
     "phones begin where they are heard, as was measured of the voice, or where the voice itself says"},
    {"voices.cache_megabytes", "cache", SETTING_MEGABYTES, MEMBER(voices.cache.bytes), FOR_DAEMON, 0, 65536,
     "64", "N", "keep finished sentences in memory, up to so many megabytes; 0 = none"},
    {"voices.cache_file", "cache-file", SETTING_STRING, MEMBER(voices.cache.file), FOR_DAEMON, 0, 0, NULL,
     "FILE", "keep them on disk too, in this file, which must be such a cache or not be there yet"},
    {"voices.cache_file_megabytes", "cache-file-size", SETTING_MEGABYTES, MEMBER(voices.cache.file_bytes),
     FOR_DAEMON, 1, 1048576, "1024", "N", "the most that this file may take, megabytes"},
    {"voices.plugins", "voice-config", SETTING_OBJECT, MEMBER(voices.config), FOR_BOTH, 0, 0, NULL, "FILE",
     "JSON object: the settings of each plugin, by its name"},
    {"cluster.address", "cluster", SETTING_STRING, MEMBER(cluster), FOR_DAEMON, 0, 0, NULL, "URL",
     "share rooms and finished sentences with other daemons, and the voices of faccia-worker, over the Redis "
     "at "
     "redis://[[USER]:PASSWORD@]HOST[:PORT][/N]"},
    {"cluster.keep_hours", "cluster-keep", SETTING_NUMBER, MEMBER(cluster_keep_hours), FOR_DAEMON, 1, 100000,
     "168", "N", "a sentence that nobody asks for stays there for so many hours"},
    {"cluster.queue", "cluster-queue", SETTING_NUMBER, MEMBER(cluster_queue), FOR_DAEMON, 1, 100000, "1000",
     "N",
     "sentences that may wait there for the workers of one voice plugin; what is made ahead has half of it"},
    {"limits.text_bytes", "max-text", SETTING_NUMBER, MEMBER(api.text_bytes), FOR_DAEMON, 1, 100 << 20,
     "100000", "N", "longest text of one request, bytes"},
    {"limits.message_bytes", "max-message", SETTING_NUMBER, MEMBER(api.http.message_bytes), FOR_DAEMON, 64,
     200 << 20, "262144", "N", "longest message of a client, bytes"},
    {"limits.play_bytes", "max-play", SETTING_NUMBER, MEMBER(api.play_bytes), FOR_DAEMON, 1024, 1 << 30,
     "16777216", "N", "longest recording that is uploaded, or .fap file in the folder of recordings, bytes"},
    {"limits.scene_bytes", "max-scene", SETTING_NUMBER, MEMBER(api.scene_bytes), FOR_DAEMON, 64, 1 << 24,
     "262144", "N", "longest scene that is kept, bytes"},
    {"limits.scenes", "max-scenes", SETTING_NUMBER, MEMBER(api.scene_count), FOR_DAEMON, 1, 10000, "200", "N",
     "how many scenes are kept"},
    {"limits.queue", "max-queue", SETTING_NUMBER, MEMBER(api.rooms.queue), FOR_DAEMON, 1, 10000, "32", "N",
     "utterances that may wait on one stream"},
    {"limits.open", "max-open", SETTING_NUMBER, MEMBER(api.open), FOR_DAEMON, 1, 1000, "8", "N",
     "texts that one client may be writing at a time"},
    {"limits.open_seconds", "open-seconds", SETTING_NUMBER, MEMBER(api.open_seconds), FOR_DAEMON, 0, 86400,
     "20", "S", "a text that is being written, and is not for so many seconds, is closed; 0 = never"},
    {"limits.voices", "max-voices", SETTING_NUMBER, MEMBER(heard_most), FOR_DAEMON, 0, 10000, "16", "N",
     "how many people may be heard who speak themselves"},
    {"limits.voice_seconds", "voice-seconds", SETTING_NUMBER, MEMBER(heard_seconds), FOR_DAEMON, 1, 60, "2",
     "S", "where so many seconds of somebody's voice wait, all but the last 0.2 s is left out"},
    {"limits.connections", "max-connections", SETTING_NUMBER, MEMBER(api.http.connections), FOR_DAEMON, 1,
     100000, "1000", "N", "how many connections may be open"},
    {"limits.rooms", "max-rooms", SETTING_NUMBER, MEMBER(api.rooms.rooms), FOR_DAEMON, 1, 100000, "100", "N",
     "how many rooms may have somebody in them"},
    {"limits.address_rooms", "max-rooms-per-address", SETTING_NUMBER, MEMBER(api.rooms.address_rooms),
     FOR_DAEMON, 0, 100000, "25", "N",
     "how many of them one address, or one token's subject, may have made; 0 = no limit of its own"},
    {"limits.address_voices", "max-voices-per-address", SETTING_NUMBER, MEMBER(heard_address), FOR_DAEMON, 0,
     10000, "8", "N", "how many people of one address or subject may be heard; 0 = no limit of its own"},
    {"limits.address_connections", "max-per-address", SETTING_NUMBER, MEMBER(api.http.address_connections),
     FOR_DAEMON, 0, 100000, "250", "N",
     "how many of one address, or of one token's subject, on all daemons of a cluster; 0 = no limit of its "
     "own"},
    {"limits.address_requests", "max-requests", SETTING_NUMBER, MEMBER(api.address_requests), FOR_DAEMON, 0,
     1000000, "1200", "N",
     "utterances and POSTs of one address or subject in a minute, on all daemons of a cluster; 0 = no limit"},
    {"limits.send_bytes", "send-bytes", SETTING_NUMBER, MEMBER(api.http.send_bytes), FOR_DAEMON, 4096,
     1 << 30, "262144", "N", "media for a client wait while so many bytes are unsent"},
    {"limits.send_bytes_max", "send-bytes-max", SETTING_NUMBER, MEMBER(api.http.send_bytes_max), FOR_DAEMON,
     65536, 1 << 30, "4194304", "N", "a client with so many unsent bytes is closed as too slow"},
    {"limits.lag_seconds", "lag-seconds", SETTING_NUMBER, MEMBER(api.lag_seconds), FOR_DAEMON, 1, 3600, "5",
     "N", "in a room, media that have waited for so many seconds are left out"},
    {"limits.stall_seconds", "stall-seconds", SETTING_NUMBER, MEMBER(api.http.stall_seconds), FOR_DAEMON, 1,
     3600, "10", "N", "a client that takes nothing for so many seconds is closed"},
    {"limits.ping_seconds", "ping-seconds", SETTING_NUMBER, MEMBER(api.http.ping_seconds), FOR_DAEMON, 1,
     3600, "30", "N",
     "a socket that is silent for so many seconds is pinged, and closed when it stays silent for a third "
     "longer"},
    {"limits.stop_seconds", "stop-seconds", SETTING_NUMBER, MEMBER(stop_seconds), FOR_DAEMON, 0, 3600, "5",
     "N", "after SIGTERM, speech may go on for so many seconds"},
    {"limits.hold_seconds", "hold", SETTING_NUMBER, MEMBER(api.rooms.hold_seconds), FOR_DAEMON, 0, 86400, "0",
     "S", "what is said over HTTP to an empty room waits so many seconds for somebody to join"},
    {"library.align_percent", "library-align", SETTING_NUMBER, MEMBER(align_percent), FOR_DAEMON, 0, 100,
     "50", "N",
     "recordings of the library are aligned to their texts in the background, by so many per cent of one "
     "processor at most, and only by what nobody else wants; 0 = when their voice is asked for"},
    {"library.ahead", "library-ahead", SETTING_STRING, MEMBER(ahead), FOR_DAEMON, 0, 0, NULL, "VOICE",
     "the library's works in this voice's language are spoken ahead while it has nothing else to do, and "
     "kept "
     "as finished sentences are: what is asked for later is heard at once"},
    {"library.ahead_megabytes", "library-ahead-size", SETTING_MEGABYTES, MEMBER(ahead_bytes), FOR_DAEMON, 0,
     1048576, "0", "N",
     "so many megabytes of sound at most; 0 = three quarters of what is kept of finished sentences"},
    {"log.format", "log", SETTING_CHOICE, MEMBER(log_format), FOR_BOTH, 0, 0, "text", "text|json",
     "how log lines look"},
    {"paths.models", "models", SETTING_STRING, MEMBER(models), FOR_BOTH, 0, 0, NULL, "DIR",
     "heads and language packs"},
    {"paths.web", "web", SETTING_STRING, MEMBER(api.web), FOR_BOTH, 0, 0, NULL, "DIR",
     "the page and its scripts"},
    {"paths.media", "media", SETTING_FOLDER, MEMBER(api.media), FOR_DAEMON, 0, 0, NULL, "DIR",
     "recordings that may be played: .fap files with their sound"},
    {"paths.scenes", "scenes", SETTING_FOLDER, MEMBER(api.scenes), FOR_DAEMON, 0, 0, NULL, "DIR",
     "scenes that operators keep: who may operate changes them"},
    {"paths.reports", "reports", SETTING_FOLDER, MEMBER(api.reports), FOR_DAEMON, 0, 0, NULL, "DIR",
     "words that readers of the library report as misread, for who may operate; without it nothing can be "
     "reported"},
    {"paths.plugins", "plugins", SETTING_STRING, MEMBER(voices.plugin_dir), FOR_BOTH, 0, 0, NULL, "DIR",
     "voice plugins"},
    {"paths.worker", "worker", SETTING_STRING, MEMBER(voices.worker), FOR_BOTH, 0, 0, NULL, "FILE",
     "the program that runs voice plugins"},
    {"paths.gestures", "gestures", SETTING_FOLDER, MEMBER(gestures), FOR_BOTH, 0, 0, NULL, "DIR",
     "gestures of your own, as the Face Player writes them, besides those of the models"},
    {"paths.library", "library", SETTING_FOLDER, MEMBER(library), FOR_DAEMON, 0, 0, NULL, "DIR",
     "works that may be read, searched and heard: TEI, EPUB, Markdown, text, APML, JSML, SSML"},
    {"paths.library_index", "library-index", SETTING_STRING, MEMBER(index), FOR_DAEMON, 0, 0, NULL, "FILE",
     "the index of the library, made when it is not there; without it, a file in the cache folder: that of "
     "systemd, or faccia/ in $XDG_CACHE_HOME or ~/.cache"},
    {"paths.lexicons", "lexicons", SETTING_FOLDER, MEMBER(lexicon_folder), FOR_BOTH, 0, 0, NULL, "DIR",
     "pronunciations that texts may name (SSML's lexicon): its .pls files"},
    {"paths.audio", "audio", SETTING_FOLDER, MEMBER(sounds), FOR_BOTH, 0, 0, NULL, "DIR",
     "sound files that texts may name (SSML's audio)"},
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
