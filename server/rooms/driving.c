/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/rooms/driving.h"
#include "server/rooms/rooms_internal.h"

static void tell(struct channel *c, bool on, const char *by) {
    json_t *told = json_pack("{ss ss sb}", "type", "driven", "stream", c->name, "on", on);
    if (on)
        json_object_set_new(told, "by", json_string(by));
    struct queued_message *all = notice_tell(c, told, "driven");
    notice_board_driven(&c->notices, on ? all : NULL);
    queued_message_release(all);
    json_decref(told);
}

static void end(struct channel *c) {
    stream_undrive(c->stream);
    tell(c, false, NULL);
}

int channel_drive(struct channel *c, uint64_t driver, const char *by, uint32_t voice,
                  const struct driven_frame *frames, size_t count, struct error *e) {
    uint64_t before = stream_driver(c->stream);
    if (c->remote)
        return error_set(e, ERROR_ROOM_AWAY, "another daemon leads this room: drive its face there");
    if (before && before != driver && !stream_drives_on(c->stream)) {
        end(c);
        before = 0;
    }
    if (stream_drive(c->stream, driver, voice, frames, count, e))
        return -1;
    if (!before)
        tell(c, true, by);
    return 0;
}

void channel_undrive(struct channel *c, uint64_t driver) {
    if (driver && stream_driver(c->stream) == driver)
        end(c);
}

void drivings_tick(struct rooms *rooms) {
    for (struct channel *c = rooms->list, *next; c; c = next) {
        next = c->next;
        if (stream_driver(c->stream) && !stream_drives_on(c->stream))
            end(c);
    }
}
