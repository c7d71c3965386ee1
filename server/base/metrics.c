/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/metrics.h"
#include <string.h>

/* Metrics with the same name must be adjacent; their labels differ. */
static const struct {
    const char *name, *label, *type, *help;
} table[METRICS] = {
    [METRIC_CONNECTIONS] = {"faccia_connections", "", "gauge", "Open connections."},
    [METRIC_CONNECTIONS_TOTAL] = {"faccia_connections_total", "", "counter", "Connections accepted."},
    [METRIC_REFUSED_LIMIT] = {"faccia_refused_total", "{why=\"limit\"}", "counter",
                              "Connections and requests refused."},
    [METRIC_REFUSED_ORIGIN] = {"faccia_refused_total", "{why=\"origin\"}", "counter", ""},
    [METRIC_REFUSED_TOKEN] = {"faccia_refused_total", "{why=\"token\"}", "counter", ""},
    [METRIC_TOO_SLOW] = {"faccia_too_slow_total", "", "counter",
                         "Clients closed because they did not read their media."},
    [METRIC_REQUESTS] = {"faccia_http_requests_total", "", "counter", "HTTP requests."},
    [METRIC_UTTERANCES_DONE] = {"faccia_utterances_total", "{end=\"done\"}", "counter",
                                "Utterances, by how they ended."},
    [METRIC_UTTERANCES_STOPPED] = {"faccia_utterances_total", "{end=\"stopped\"}", "counter", ""},
    [METRIC_UTTERANCES_FAILED] = {"faccia_utterances_total", "{end=\"failed\"}", "counter", ""},
    [METRIC_SENTENCES_ASKED] = {"faccia_sentences_asked_total", "", "counter",
                                "Sentences requested from the voices."},
    [METRIC_SENTENCES] = {"faccia_sentences_total", "{result=\"spoken\"}", "counter",
                          "Sentences returned by the voices."},
    [METRIC_SENTENCES_FAILED] = {"faccia_sentences_total", "{result=\"failed\"}", "counter", ""},
    [METRIC_SPEECH_SECONDS] = {"faccia_speech_seconds_total", "", "counter", "Seconds of speech sent."},
    [METRIC_CHUNKS] = {"faccia_chunks_total", "", "counter", "Media chunks encoded."},
    [METRIC_AUDIO_BYTES] = {"faccia_media_bytes_total", "{kind=\"audio\"}", "counter",
                            "Bytes of media chunks encoded."},
    [METRIC_FAP_BYTES] = {"faccia_media_bytes_total", "{kind=\"fap\"}", "counter", ""},
    [METRIC_SENT_BYTES] = {"faccia_sent_bytes_total", "", "counter", "Bytes sent to WebSocket clients."},
    [METRIC_ROOMS] = {"faccia_rooms", "", "gauge", "Rooms with at least one client."},
    [METRIC_CACHE_HITS] = {"faccia_cache_total", "{result=\"hit\"}", "counter",
                           "Sentences looked up in the cache."},
    [METRIC_CACHE_MISSES] = {"faccia_cache_total", "{result=\"miss\"}", "counter", ""},
    [METRIC_CLUSTER_UP] = {"faccia_cluster_up", "", "gauge", "1 if the cluster's shared store is reachable."},
    [METRIC_CLUSTER_HITS] =
        {"faccia_cluster_sentences_total", "{result=\"hit\"}", "counter",
         "Sentences requested from the shared cache; waited: another daemon was producing it."},
    [METRIC_CLUSTER_MISSES] = {"faccia_cluster_sentences_total", "{result=\"miss\"}", "counter", ""},
    [METRIC_CLUSTER_WAITS] = {"faccia_cluster_sentences_total", "{result=\"waited\"}", "counter", ""},
    [METRIC_BUS_UP] = {"faccia_bus_up", "", "gauge", "1 if the daemons of the cluster can reach each other."},
    [METRIC_BUS_SENT] =
        {"faccia_bus_messages_total", "{way=\"sent\"}", "counter",
         "Messages between the daemons of a cluster; a message to several daemons counts once for each."},
    [METRIC_BUS_HEARD] = {"faccia_bus_messages_total", "{way=\"heard\"}", "counter", ""},
    [METRIC_ROOMS_LED] = {"faccia_cluster_rooms", "{role=\"leader\"}", "gauge",
                          "Rooms of a cluster, by the role of this daemon; unshared: without the bus, each "
                          "daemon leads its own."},
    [METRIC_ROOMS_REPLICATED] = {"faccia_cluster_rooms", "{role=\"replica\"}", "gauge", ""},
    [METRIC_ROOMS_UNSHARED] = {"faccia_cluster_rooms", "{role=\"unshared\"}", "gauge", ""},
    [METRIC_PRESENCE_UP] = {"faccia_presence_up", "", "gauge",
                            "1 if the daemons of the cluster share the limits of addresses and subjects."},
    [METRIC_CLUSTER_MISMATCHED] =
        {"faccia_cluster_mismatched", "", "gauge",
         "Other daemons of the cluster whose version or limits differ from this one's."},
    [METRIC_CLUSTER_QUEUE_LIVE] =
        {"faccia_cluster_queue_sentences", "{priority=\"live\"}", "gauge",
         "Sentences of all daemons that are queued for remote workers or being spoken by them."},
    [METRIC_CLUSTER_QUEUE_AHEAD] = {"faccia_cluster_queue_sentences", "{priority=\"ahead\"}", "gauge", ""},
    [METRIC_SOUND_LEVEL] =
        {"faccia_sound_level", "", "gauge",
         "Degradation level of the audio encoder: 0 is the best quality; higher levels take less time."},
};

static const double bounds[METRIC_BUCKETS] = {0.001, 0.0025, 0.005, 0.01, 0.025, 0.05, 0.1, 0.5, 2, 10};

void metrics_add(struct metrics *metrics, enum metric metric, double by) {
    if (metrics)
        metrics->values[metric] += by;
}

void metrics_first_media(struct metrics *metrics, double seconds) {
    int bucket = 0;
    if (!metrics)
        return;
    while (bucket < METRIC_BUCKETS && seconds > bounds[bucket])
        bucket++;
    metrics->first_media[bucket]++;
    metrics->first_media_sum += seconds;
}

static void write_head(struct buf *out, const char *name, const char *type, const char *help) {
    buf_printf(out, "# HELP %s %s\n# TYPE %s %s\n", name, help, name, type);
}

void metrics_write(const struct metrics *metrics, struct buf *out) {
    static const char histogram[] = "faccia_first_media_seconds";
    for (int i = 0; i < METRICS; i++) {
        if (*table[i].help)
            write_head(out, table[i].name, table[i].type, table[i].help);
        buf_printf(out, "%s%s %.15g\n", table[i].name, table[i].label, metrics->values[i]);
    }
    write_head(out, histogram, "histogram", "Time from an utterance's request to its first media.");
    unsigned long count = 0;
    for (int i = 0; i < METRIC_BUCKETS; i++) {
        count += metrics->first_media[i];
        buf_printf(out, "%s_bucket{le=\"%g\"} %lu\n", histogram, bounds[i], count);
    }
    count += metrics->first_media[METRIC_BUCKETS];
    buf_printf(out, "%s_bucket{le=\"+Inf\"} %lu\n%s_sum %.9g\n%s_count %lu\n", histogram, count, histogram,
               metrics->first_media_sum, histogram, count);
}
