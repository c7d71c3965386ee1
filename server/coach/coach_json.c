/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/sampa.h"
#include "server/base/utf8.h"
#include "server/coach/coach_internal.h"
#include <math.h>

/* Rounded to 0.1 ms. */
static double seconds(double t) {
    return round(t * 1e4) / 1e4;
}

static double hundredths(double x) {
    return round(x * 100) / 100;
}

static json_t *phone_json(const struct coach_model *m, const struct judged_phone *p) {
    const struct reference_phone *model = &m->speech.phones[p->phone];
    const double rate = m->speech.rate;
    char sampa[PHONE_NAME_BYTES];
    sampa_from_ipa(model->ipa, sampa, sizeof sampa);
    json_t *phone =
        json_pack("{ss ss si ss sf sf sf sf sf sf}", "ipa", model->ipa, "sampa", sampa, "stress",
                  model->stress, "state", judge_states[p->state], "score", hundredths(p->score), "length",
                  hundredths(p->length), "start", seconds(p->start), "end", seconds(p->end), "model_start",
                  seconds((double)model->start / rate), "model_end", seconds((double)model->end / rate));
    if (p->word != SIZE_MAX)
        json_object_set_new(phone, "word", json_integer((json_int_t)p->word));
    if (p->expected != LIP_SILENCE) {
        json_object_set_new(phone, "class", json_string(lip_classes[p->expected].name));
        json_object_set_new(phone, "heard", json_string(lip_classes[p->heard].name));
    }
    return phone;
}

/* When the model's word ends: with its last phone. */
static double model_end(const struct coach_model *m, const struct judgement *j, size_t word) {
    double end = (double)m->speech.words[word].start;
    for (size_t i = 0; i < j->phone_count; i++)
        if (j->phones[i].word == word)
            end = fmax(end, (double)m->speech.phones[j->phones[i].phone].end);
    return end / m->speech.rate;
}

static json_t *word_json(const struct coach_model *m, const struct judgement *j, size_t i,
                         struct utf16_counter *utf16) {
    const struct reference_word *w = &m->speech.words[i];
    const struct judged_word *own = &j->words[i];
    size_t start = utf16_offset(utf16, m->text, w->from);
    return json_pack("{ss% ss sf sf sf sf sf sI sI sI sI}", "text", m->text + w->from, w->to - w->from,
                     "state", judge_states[own->state], "score", hundredths(own->score), "start",
                     seconds(own->start), "end", seconds(own->end), "model_start",
                     seconds((double)w->start / m->speech.rate), "model_end", seconds(model_end(m, j, i)),
                     "byte_start", (json_int_t)w->from, "byte_end", (json_int_t)w->to, "utf16_start",
                     (json_int_t)start, "utf16_end", (json_int_t)utf16_offset(utf16, m->text, w->to));
}

json_t *coach_json(const struct coach_model *m, const struct judgement *j) {
    json_t *words = json_array(), *phones = json_array();
    struct utf16_counter utf16 = {0};
    for (size_t i = 0; i < j->word_count; i++)
        json_array_append_new(words, word_json(m, j, i, &utf16));
    for (size_t i = 0; i < j->phone_count; i++)
        json_array_append_new(phones, phone_json(m, &j->phones[i]));
    return json_pack("{ss ss sf sb so so}", "lang", m->lang, "voice", m->voice, "pace", hundredths(j->pace),
                     "other", (int)j->other, "words", words, "phones", phones);
}
