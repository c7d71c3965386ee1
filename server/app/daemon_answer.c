/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/app/daemon_answer.h"
#include <stdio.h>

int daemon_answer(const struct settings *settings, const struct settings_request *request) {
    struct buf text = {0};
    if (request->help) {
        buf_printf(&text, "Usage: facciad [OPTION]...\nServes the talking head: a page, a WebSocket and HTTP "
                          "(protocol/README.md says how).\n\n");
        settings_help(PROGRAM_DAEMON, &text);
    } else if (request->version)
        buf_printf(&text, "facciad " FACCIA_VERSION "\n");
    else if (request->schema)
        settings_schema(&text);
    else if (request->print)
        settings_print(settings, &text);
    else
        return -1;
    fwrite(text.data, 1, text.size, stdout);
    buf_free(&text);
    return 0;
}
