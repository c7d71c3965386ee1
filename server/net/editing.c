/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What editors save: works of the library (/v1/library/files) and gestures (/v1/gestures). */
#include "server/expression/gestures.h"
#include "server/library/work.h"
#include "server/net/shelf_http.h"

enum {
    GESTURE_BYTES = 1 << 20,
    GESTURES_KEPT = 200, /* with those of the models no more than are read */
    WORK_BYTES = 8 << 20,
    WORKS_KEPT = 10000,
};

/* Where nobody may edit there is nothing of the kind. */
static const char *folder_of(const struct net *net, const char *folder) {
    return net->options.editing ? folder : NULL;
}

int gestures_serve(struct exchange *x) {
    static const struct shelf_service service = {"/v1/gestures", "gestures", "application/json",
                                                 gesture_check, NULL};
    const struct net *net = exchange_net(x);
    return shelf_serve(x, &service,
                       &(struct document_store){folder_of(net, net->options.gestures), ".json",
                                                ERROR_NOT_FOUND, GESTURE_BYTES, GESTURES_KEPT},
                       net->options.on_gestures);
}

int works_serve(struct exchange *x) {
    static const struct shelf_service service = {"/v1/library/files", "files", "application/octet-stream",
                                                 NULL, work_check_apart};
    const struct net *net = exchange_net(x);
    return shelf_serve(x, &service,
                       &(struct document_store){folder_of(net, net->options.works), "", ERROR_NOT_FOUND,
                                                WORK_BYTES, WORKS_KEPT},
                       (struct document_store_listener){0});
}
