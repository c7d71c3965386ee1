/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Dies when it is opened, unless the file that its configuration names exists. */
#include "tests/plugins/stub.h"
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static int stub_open(const char *config, void **self, char *message, size_t cap) {
    (void)self, (void)message, (void)cap;
    char path[256] = "";
    const char *start = strstr(config, ":\"");
    if (start)
        strncat(path, start + 2, strcspn(start + 2, "\""));
    if (access(path, F_OK) != 0)
        abort();
    return 0;
}

STUB_TABLE(FACCIA_VOICE_ABI);
