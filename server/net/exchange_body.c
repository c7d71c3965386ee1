/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The body of a request, collected for its receiver. */
#include "server/net/exchange_internal.h"

void exchange_expect_body(struct exchange *x, size_t most, enum error_code too_long) {
    x->body_most = most;
    x->body_too_long = too_long;
}

void exchange_take_body(struct exchange *x, const void *data, size_t size) {
    struct error e;
    if (exchange_streams_body(x)) {
        x->work.body(x->work.self, data, size);
        return;
    }
    if (x->answered || !x->body_most)
        return;
    if (x->request_body.size + size <= x->body_most) {
        buf_add(&x->request_body, data, size);
        return;
    }
    exchange_drop_body(x);
    error_set(&e, x->body_too_long, "the body may have at most %zu bytes", x->body_most);
    exchange_error(x, &e);
}

bool exchange_streams_body(const struct exchange *x) {
    return x->work.body && (!x->answered || (x->chunked && !x->complete));
}

const struct buf *exchange_body(const struct exchange *x) {
    return &x->request_body;
}

void exchange_drop_body(struct exchange *x) {
    buf_free(&x->request_body);
}
