/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/plugins/kokoro/kokoro_data.h"
#include <limits.h>
#include <stdio.h>
#include <unistd.h>

bool ko_data_complete(const char *folder) {
    char path[PATH_MAX];
    int length = snprintf(path, sizeof path, "%s/.faccia-lock", folder);
    return length < (int)sizeof path && access(path, R_OK) == 0;
}

const char *ko_data_choose(const char *stated, const char *beside, const char *built) {
    if (stated)
        return stated;
    return ko_data_complete(beside) ? beside : built;
}
