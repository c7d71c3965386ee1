/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/plugins/kokoro/kokoro_pieces.h"

/* Tokens: what makes a piece long enough to sound natural, and how long it may get before it is cut at a stop
 * and, without any, at a space. One token is about 60 ms of speech. */
static const struct { size_t enough, stop, space; } first_piece = {12, 90, 160}, later_piece = {40, 150, 300};

size_t ko_cut(const struct ko_items *items, size_t from, bool (*changes)(void *ctx, uint32_t a, uint32_t b),
              void *ctx) {
    size_t tokens = 0, stop = 0, space = 0, i;
    size_t enough = from ? later_piece.enough : first_piece.enough;
    size_t stop_limit = from ? later_piece.stop : first_piece.stop;
    size_t space_limit = from ? later_piece.space : first_piece.space;
    for (i = from; i < items->count; i++) {
        const struct ko_item *item = &items->list[i];
        if (i > from && item->kind == KO_PHONE && changes(ctx, item[-1].word, item->word))
            return i;
        if (tokens + item->token_count > (stop ? stop_limit : space_limit))
            return stop ? stop : space ? space : i;
        tokens += item->token_count;
        if (item->kind != KO_PHONE)
            space = i + 1;
        if (item->kind == KO_STOP && tokens >= enough) {
            stop = i + 1;
            if (!from)
                return stop;
        }
    }
    return i;
}
