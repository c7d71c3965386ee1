/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/net/recap.h"
#include "server/base/mem.h"
#include <stdlib.h>

static void replace(struct parcel **place, struct parcel *parcel) {
    parcel_release(*place);
    *place = parcel;
    if (parcel)
        parcel->refs++;
}

static void forget_sentence(struct recap *recap) {
    while (recap->text_count)
        parcel_release(recap->texts[--recap->text_count]);
}

static void keep(struct recap *recap, struct parcel *parcel) {
    if (recap->text_count == RECAP_TEXTS)
        return;
    recap->texts = mem_grow(recap->texts, &recap->text_cap, recap->text_count + 1, sizeof(struct parcel *));
    recap->texts[recap->text_count++] = parcel;
    parcel->refs++;
}

void recap_event(struct recap *recap, enum stream_event_kind kind, struct parcel *parcel) {
    switch (kind) {
    case STREAM_PAUSED:
        replace(&recap->paused, parcel);
        break;
    case STREAM_RESUMED:
        replace(&recap->paused, NULL);
        break;
    case STREAM_BEGIN:
    case STREAM_END:
        forget_sentence(recap);
        replace(&recap->begin, kind == STREAM_BEGIN ? parcel : NULL);
        break;
    case STREAM_SENTENCE:
        forget_sentence(recap);
        keep(recap, parcel);
        break;
    case STREAM_WORD:
    case STREAM_MARK:
        keep(recap, parcel);
        break;
    default:
        break;
    }
}

void recap_tell(const struct recap *recap, void (*tell)(void *ctx, struct parcel *parcel), void *ctx) {
    if (recap->begin)
        tell(ctx, recap->begin);
    for (size_t i = 0; i < recap->text_count; i++)
        tell(ctx, recap->texts[i]);
    if (recap->paused)
        tell(ctx, recap->paused);
}

void recap_free(struct recap *recap) {
    forget_sentence(recap);
    replace(&recap->begin, NULL);
    replace(&recap->paused, NULL);
    free(recap->texts);
}
