/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a synthesis can be asked. */
#include "server/synthesis/synthesis_internal.h"
#include <string.h>

bool synthesis_is_read(const struct synthesis *s) {
    return s->score;
}

bool synthesis_find_mark(const struct synthesis *s, const char *name, size_t *sentence) {
    for (size_t i = 0; i < synthesis_sentences(s); i++) {
        const struct score_sentence *in = &s->score->sentences[i];
        for (size_t k = in->first; k < in->first + in->count; k++)
            if (s->score->items[k].kind == SCORE_MARK && !strcmp(s->score->items[k].text, name)) {
                *sentence = i;
                return true;
            }
    }
    return false;
}

void synthesis_near_marks(const struct synthesis *s, struct suggestions *near) {
    for (size_t i = 0; s->score && i < s->score->item_count; i++)
        if (s->score->items[i].kind == SCORE_MARK)
            suggest_name(near, s->score->items[i].text, s->score->items[i].text);
}

size_t synthesis_sentences(const struct synthesis *s) {
    return s->score ? s->score->sentence_count : 0;
}

size_t synthesis_next(const struct synthesis *s) {
    return s->delivered;
}

const char *synthesis_entry(const struct synthesis *s) {
    return s->entry;
}

const struct voice *synthesis_voice(const struct synthesis *s) {
    return s->voice;
}

const char *synthesis_lang(const struct synthesis *s) {
    return speech_pack_is_general(s->pack) ? s->voice->lang : speech_pack_lang(s->pack);
}

const char *synthesis_engine(const struct synthesis *s) {
    return s->request.engine ? s->request.engine : face_engines()[0];
}

const char *synthesis_markup(const struct synthesis *s) {
    return s->markup->name;
}

const struct speech_request *synthesis_request(const struct synthesis *s) {
    return &s->request;
}
