/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/cluster/bus.h"

const char *bus_name(const struct bus *bus) {
    return bus->engine->name(bus);
}

bool bus_up(const struct bus *bus) {
    return bus->engine->up(bus);
}

void bus_listen(struct bus *bus, const struct bus_ear *ear, void *ctx) {
    bus->engine->listen(bus, ear, ctx);
}

void bus_claim(struct bus *bus, const char *lease, uint64_t above) {
    bus->engine->claim(bus, lease, above);
}

void bus_leave(struct bus *bus, const struct bus_right *right, const struct bus_receivers *to,
               const void *data, size_t size) {
    bus->engine->leave(bus, right, to, data, size);
}

void bus_send(struct bus *bus, const struct bus_right *right, const struct bus_receivers *to,
              const void *data, size_t size) {
    bus->engine->send(bus, right, to, data, size);
}

void bus_close(struct bus *bus) {
    if (bus)
        bus->engine->close(bus);
}
