/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How a sentence is cut: Kokoro hands out nothing before it has finished a piece, so the first is short and
 * the later ones grow; they end at stops where there are any, as its intonation belongs to the piece. */
#ifndef FACCIA_PLUGINS_KOKORO_KOKORO_PIECES_H
#define FACCIA_PLUGINS_KOKORO_KOKORO_PIECES_H

#include "server/plugins/kokoro/kokoro_tokens.h"

/* Where the piece that begins at from ends: behind a stop or a space, or at the end. changes(ctx, a, b): must
 * the words a and b be in different pieces? from < items->count; the result is greater. */
size_t ko_cut(const struct ko_items *items, size_t from, bool (*changes)(void *ctx, uint32_t a, uint32_t b),
              void *ctx);

#endif
