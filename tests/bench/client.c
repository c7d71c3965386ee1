/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "client.h"
#include <arpa/inet.h>
#include <errno.h>
#include <fcntl.h>
#include <netinet/tcp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/epoll.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

enum { BUFFER = 1 << 16, EVENTS = 256 };

double now_ms(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec * 1e3 + (double)t.tv_nsec / 1e6;
}

void die(const char *what) {
    perror(what);
    exit(1);
}

void clients_open(struct clients *all) {
    all->epoll = epoll_create1(0);
    if (all->epoll < 0)
        die("epoll");
}

void client_dial(struct clients *all, struct client *c, int port, const char *path) {
    struct sockaddr_in to = {.sin_family = AF_INET, .sin_port = htons((uint16_t)port)};
    char request[512];
    int one = 1;
    to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    c->fd = socket(AF_INET, SOCK_STREAM, 0);
    if (c->fd < 0 || connect(c->fd, (struct sockaddr *)&to, sizeof to))
        die("connect");
    int length = snprintf(request, sizeof request,
                          "GET %s HTTP/1.1\r\nHost: 127.0.0.1:%d\r\nUpgrade: websocket\r\n"
                          "Connection: Upgrade\r\nSec-WebSocket-Version: 13\r\n"
                          "Sec-WebSocket-Key: bGlzdGVuZXJzIGJlbmNoLg==\r\n\r\n",
                          path, port);
    setsockopt(c->fd, IPPROTO_TCP, TCP_NODELAY, &one, sizeof one);
    if (write(c->fd, request, (size_t)length) != length)
        die("write");
    fcntl(c->fd, F_SETFL, O_NONBLOCK);
    struct epoll_event event = {.events = EPOLLIN, .data.ptr = c};
    epoll_ctl(all->epoll, EPOLL_CTL_ADD, c->fd, &event);
}

/* Masks with zeros, so that the bytes stay unchanged. */
void client_send(struct client *c, const char *text, size_t size) {
    uint8_t frame[8 + UINT16_MAX] = {0x80 | CLIENT_TEXT};
    size_t head = size < 126 ? 6 : 8;
    if (size > UINT16_MAX)
        die("too long");
    frame[1] = (uint8_t)(0x80 | (size < 126 ? size : 126));
    if (size >= 126) {
        frame[2] = (uint8_t)(size >> 8);
        frame[3] = (uint8_t)size;
    }
    memcpy(frame + head, text, size);
    if (write(c->fd, frame, head + size) != (ssize_t)(head + size))
        die("send");
}

static void on_message(struct clients *all, struct client *c, int opcode, const uint8_t *data, size_t size) {
    static const uint8_t pong[] = {0x8a, 0x80, 0, 0, 0, 0};
    if (opcode == 9 && write(c->fd, pong, sizeof pong) != sizeof pong)
        die("pong");
    if (opcode == 8)
        exit((fprintf(stderr, "a client was sent away\n"), 1));
    if (opcode == CLIENT_TEXT || opcode == CLIENT_BINARY)
        all->message(all->ctx, c, opcode, data, size);
}

/* Returns the size of the message or handshake at the start of the buffer; 0 = incomplete. */
static size_t take(struct clients *all, struct client *c, const uint8_t *data, size_t size) {
    if (!c->open) {
        const uint8_t *end = memmem(data, size, "\r\n\r\n", 4);
        if (!end)
            return 0;
        if (size < 12 || memcmp(data + 9, "101", 3))
            exit((fprintf(stderr, "refused: %.60s\n", data), 1));
        c->open = true;
        all->opened++;
        return (size_t)(end - data) + 4;
    }
    if (size < 2)
        return 0;
    size_t head = data[1] < 126 ? 2 : data[1] == 126 ? 4 : 10, length = data[1];
    if (size < head)
        return 0;
    if (head > 2)
        length = 0;
    for (size_t i = 2; i < head; i++)
        length = length << 8 | data[i];
    if (size < head + length)
        return 0;
    on_message(all, c, data[0] & 15, data + head, length);
    return head + length;
}

static void on_bytes(struct clients *all, struct client *c, uint8_t *buffer) {
    ssize_t got = read(c->fd, buffer, BUFFER);
    if (got <= 0)
        exit((fprintf(stderr, "a client was cut off\n"), 1));
    all->last = now_ms();
    uint8_t *data = buffer;
    size_t size = (size_t)got;
    if (c->size) { /* continues an incomplete message */
        if (c->size + size > c->cap)
            c->data = realloc(c->data, c->cap = c->size + size);
        memcpy(c->data + c->size, buffer, size);
        data = c->data;
        size += c->size;
    }
    for (size_t taken; size && (taken = take(all, c, data, size)); size -= taken)
        data += taken;
    if (size && data != c->data) {
        if (size > c->cap)
            c->data = realloc(c->data, c->cap = size);
        memmove(c->data, data, size);
    }
    c->size = size;
}

void clients_serve(struct clients *all, int ms) {
    static uint8_t buffer[BUFFER];
    struct epoll_event events[EVENTS];
    int count = epoll_wait(all->epoll, events, EVENTS, ms);
    for (int i = 0; i < count; i++)
        on_bytes(all, events[i].data.ptr, buffer);
}

bool holds(const uint8_t *data, size_t size, const char *text) {
    return memmem(data, size < 512 ? size : 512, text, strlen(text)) != NULL;
}

int ascending(const void *a, const void *b) {
    float x = *(const float *)a, y = *(const float *)b;
    return (x > y) - (x < y);
}
