/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/net/outbox.h"
#include "server/base/mem.h"
#include <stdlib.h>
#include <string.h>

struct outbox_link {
    struct outbox_link *next;
    struct parcel *parcel;
};

static struct parcel *make(const uint8_t *head, size_t head_size, const void *data, size_t size) {
    struct parcel *parcel = mem_alloc(sizeof *parcel + head_size + size);
    parcel->refs = 1;
    parcel->head = (uint8_t)head_size;
    parcel->size = size;
    memcpy(parcel->bytes, head, head_size);
    if (size)
        memcpy(parcel->bytes + head_size, data, size);
    return parcel;
}

struct parcel *parcel_new(enum websocket_opcode opcode, const void *data, size_t size) {
    uint8_t head[WEBSOCKET_HEAD_BYTES];
    struct parcel *parcel = make(head, websocket_head(head, opcode, size), data, size);
    parcel->media = opcode == WEBSOCKET_BINARY;
    return parcel;
}

struct parcel *parcel_plain(const void *data, size_t size) {
    return make((const uint8_t *)"", 0, data, size);
}

const uint8_t *parcel_body(const struct parcel *parcel) {
    return parcel->bytes + parcel->head;
}

void parcel_release(struct parcel *parcel) {
    if (parcel && --parcel->refs == 0)
        free(parcel);
}

void outbox_open(struct outbox *box) {
    *box = (struct outbox){.last = &box->first};
}

void outbox_close(struct outbox *box) {
    struct parcel *parcel;
    while ((parcel = outbox_pop(box)))
        parcel_release(parcel);
}

bool outbox_empty(const struct outbox *box) {
    return !box->first;
}

void outbox_push(struct outbox *box, struct parcel *parcel) {
    struct outbox_link *link = mem_alloc(sizeof *link);
    link->parcel = parcel;
    parcel->refs++;
    *box->last = link;
    box->last = &link->next;
    box->unsent += parcel->size;
}

struct parcel *outbox_pop(struct outbox *box) {
    struct outbox_link *link = box->first;
    if (!link)
        return NULL;
    struct parcel *parcel = link->parcel;
    box->first = link->next;
    if (!box->first)
        box->last = &box->first;
    box->unsent -= parcel->size;
    free(link);
    return parcel;
}

uint64_t outbox_age(const struct outbox *box, uint64_t now) {
    const struct outbox_link *link = box->first;
    while (link && !link->parcel->media)
        link = link->next;
    return link ? now - link->parcel->born : 0;
}

void outbox_drop_media(struct outbox *box) {
    struct outbox_link **at = &box->first;
    while (*at) {
        struct outbox_link *link = *at;
        if (!link->parcel->media) {
            at = &link->next;
            continue;
        }
        *at = link->next;
        box->unsent -= link->parcel->size;
        parcel_release(link->parcel);
        free(link);
    }
    box->last = at;
}
