/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/cluster/board.h"
#include <stddef.h>

void board_look(struct board *board, const struct board_eye *eye, void *ctx) {
    board->engine->look(board, eye, ctx);
}

void board_write(struct board *board, const char *name, const char *text) {
    board->engine->write(board, name, text);
}

void board_mark(struct board *board, const char *name, uint64_t until) {
    board->engine->mark(board, name, until);
}

void board_close(struct board *board) {
    if (board)
        board->engine->close(board);
}
