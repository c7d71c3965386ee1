/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Many WebSocket listeners (RFC 6455) in one process, for broadcast.mjs. Usage:
 * listeners PORT PATH COUNT [RECORD]. Prints "ready" when all are connected and have heard nothing for half a
 * second; then counts what each hears from the event "begin" to the event "end" of an utterance, prints what
 * came as one line of JSON, and ends with its standard input. The late column is how much later than the
 * first listener a listener got a message. RECORD gets the messages of one listener: ms from the first on
 * (u32), opcode (u8), size (u32), bytes. */
#include <arpa/inet.h>
#include <errno.h>
#include <fcntl.h>
#include <netinet/tcp.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/epoll.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

enum { BUFFER = 1 << 16, MESSAGES_MAX = 1 << 14, BATCH = 64 };

struct listener {
    int fd;
    uint8_t *data; /* what came and is no whole message yet */
    size_t size, cap;
    bool open, counts, done;
    uint32_t heard; /* messages since "begin" */
};

struct scene {
    struct listener *all;
    size_t count, opened, ended;
    double *first; /* arrival of each message at the first listener, ms */
    float *late;   /* of each message of each listener, ms */
    size_t late_count, late_cap;
    uint64_t bytes;
    double last, begun;
    FILE *record;
    int epoll;
};

static double now_ms(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec * 1e3 + (double)t.tv_nsec / 1e6;
}

static void die(const char *what) {
    perror(what);
    exit(1);
}

static void dial(struct scene *s, struct listener *l, int port, const char *path) {
    struct sockaddr_in to = {.sin_family = AF_INET, .sin_port = htons((uint16_t)port)};
    char request[512];
    int one = 1;
    to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    l->fd = socket(AF_INET, SOCK_STREAM, 0);
    if (l->fd < 0 || connect(l->fd, (struct sockaddr *)&to, sizeof to))
        die("connect");
    int length = snprintf(request, sizeof request,
                          "GET %s HTTP/1.1\r\nHost: 127.0.0.1:%d\r\nUpgrade: websocket\r\n"
                          "Connection: Upgrade\r\nSec-WebSocket-Version: 13\r\n"
                          "Sec-WebSocket-Key: bGlzdGVuZXJzIGJlbmNoLg==\r\n\r\n",
                          path, port);
    setsockopt(l->fd, IPPROTO_TCP, TCP_NODELAY, &one, sizeof one);
    if (write(l->fd, request, (size_t)length) != length)
        die("write");
    fcntl(l->fd, F_SETFL, O_NONBLOCK);
    struct epoll_event event = {.events = EPOLLIN, .data.ptr = l};
    epoll_ctl(s->epoll, EPOLL_CTL_ADD, l->fd, &event);
}

static bool holds(const uint8_t *data, size_t size, const char *text) {
    return memmem(data, size < 512 ? size : 512, text, strlen(text)) != NULL;
}

static void put32(uint8_t *at, uint32_t value) {
    for (int i = 0; i < 4; i++)
        at[i] = (uint8_t)(value >> (8 * i));
}

static void record(struct scene *s, const uint8_t *data, size_t size, int opcode, double now) {
    uint8_t head[9];
    put32(head, (uint32_t)(now - s->begun));
    head[4] = (uint8_t)opcode;
    put32(head + 5, (uint32_t)size);
    fwrite(head, 1, sizeof head, s->record);
    fwrite(data, 1, size, s->record);
}

static void on_message(struct scene *s, struct listener *l, int opcode, const uint8_t *data, size_t size) {
    static const uint8_t pong[] = {0x8a, 0x80, 0, 0, 0, 0};
    double now = now_ms();
    if (opcode == 9 && write(l->fd, pong, sizeof pong) != sizeof pong)
        die("pong");
    if (opcode == 8)
        exit((fprintf(stderr, "a listener was sent away\n"), 1));
    if (opcode != 1 && opcode != 2)
        return;
    if (opcode == 1 && !l->done && holds(data, size, "\"type\":\"begin\""))
        l->counts = true;
    if (!l->counts || l->heard == MESSAGES_MAX)
        return;
    uint32_t index = l->heard++;
    if (!s->first[index]) {
        s->first[index] = now;
        s->begun = index ? s->begun : now;
    }
    if (s->late_count < s->late_cap)
        s->late[s->late_count++] = (float)(now - s->first[index]);
    s->bytes += size;
    if (s->record && l == s->all)
        record(s, data, size, opcode, now);
    if (opcode == 1 && holds(data, size, "\"type\":\"end\"")) {
        l->counts = false;
        l->done = true;
        s->ended++;
    }
}

/* The bytes of a whole message or of the handshake at the head of the buffer; 0 = not all there yet. */
static size_t take(struct scene *s, struct listener *l, const uint8_t *data, size_t size) {
    if (!l->open) {
        const uint8_t *end = memmem(data, size, "\r\n\r\n", 4);
        if (!end)
            return 0;
        if (size < 12 || memcmp(data + 9, "101", 3))
            exit((fprintf(stderr, "refused: %.60s\n", data), 1));
        l->open = true;
        s->opened++;
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
    on_message(s, l, data[0] & 15, data + head, length);
    return head + length;
}

static void on_bytes(struct scene *s, struct listener *l, uint8_t *buffer) {
    ssize_t got = read(l->fd, buffer, BUFFER);
    if (got <= 0)
        exit((fprintf(stderr, "a listener was cut off\n"), 1));
    s->last = now_ms();
    uint8_t *data = buffer;
    size_t size = (size_t)got;
    if (l->size) { /* the rest of before comes first */
        if (l->size + size > l->cap)
            l->data = realloc(l->data, l->cap = l->size + size);
        memcpy(l->data + l->size, buffer, size);
        data = l->data;
        size += l->size;
    }
    for (size_t taken; size && (taken = take(s, l, data, size)); size -= taken)
        data += taken;
    if (size && data != l->data) {
        if (size > l->cap)
            l->data = realloc(l->data, l->cap = size);
        memmove(l->data, data, size);
    }
    l->size = size;
}

static void serve(struct scene *s, int ms) {
    static uint8_t buffer[BUFFER];
    struct epoll_event events[256];
    int count = epoll_wait(s->epoll, events, 256, ms);
    for (int i = 0; i < count; i++)
        on_bytes(s, events[i].data.ptr, buffer);
}

static int ascending(const void *a, const void *b) {
    float x = *(const float *)a, y = *(const float *)b;
    return (x > y) - (x < y);
}

static void report(struct scene *s) {
    size_t n = s->late_count;
    qsort(s->late, n, sizeof *s->late, ascending);
    printf("{\"messages\":%zu,\"bytes\":%llu,\"p50\":%.3f,\"p99\":%.3f,\"max\":%.3f}\n", n,
           (unsigned long long)s->bytes, s->late[n / 2], s->late[n * 99 / 100], s->late[n - 1]);
    fflush(stdout);
}

int main(int argc, char **argv) {
    struct scene s = {.epoll = epoll_create1(0)};
    if (argc < 4)
        return 2;
    s.count = strtoul(argv[3], NULL, 10);
    s.all = calloc(s.count, sizeof *s.all);
    s.first = calloc(MESSAGES_MAX, sizeof *s.first);
    s.late_cap = s.count * 2048;
    s.late = malloc(s.late_cap * sizeof *s.late);
    s.record = argc > 4 ? fopen(argv[4], "wb") : NULL;
    for (size_t dialled = 0; dialled < s.count;) {
        for (size_t i = 0; i < BATCH && dialled < s.count; i++)
            dial(&s, &s.all[dialled++], atoi(argv[1]), argv[2]);
        while (s.opened < dialled)
            serve(&s, 1000);
    }
    for (s.last = now_ms(); now_ms() - s.last < 500;)
        serve(&s, 100);
    puts("ready");
    fflush(stdout);
    while (s.ended < s.count)
        serve(&s, 1000);
    if (s.record)
        fclose(s.record);
    report(&s);
    return getchar() == EOF ? 0 : 1;
}
