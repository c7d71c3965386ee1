/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What was asked for in a branch, and has been taken by the home, until its end comes from there: when the
 * home is lost, so are those that waited. Each has its end told by the daemon at which it was asked for. */
#include "server/base/mem.h"
#include "server/net/homes_internal.h"
#include <stdlib.h>

struct waiting {
    struct waiting *next;
    uint32_t utterance;
    char *id; /* or NULL */
};

void home_waits(struct home *h, uint32_t utterance, const char *id) {
    struct waiting **at = &h->waiting;
    while (*at)
        at = &(*at)->next;
    *at = mem_alloc(sizeof **at);
    **at = (struct waiting){.utterance = utterance, .id = id ? mem_strdup(id) : NULL};
}

static void drop(struct waiting **at) {
    struct waiting *w = *at;
    *at = w->next;
    free(w->id);
    free(w);
}

void home_waits_no_more(struct home *h, uint32_t utterance) {
    for (struct waiting **at = &h->waiting; *at; at = &(*at)->next)
        if ((*at)->utterance == utterance) {
            drop(at);
            return;
        }
}

void home_waits_in_vain(struct home *h, const struct error *e) {
    while (h->waiting) {
        struct stream_event event = {.kind = STREAM_ERROR,
                                     .utterance = h->waiting->utterance,
                                     .id = h->waiting->id,
                                     .error = e,
                                     .reason = "failed",
                                     .idle = -1};
        if (e)
            channel_sink.event(h->channel, &event);
        event.kind = STREAM_END;
        if (e)
            channel_sink.event(h->channel, &event);
        drop(&h->waiting);
    }
}
