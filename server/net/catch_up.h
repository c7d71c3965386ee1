/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a follower that comes late to a channel has to be told: the utterance that is spoken, its sentence,
 * the words and marks of that so far, and whether all is paused. */
#ifndef FACCIA_NET_CATCH_UP_H
#define FACCIA_NET_CATCH_UP_H

#include "server/net/message_queue.h"
#include "server/stream/stream.h"

/* Zeroed: nothing is said. Holds references to the messages. */
struct catch_up {
    struct queued_message *begin, *paused; /* NULL: none */
    struct queued_message **texts;         /* at most RECAP_TEXTS: the sentence, then its words and marks */
    size_t text_count, text_cap;
    uint32_t utterance; /* of begin */
    uint64_t order;     /* the same (speech_request.h) */
};

enum { RECAP_TEXTS = 512 };

/* An event of that kind was told in that message; of a beginning and an end: which utterance it is of, for
 * others may end while one is spoken; of a beginning: for which order. */
void catch_up_event(struct catch_up *catch_up, enum stream_event_kind kind, uint32_t utterance,
                    uint64_t order, struct queued_message *message);

void catch_up_tell(const struct catch_up *catch_up, void (*tell)(void *ctx, struct queued_message *message),
                   void *ctx);

void catch_up_free(struct catch_up *catch_up);

#endif
