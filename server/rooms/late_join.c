/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A channel's state for late joiners: the utterance in progress, and the current notices. */
#include "server/base/mem.h"
#include "server/rooms/rooms_internal.h"
#include <stdlib.h>

static void replace(struct queued_message **place, struct queued_message *message) {
    queued_message_release(*place);
    *place = message;
    if (message)
        message->refs++;
}

static void forget_sentence(struct late_join *late_join) {
    while (late_join->text_count)
        queued_message_release(late_join->texts[--late_join->text_count]);
}

static void keep(struct late_join *late_join, struct queued_message *message) {
    if (late_join->text_count == LATE_JOIN_TEXTS)
        return;
    late_join->texts = mem_grow(late_join->texts, &late_join->text_cap, late_join->text_count + 1,
                                sizeof(struct queued_message *));
    late_join->texts[late_join->text_count++] = message;
    message->refs++;
}

void late_join_event(struct late_join *late_join, enum stream_event_kind kind, uint32_t utterance,
                     uint64_t command, struct queued_message *message) {
    switch (kind) {
    case STREAM_PAUSED:
        replace(&late_join->paused, message);
        break;
    case STREAM_RESUMED:
        replace(&late_join->paused, NULL);
        break;
    case STREAM_BEGIN:
    case STREAM_END:
        if (kind == STREAM_END && utterance != late_join->utterance)
            break;
        forget_sentence(late_join);
        replace(&late_join->begin, kind == STREAM_BEGIN ? message : NULL);
        late_join->utterance = kind == STREAM_BEGIN ? utterance : 0;
        late_join->command = kind == STREAM_BEGIN ? command : 0;
        break;
    case STREAM_SENTENCE:
        forget_sentence(late_join);
        keep(late_join, message);
        break;
    case STREAM_SPEAKER:
    case STREAM_WORD:
    case STREAM_MARK:
        keep(late_join, message);
        break;
    default:
        break;
    }
}

void late_join_tell(const struct late_join *late_join,
                    void (*tell)(void *ctx, struct queued_message *message), void *ctx) {
    if (late_join->begin)
        tell(ctx, late_join->begin);
    for (size_t i = 0; i < late_join->text_count; i++)
        tell(ctx, late_join->texts[i]);
    if (late_join->paused)
        tell(ctx, late_join->paused);
}

void late_join_free(struct late_join *late_join) {
    forget_sentence(late_join);
    replace(&late_join->begin, NULL);
    replace(&late_join->paused, NULL);
    free(late_join->texts);
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

void notice_board_lexicon(struct notice_board *board, struct queued_message *message) {
    replace(&board->lexicon, message);
}

void notice_board_head(struct notice_board *board, struct queued_message *message) {
    replace(&board->head, message);
}

void notice_board_driven(struct notice_board *board, struct queued_message *message) {
    replace(&board->driven, message);
}

void notice_board_backdrop(struct notice_board *board, struct queued_message *message) {
    replace(&board->backdrop, message);
}

void notice_board_consent(struct notice_board *board, struct queued_message *message, json_t *asked) {
    replace(&board->consent, message);
    json_decref(board->asked);
    board->asked = json_incref(asked);
}

void notice_board_tell(const struct notice_board *board,
                       void (*tell)(void *ctx, struct queued_message *message), void *ctx) {
    if (board->head)
        tell(ctx, board->head);
    if (board->calibration)
        tell(ctx, board->calibration);
    if (board->mood)
        tell(ctx, board->mood);
    if (board->lexicon)
        tell(ctx, board->lexicon);
    if (board->backdrop)
        tell(ctx, board->backdrop);
    if (board->driven)
        tell(ctx, board->driven);
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
    notice_board_lexicon(board, NULL);
    notice_board_head(board, NULL);
    notice_board_driven(board, NULL);
    notice_board_backdrop(board, NULL);
    notice_board_consent(board, NULL, NULL);
}
