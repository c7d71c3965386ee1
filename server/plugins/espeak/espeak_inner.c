/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/plugins/espeak/espeak_inner.h"

struct faccia_sentence es_inner_part(const struct faccia_sentence *sentence) {
    const struct faccia_span *spans = sentence->spans;
    size_t begin = 0, end = 0, text = 0, last = 0;
    while (text < sentence->span_count && spans[text].kind != FACCIA_SPAN_TEXT)
        text++;
    for (size_t i = 0; i < sentence->span_count; i++) {
        if (spans[i].kind == FACCIA_SPAN_BREAK && i < text)
            begin = i + 1;
        if (spans[i].kind == FACCIA_SPAN_TEXT)
            last = i;
    }
    if (text == sentence->span_count)
        return (struct faccia_sentence){.voice = sentence->voice, .spans = spans + text};
    for (end = last + 1; end < sentence->span_count && spans[end].kind != FACCIA_SPAN_BREAK;)
        end++;
    return (struct faccia_sentence){
        .voice = sentence->voice, .spans = spans + begin, .span_count = end - begin};
}
