/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What stands in a channel beside what is said, until it is replaced: who comes later is told of it. */
#ifndef FACCIA_NET_NOTICE_BOARD_H
#define FACCIA_NET_NOTICE_BOARD_H

#include "server/net/message_queue.h"
#include <jansson.h>

/* Zeroed: nothing stands there. */
struct notice_board {
    json_t *offered;                        /* the choices, as they were told; NULL: none */
    struct queued_message *choices, *state; /* the last that was told; NULL: none */
    struct queued_message *calibration, *mood;
    json_t *asked; /* whether the listener consents, as it was told; NULL: nothing is asked */
    struct queued_message *consent;
};

/* All take a reference of their own; NULL: nothing stands there any more. */
void notice_board_choices(struct notice_board *board, struct queued_message *message, json_t *offered);
void notice_board_state(struct notice_board *board, struct queued_message *message);
void notice_board_calibration(struct notice_board *board, struct queued_message *message);
void notice_board_mood(struct notice_board *board, struct queued_message *message);
void notice_board_consent(struct notice_board *board, struct queued_message *message, json_t *asked);

void notice_board_tell(const struct notice_board *board,
                       void (*tell)(void *ctx, struct queued_message *message), void *ctx);
void notice_board_free(struct notice_board *board);

#endif
