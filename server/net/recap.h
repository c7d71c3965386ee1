/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What one who comes late to a channel has to be told: the utterance that is spoken, its sentence, the words
 * and marks of that so far, and whether all is paused. */
#ifndef FACCIA_NET_RECAP_H
#define FACCIA_NET_RECAP_H

#include "server/net/outbox.h"
#include "server/stream/stream.h"

/* Zeroed: nothing is said. Holds references to the parcels. */
struct recap {
    struct parcel *begin, *paused; /* NULL: none */
    struct parcel **texts;         /* at most RECAP_TEXTS: the sentence, then its words and marks */
    size_t text_count, text_cap;
};

enum { RECAP_TEXTS = 512 };

/* An event of that kind was told in that message. */
void recap_event(struct recap *recap, enum stream_event_kind kind, struct parcel *parcel);

void recap_tell(const struct recap *recap, void (*tell)(void *ctx, struct parcel *parcel), void *ctx);

void recap_free(struct recap *recap);

#endif
