/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/doors/place.h"
#include "server/base/log.h"
#include "server/base/mem.h"
#include <errno.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/random.h>

/* Three parts of base64url with dots between (RFC 7515, 3.1), none of them empty. */
static bool is_token(const char *text) {
    static const char letters[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_";
    for (int part = 0; part < 3; part++) {
        size_t length = strspn(text, letters);
        if (!length || text[length] != (part < 2 ? '.' : '\0'))
            return false;
        text += length + (part < 2);
    }
    return true;
}

/* What stands there is not repeated: it may be a secret. */
static void complain(const char *where, const char *text) {
    size_t length = strlen(text), dots = 0;
    for (const char *c = text; *c; c++)
        dots += *c == '.';
    log_error("%s: no token is in it, but %zu characters with %zu dots%s. A token has three parts with dots "
              "between; 'faccia token --secret-file FILE --subject NAME' makes one of the daemon's secret",
              where, length, dots, dots ? "" : ", perhaps the secret that signs tokens, which goes nowhere");
}

void place_open(struct place *p) {
    const char *url = getenv("FACCIA_URL"), *token = getenv("FACCIA_TOKEN");
    bool has = token && *token, good = has && is_token(token);
    if (has && !good)
        complain("FACCIA_TOKEN", token);
    *p = (struct place){.url = url ? url : "http://127.0.0.1:8080", .token = good ? mem_strdup(token) : NULL};
}

void place_close(struct place *p) {
    free(p->token);
}

int place_read_token(struct place *p, const char *file) {
    char line[4096] = "";
    errno = 0;
    FILE *f = fopen(file, "r");
    if (f) {
        if (!fgets(line, sizeof line, f) && !errno)
            errno = ENODATA;
        fclose(f);
    }
    line[strcspn(line, "\r\n")] = '\0';
    if (!*line) {
        log_error("%s: no token is in it: %s", file, strerror(errno ? errno : ENODATA));
        return -1;
    }
    if (!is_token(line)) {
        complain(file, line);
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
