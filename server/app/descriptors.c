/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/app/descriptors.h"
#include "server/base/log.h"
#include <sys/resource.h>

enum {
    OWN = 48,        /* of the loop, of files that are read, and of those that listen */
    EACH_WORKER = 4, /* its socket, and what it takes to start it */
    PLUGINS = 6,
    LEAST = 4 /* connections */
};

void descriptors_provide(struct http_options *o, unsigned workers) {
    struct rlimit limit;
    rlim_t own = OWN + (rlim_t)EACH_WORKER * PLUGINS * workers;
    rlim_t need = own + o->connections + o->connections_above;
    if (getrlimit(RLIMIT_NOFILE, &limit) || limit.rlim_cur >= need)
        return;
    limit.rlim_cur = limit.rlim_max < need ? limit.rlim_max : need;
    if (setrlimit(RLIMIT_NOFILE, &limit))
        getrlimit(RLIMIT_NOFILE, &limit);
    if (limit.rlim_cur >= need)
        return;
    /* an eighth of what is left lets those above the limit be told so */
    rlim_t left = limit.rlim_cur > own + LEAST ? limit.rlim_cur - own : LEAST;
    unsigned above = (unsigned)(left / 8 + 1), asked = o->connections;
    if (above < o->connections_above)
        o->connections_above = above;
    o->connections = (unsigned)left - o->connections_above;
    log_warn(
        "%llu descriptors are too few for %u connections: %u are the limit (see ulimit -n, LimitNOFILE=)",
        (unsigned long long)limit.rlim_cur, asked, o->connections);
}
