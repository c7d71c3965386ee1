/* SPDX-License-Identifier: GPL-3.0-or-later */
/* May this request do what it asks for? */
#include "server/net/exchange_internal.h"
#include <string.h>

bool exchange_permits(struct exchange *x, enum right right, const char *room, int *result) {
    struct error e;
    if (!principal_origin_allowed(x->net, x->request)) {
        metrics_add(x->net->pipeline->metrics, METRIC_REFUSED_ORIGIN, 1);
        error_set(&e, "forbidden-origin", "pages from there may not use this server");
        x->refused = true;
        *result = exchange_error(x, 403, &e);
        return false;
    }
    if (!right)
        return true;
    bool refused = principal_enter(x->net, x->request, &x->principal, &e) ||
                   principal_may(x->net, &x->principal, right, room, &e) ||
                   principal_ask(x->net, &x->principal, &e);
    if (refused)
        *result = exchange_error(x,
                                 !strncmp(e.code, "too-many", 8) ? 429
                                 : !strcmp(e.code, "forbidden")  ? 403
                                                                 : 401,
                                 &e);
    return !refused;
}
