/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/doors/mqtt/mqtt_said.h"
#include <stdio.h>
#include <string.h>

struct said *said_find(struct said_ids *ids, const char *id) {
    for (unsigned i = 0; *id && i < SAID_KEPT; i++)
        if (!strcmp(ids->all[i].id, id))
            return &ids->all[i];
    return NULL;
}

struct said *said_new(struct said_ids *ids, const char *id) {
    if (said_find(ids, id))
        return NULL;
    struct said *said = &ids->all[ids->next++ % SAID_KEPT];
    *said = (struct said){.open = true};
    snprintf(said->id, sizeof said->id, "%s", id);
    return said;
}
