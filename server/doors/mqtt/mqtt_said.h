/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The ids of what was asked for: what comes twice is said once, and who asked is told how it ended. */
#ifndef FACCIA_DOORS_MQTT_SAID_H
#define FACCIA_DOORS_MQTT_SAID_H

#include <stdbool.h>
#include <stdint.h>

enum { SAID_ID = 65, SAID_KEPT = 256 };

struct said {
    char id[SAID_ID];
    char site[SAID_ID], session[SAID_ID]; /* of Hermes; empty: none */
    bool hermes, open;                    /* its end is awaited */
};

/* Of a room; all zero is empty. The oldest are forgotten. */
struct said_ids {
    struct said all[SAID_KEPT];
    uint32_t next;
};

/* NULL: that id has been before. */
struct said *said_new(struct said_ids *ids, const char *id);
struct said *said_find(struct said_ids *ids, const char *id);

#endif
