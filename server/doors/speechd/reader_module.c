/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/doors/speechd/reader_module.h"
#include "server/base/log.h"
#include <stdlib.h>

void module_finish(struct reader_module *m, const char *event) {
    if (!m->text)
        return;
    if (m->fetch)
        remote_give_up(m->fetch);
    m->fetch = NULL;
    free(m->text);
    m->text = NULL;
    while (m->mark_count)
        free(m->marks[--m->mark_count].name);
    m->sound.size = 0;
    *m->id = '\0';
    if (!m->begun)
        reader_say("701 BEGIN");
    reader_say("%s", event);
}

void module_ask(struct reader_module *m, const char *path, const struct remote_member *members,
                remote_bytes *bytes, remote_answered *answered) {
    m->fetch = remote_fetch(m->remote, path, members, "application/ssml+xml", m->text, bytes, answered, m);
    remote_speak_anyway(m->fetch, *m->manner.lang ? m->manner.lang : NULL);
}

bool module_give_up_markup(struct reader_module *m, const struct remote_answer *answer) {
    if (answer->status != 400 || m->plain)
        return false;
    log_warn("its markup is left out: %s", answer->why);
    char *words = manner_words(m->text);
    free(m->text);
    m->text = words;
    m->plain = true;
    return true;
}

void module_begin(struct reader_module *m) {
    if (!m->begun)
        reader_say("701 BEGIN");
    m->begun = true;
}
