/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/http/message_queue.h"
#include "server/base/mem.h"
#include <stdlib.h>
#include <string.h>

struct message_queue_link {
    struct message_queue_link *next;
    struct queued_message *message;
};

static struct queued_message *make(const uint8_t *head, size_t head_size, const void *data, size_t size) {
    /* not zeroed: every byte is written, and this runs for each message */
    struct queued_message *message = mem_resize(NULL, sizeof *message + head_size + size);
    *message = (struct queued_message){.refs = 1, .head = (uint8_t)head_size, .size = size};
    memcpy(message->bytes, head, head_size);
    if (size)
        memcpy(message->bytes + head_size, data, size);
    return message;
}

struct queued_message *queued_message_new(enum websocket_opcode opcode, const void *data, size_t size) {
    uint8_t head[WEBSOCKET_HEAD_BYTES];
    struct queued_message *message = make(head, websocket_head(head, opcode, size), data, size);
    message->media = opcode == WEBSOCKET_BINARY;
    return message;
}

struct queued_message *queued_message_plain(const void *data, size_t size) {
    return make((const uint8_t *)"", 0, data, size);
}

const uint8_t *queued_message_body(const struct queued_message *message) {
    return message->bytes + message->head;
}

void queued_message_release(struct queued_message *message) {
    if (message && --message->refs == 0) {
        queued_message_release(message->line);
        free(message);
    }
}

void message_queue_open(struct message_queue *box) {
    *box = (struct message_queue){.last = &box->first};
}

void message_queue_close(struct message_queue *box) {
    struct queued_message *message;
    while ((message = message_queue_pop(box)))
        queued_message_release(message);
}

bool message_queue_empty(const struct message_queue *box) {
    return !box->first;
}

void message_queue_push(struct message_queue *box, struct queued_message *message) {
    struct message_queue_link *link = mem_alloc(sizeof *link);
    link->message = message;
    message->refs++;
    *box->last = link;
    box->last = &link->next;
    box->unsent += message->size;
}

struct queued_message *message_queue_pop(struct message_queue *box) {
    struct message_queue_link *link = box->first;
    if (!link)
        return NULL;
    struct queued_message *message = link->message;
    box->first = link->next;
    if (!box->first)
        box->last = &box->first;
    box->unsent -= message->size;
    free(link);
    return message;
}

uint64_t message_queue_age(const struct message_queue *box, uint64_t now) {
    const struct message_queue_link *link = box->first;
    while (link && !link->message->media)
        link = link->next;
    return link ? now - link->message->born : 0;
}

void message_queue_drop_media(struct message_queue *box) {
    struct message_queue_link **at = &box->first;
    while (*at) {
        struct message_queue_link *link = *at;
        if (!link->message->media) {
            at = &link->next;
            continue;
        }
        *at = link->next;
        box->unsent -= link->message->size;
        queued_message_release(link->message);
        free(link);
    }
    box->last = at;
}
