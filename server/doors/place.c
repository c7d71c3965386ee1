/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/doors/place.h"
#include "server/base/log.h"
#include "server/base/mem.h"
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/random.h>

void place_open(struct place *p) {
    const char *url = getenv("FACCIA_URL"), *token = getenv("FACCIA_TOKEN");
    *p =
        (struct place){.url = url ? url : "http://127.0.0.1:8080", .token = token ? mem_strdup(token) : NULL};
}

void place_close(struct place *p) {
    free(p->token);
}

int place_read_token(struct place *p, const char *file) {
    char line[4096] = "";
    FILE *f = fopen(file, "r");
    if (f) {
        if (!fgets(line, sizeof line, f))
            errno = ENODATA;
        fclose(f);
    }
    line[strcspn(line, "\r\n")] = '\0';
    if (!*line) {
        log_error("%s: no token is in it: %s", file, strerror(errno ? errno : ENODATA));
        return -1;
    }
    free(p->token);
    p->token = mem_strdup(line);
    return 0;
}

void place_make_id(char *id, size_t cap) {
    unsigned long long number = 0;
    if (getrandom(&number, sizeof number, 0) != sizeof number)
        number = uv_hrtime();
    snprintf(id, cap, "say-%016llx", number);
}
