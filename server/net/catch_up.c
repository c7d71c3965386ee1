/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/net/catch_up.h"
#include "server/base/mem.h"
#include <stdlib.h>

static void replace(struct queued_message **place, struct queued_message *message) {
    queued_message_release(*place);
    *place = message;
    if (message)
        message->refs++;
}

static void forget_sentence(struct catch_up *catch_up) {
    while (catch_up->text_count)
        queued_message_release(catch_up->texts[--catch_up->text_count]);
}

static void keep(struct catch_up *catch_up, struct queued_message *message) {
    if (catch_up->text_count == RECAP_TEXTS)
        return;
    catch_up->texts = mem_grow(catch_up->texts, &catch_up->text_cap, catch_up->text_count + 1,
                               sizeof(struct queued_message *));
    catch_up->texts[catch_up->text_count++] = message;
    message->refs++;
}

void catch_up_event(struct catch_up *catch_up, enum stream_event_kind kind, uint32_t utterance,
                    uint64_t order, struct queued_message *message) {
    switch (kind) {
    case STREAM_PAUSED:
        replace(&catch_up->paused, message);
        break;
    case STREAM_RESUMED:
        replace(&catch_up->paused, NULL);
        break;
    case STREAM_BEGIN:
    case STREAM_END:
        if (kind == STREAM_END && utterance != catch_up->utterance)
            break;
        forget_sentence(catch_up);
        replace(&catch_up->begin, kind == STREAM_BEGIN ? message : NULL);
        catch_up->utterance = kind == STREAM_BEGIN ? utterance : 0;
        catch_up->order = kind == STREAM_BEGIN ? order : 0;
        break;
    case STREAM_SENTENCE:
        forget_sentence(catch_up);
        keep(catch_up, message);
        break;
    case STREAM_WORD:
    case STREAM_MARK:
        keep(catch_up, message);
        break;
    default:
        break;
    }
}

void catch_up_tell(const struct catch_up *catch_up, void (*tell)(void *ctx, struct queued_message *message),
                   void *ctx) {
    if (catch_up->begin)
        tell(ctx, catch_up->begin);
    for (size_t i = 0; i < catch_up->text_count; i++)
        tell(ctx, catch_up->texts[i]);
    if (catch_up->paused)
        tell(ctx, catch_up->paused);
}

void catch_up_free(struct catch_up *catch_up) {
    forget_sentence(catch_up);
    replace(&catch_up->begin, NULL);
    replace(&catch_up->paused, NULL);
    free(catch_up->texts);
}
