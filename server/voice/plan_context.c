/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/buf.h"
#include "server/voice/plan.h"
#include <stdlib.h>
#include <string.h>

#define SPACES " \n\t\r"

static const char *text_of(const struct score_item *item) {
    return item->kind == SCORE_TEXT && item->text ? item->text : "";
}

/* The items [from, to) as text; `sentence` is where the first one lies. Sentences do not run together. */
static char *text_between(const struct score *score, size_t sentence, size_t from, size_t to) {
    struct buf b = {0};
    for (size_t i = from; i < to; i++) {
        while (sentence + 1 < score->sentence_count && i >= score->sentences[sentence + 1].first) {
            sentence++;
            buf_add(&b, " ", 1);
        }
        buf_add(&b, text_of(&score->items[i]), strlen(text_of(&score->items[i])));
    }
    buf_add(&b, "", 1);
    return (char *)b.data;
}

/* What is too long loses its first words. */
static void keep_end(char *text) {
    size_t length = strlen(text);
    if (length <= PLAN_CONTEXT_BYTES)
        return;
    size_t from = length - PLAN_CONTEXT_BYTES;
    from += strcspn(text + from, SPACES);
    memmove(text, text + from, length - from + 1);
}

static void keep_beginning(char *text) {
    size_t to = PLAN_CONTEXT_BYTES;
    if (strlen(text) <= to)
        return;
    while (to && !strchr(SPACES, text[to]))
        to--;
    text[to] = '\0';
}

static char *or_none(char *text) {
    if (text[strspn(text, SPACES)])
        return text;
    free(text);
    return NULL;
}

void plan_context(struct plan *plan, const struct score *score, size_t sentence, size_t first, size_t count) {
    size_t from = first, to = first + count, earlier = sentence;
    /* items, too, are counted: of a thousand marks none has a text */
    for (size_t bytes = 0; from && bytes <= PLAN_CONTEXT_BYTES && first - from < PLAN_CONTEXT_BYTES;)
        bytes += strlen(text_of(&score->items[--from]));
    for (size_t bytes = 0;
         to < score->item_count && bytes <= PLAN_CONTEXT_BYTES && to - first - count < PLAN_CONTEXT_BYTES;)
        bytes += strlen(text_of(&score->items[to++]));
    while (earlier && score->sentences[earlier].first > from)
        earlier--;
    plan->before = text_between(score, earlier, from, first);
    plan->after = text_between(score, sentence, first + count, to);
    keep_end(plan->before);
    keep_beginning(plan->after);
    plan->before = or_none(plan->before);
    plan->after = or_none(plan->after);
}
