/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Counters of the daemon, reported in Prometheus' text format (version 0.0.4). */
#ifndef FACCIA_BASE_METRICS_H
#define FACCIA_BASE_METRICS_H

#include "server/base/buf.h"
#include <stddef.h>

/* In the order of the table in metrics.c. */
enum metric {
    METRIC_CONNECTIONS,
    METRIC_CONNECTIONS_TOTAL,
    METRIC_REFUSED_LIMIT,
    METRIC_REFUSED_ORIGIN,
    METRIC_REFUSED_TOKEN,
    METRIC_TOO_SLOW,
    METRIC_REQUESTS,
    METRIC_UTTERANCES_DONE,
    METRIC_UTTERANCES_STOPPED,
    METRIC_UTTERANCES_FAILED,
    METRIC_SENTENCES_ASKED,
    METRIC_SENTENCES,
    METRIC_SENTENCES_FAILED,
    METRIC_SPEECH_SECONDS,
    METRIC_CHUNKS,
    METRIC_AUDIO_BYTES,
    METRIC_FAP_BYTES,
    METRIC_SENT_BYTES,
    METRIC_ROOMS,
    METRIC_CACHE_HITS,
    METRIC_CACHE_MISSES,
    METRIC_CLUSTER_UP,
    METRIC_CLUSTER_HITS,
    METRIC_CLUSTER_MISSES,
    METRIC_CLUSTER_WAITS,
    METRIC_BUS_UP,
    METRIC_BUS_SENT,
    METRIC_BUS_HEARD,
    METRIC_ROOMS_LED,
    METRIC_ROOMS_REPLICATED,
    METRIC_ROOMS_UNSHARED,
    METRIC_PRESENCE_UP,
    METRIC_CLUSTER_MISMATCHED,
    METRIC_CLUSTER_QUEUE_LIVE,
    METRIC_CLUSTER_QUEUE_AHEAD,
    METRIC_SOUND_LEVEL,
    METRICS,
};

/* Buckets of the histogram of seconds from a request to its first media message. */
enum { METRIC_BUCKETS = 10 };

struct metrics {
    double values[METRICS];
    double first_media_sum;
    unsigned long first_media[METRIC_BUCKETS + 1]; /* not cumulative; the last bucket has no upper bound */
};

/* metrics may be NULL. */
void metrics_add(struct metrics *metrics, enum metric metric, double by);
void metrics_first_media(struct metrics *metrics, double seconds);

void metrics_write(const struct metrics *metrics, struct buf *out);

#endif
