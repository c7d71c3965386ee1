/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/net/notice_board.h"

static void replace(struct queued_message **place, struct queued_message *message) {
    queued_message_release(*place);
    *place = message;
    if (message)
        message->refs++;
}

void notice_board_choices(struct notice_board *board, struct queued_message *message, json_t *offered) {
    replace(&board->choices, message);
    json_decref(board->offered);
    board->offered = json_incref(offered);
}

void notice_board_state(struct notice_board *board, struct queued_message *message) {
    replace(&board->state, message);
}

void notice_board_calibration(struct notice_board *board, struct queued_message *message) {
    replace(&board->calibration, message);
}

void notice_board_mood(struct notice_board *board, struct queued_message *message) {
    replace(&board->mood, message);
}

void notice_board_consent(struct notice_board *board, struct queued_message *message, json_t *asked) {
    replace(&board->consent, message);
    json_decref(board->asked);
    board->asked = json_incref(asked);
}

void notice_board_tell(const struct notice_board *board,
                       void (*tell)(void *ctx, struct queued_message *message), void *ctx) {
    if (board->calibration)
        tell(ctx, board->calibration);
    if (board->mood)
        tell(ctx, board->mood);
    if (board->consent)
        tell(ctx, board->consent);
    if (board->state)
        tell(ctx, board->state);
    if (board->choices)
        tell(ctx, board->choices);
}

void notice_board_free(struct notice_board *board) {
    notice_board_choices(board, NULL, NULL);
    notice_board_state(board, NULL);
    notice_board_calibration(board, NULL);
    notice_board_mood(board, NULL);
    notice_board_consent(board, NULL, NULL);
}
