/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/api/listener_words.h"
#include "server/api/api_internal.h"
#include "server/live/answers.h"
#include "server/live/ear.h"
#include "server/rooms/notices.h"
#include "server/rooms/question.h"
#include "server/rooms/repeat.h"
#include "server/synthesis/pipeline.h"

json_t *listener_words_message(const struct channel *channel, const struct listener_words *words) {
    json_t *heard = json_pack("{ss ss ss ss sb ss}", "type", "heard", "stream", channel_name(channel), "id",
                              words->id, "text", words->text, "final", words->final, "by", words->by);
    if (words->confidence >= 0)
        json_object_set_new(heard, "confidence", json_real(words->confidence));
    return heard;
}

#ifdef HAVE_LIVE
static const struct answers *answers_of(const struct api *api) {
    return api->pipeline->ears ? api->pipeline->ears->answers : NULL;
}

/* Words may choose one of the answers on offer. */
static bool choose(const struct api *api, struct channel *channel, const struct listener_words *words,
                   const char *lang) {
    const json_t *offered = notice_offered(channel);
    struct error ignored;
    int choice = offered ? answers_choose(answers_of(api), lang, offered, words->text) : -1;
    if (choice < 0)
        return false;
    json_t *message = json_pack("{si}", "choice", choice);
    notice_choose(channel, message, words->by, &ignored);
    json_decref(message);
    return true;
}

/* "Come?" has the last utterance said again. */
static bool repeat(const struct api *api, struct channel *channel, const struct listener_words *words,
                   const char *lang) {
    return answers_asks_again(answers_of(api), lang, words->text) && channel_repeat(channel);
}
#else
static bool choose(const struct api *api, struct channel *channel, const struct listener_words *words,
                   const char *lang) {
    (void)api, (void)channel, (void)words, (void)lang;
    return false;
}

static bool repeat(const struct api *api, struct channel *channel, const struct listener_words *words,
                   const char *lang) {
    (void)api, (void)channel, (void)words, (void)lang;
    return false;
}
#endif

void listener_words_tell(struct channel *channel, const struct listener_words *words) {
    if (!channel_is_room(channel))
        return;
    json_t *heard = listener_words_message(channel, words);
    notice_heard(channel, heard);
    json_decref(heard);
}

void listener_words_act(const struct api *api, struct channel *channel, const struct listener_words *words) {
    const char *lang = words->lang ? words->lang : api->pipeline->default_lang;
    if (words->final && !choose(api, channel, words, lang) && !repeat(api, channel, words, lang))
        question_heard(channel, words->text, words->by);
}
