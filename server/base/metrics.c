/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/metrics.h"
#include <string.h>

/* Metrics with the same name must be adjacent; their labels differ. */
static const struct {
    const char *name, *label, *type, *help;
} table[METRICS] = {
    [METRIC_CONNECTIONS] = {"faccia_connections", "", "gauge", "Open connections."},
    [METRIC_CONNECTIONS_TOTAL] = {"faccia_connections_total", "", "counter", "Connections that were let in."},
    [METRIC_REFUSED_LIMIT] = {"faccia_refused_total", "{why=\"limit\"}", "counter",
                              "Connections and requests that were turned away."},
    [METRIC_REFUSED_ORIGIN] = {"faccia_refused_total", "{why=\"origin\"}", "counter", ""},
    [METRIC_REFUSED_TOKEN] = {"faccia_refused_total", "{why=\"token\"}", "counter", ""},
    [METRIC_TOO_SLOW] = {"faccia_too_slow_total", "", "counter",
                         "Clients that were closed because they did not take their media."},
    [METRIC_REQUESTS] = {"faccia_http_requests_total", "", "counter", "HTTP requests."},
    [METRIC_UTTERANCES_DONE] = {"faccia_utterances_total", "{end=\"done\"}", "counter",
                                "Utterances by how they ended."},
    [METRIC_UTTERANCES_STOPPED] = {"faccia_utterances_total", "{end=\"stopped\"}", "counter", ""},
    [METRIC_UTTERANCES_FAILED] = {"faccia_utterances_total", "{end=\"failed\"}", "counter", ""},
    [METRIC_SENTENCES_ASKED] = {"faccia_sentences_asked_total", "", "counter",
                                "Sentences asked of the voices."},
    [METRIC_SENTENCES] = {"faccia_sentences_total", "{result=\"spoken\"}", "counter",
                          "Sentences that came back from the voices."},
    [METRIC_SENTENCES_FAILED] = {"faccia_sentences_total", "{result=\"failed\"}", "counter", ""},
    [METRIC_SPEECH_SECONDS] = {"faccia_speech_seconds_total", "", "counter",
                               "Seconds of speech that were sent."},
    [METRIC_CHUNKS] = {"faccia_chunks_total", "", "counter", "Media chunks that were made."},
    [METRIC_AUDIO_BYTES] = {"faccia_media_bytes_total", "{kind=\"audio\"}", "counter",
                            "Bytes of the media chunks that were made."},
    [METRIC_FAP_BYTES] = {"faccia_media_bytes_total", "{kind=\"fap\"}", "counter", ""},
    [METRIC_SENT_BYTES] = {"faccia_sent_bytes_total", "", "counter", "Bytes sent to WebSocket clients."},
    [METRIC_ROOMS] = {"faccia_rooms", "", "gauge", "Rooms that have somebody in them."},
    [METRIC_CACHE_HITS] = {"faccia_cache_total", "{result=\"hit\"}", "counter",
                           "Sentences looked up in the cache."},
    [METRIC_CACHE_MISSES] = {"faccia_cache_total", "{result=\"miss\"}", "counter", ""},
    [METRIC_CLUSTER_UP] = {"faccia_cluster_up", "", "gauge", "1: what the daemons share can be reached."},
    [METRIC_CLUSTER_HITS] = {"faccia_cluster_sentences_total", "{result=\"hit\"}", "counter",
                             "Sentences that other daemons were asked for; waited: one was making it."},
    [METRIC_CLUSTER_MISSES] = {"faccia_cluster_sentences_total", "{result=\"miss\"}", "counter", ""},
    [METRIC_CLUSTER_WAITS] = {"faccia_cluster_sentences_total", "{result=\"waited\"}", "counter", ""},
    [METRIC_BUS_UP] = {"faccia_bus_up", "", "gauge",
                       "1: the daemons of the cluster can speak to each other."},
    [METRIC_BUS_SENT] = {"faccia_bus_messages_total", "{way=\"sent\"}", "counter",
                         "Messages between the daemons of a cluster; one to several counts for each."},
    [METRIC_BUS_HEARD] = {"faccia_bus_messages_total", "{way=\"heard\"}", "counter", ""},
    [METRIC_ROOMS_HERE] = {"faccia_cluster_rooms", "{home=\"here\"}", "gauge",
                           "Rooms of a cluster by which daemon speaks in them; alone: each for its own."},
    [METRIC_ROOMS_ELSEWHERE] = {"faccia_cluster_rooms", "{home=\"elsewhere\"}", "gauge", ""},
    [METRIC_ROOMS_ALONE] = {"faccia_cluster_rooms", "{home=\"alone\"}", "gauge", ""},
    [METRIC_BOARD_UP] = {"faccia_board_up", "", "gauge",
                         "1: the daemons of the cluster count together what addresses and subjects ask."},
    [METRIC_CLUSTER_OTHERWISE] = {"faccia_cluster_otherwise", "", "gauge",
                                  "Other daemons of the cluster whose version or limits are not this one's."},
    [METRIC_CLUSTER_QUEUE_LIVE] =
        {"faccia_cluster_queue_sentences", "{turn=\"live\"}", "gauge",
         "Sentences of all daemons that wait for workers elsewhere, or are spoken there."},
    [METRIC_CLUSTER_QUEUE_AHEAD] = {"faccia_cluster_queue_sentences", "{turn=\"ahead\"}", "gauge", ""},
    [METRIC_SOUND_LEVEL] =
        {"faccia_sound_level", "", "gauge",
         "Level of the sound's coding: 0 is the best, more is plainer and takes less time."},
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
    write_head(out, histogram, "histogram", "From an utterance's request to its first media.");
    unsigned long count = 0;
    for (int i = 0; i < METRIC_BUCKETS; i++) {
        count += metrics->first_media[i];
        buf_printf(out, "%s_bucket{le=\"%g\"} %lu\n", histogram, bounds[i], count);
    }
    count += metrics->first_media[METRIC_BUCKETS];
    buf_printf(out, "%s_bucket{le=\"+Inf\"} %lu\n%s_sum %.9g\n%s_count %lu\n", histogram, count, histogram,
               metrics->first_media_sum, histogram, count);
}
