/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/net/consent.h"
#include "server/net/client_message.h"
#include "server/net/notice_message.h"
#include "server/net/notices.h"
#include <string.h>

static const char *word_of(const json_t *message) {
    const char *word = json_string_value(json_object_get(message, "consent"));
    return word ? word : "";
}

int consent_is_answer(const json_t *message, bool *answer, struct error *e) {
    const char *word = word_of(message);
    *answer = !strcmp(word, "given") || !strcmp(word, "declined");
    return client_message_check("consent", message, e);
}

static void tell(struct channel *c, json_t *told) {
    struct queued_message *all = notice_tell(c, told, "consent");
    bool any = strcmp(word_of(told), "none") != 0;
    notice_board_consent(&c->notices, any ? all : NULL, any ? told : NULL);
    queued_message_release(all);
}

/* Words that have been asked already. */
static bool is_same(const json_t *asked, const json_t *told) {
    const json_t *before = json_object_get(asked, "text"), *text = json_object_get(told, "text");
    return asked && (before == text || json_equal(before, text));
}

int consent_take(struct channel *c, const json_t *message, const char *by, struct error *e) {
    json_t *asked = c->notices.asked, *told = notice_begin(c, "consent");
    bool answer;
    int failed = consent_is_answer(message, &answer, e);
    if (!failed && answer && !asked)
        failed = error_plain(e, ERROR_NO_CHOICES);
    if (!failed)
        notice_take_member(answer ? asked : message, "text", told);
    if (!failed && !strcmp(word_of(message), "asked") && is_same(asked, told)) {
        queued_message_release(notice_tell(c, asked, "consent"));
    } else if (!failed) {
        json_object_set(told, "consent", json_object_get(message, "consent"));
        json_object_set_new(told, "by", json_string(by));
        tell(c, told);
    }
    json_decref(told);
    return failed ? -1 : 0;
}
