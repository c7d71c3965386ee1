/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/doors/speechd/reader_module.h"
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

void module_begin(struct reader_module *m) {
    if (!m->begun)
        reader_say("701 BEGIN");
    m->begun = true;
}
