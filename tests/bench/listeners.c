/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Many WebSocket listeners (RFC 6455) in one process, for broadcast.mjs and cluster-rooms.mjs. Usage:
 * listeners PORT[,PORT]... PATH COUNT [RECORD]; they take turns with the ports. Prints "ready" when all are
 * connected and have heard nothing for half a second; then counts what each hears from the event "begin" to
 * the event "end" of an utterance, prints what came as one line of JSON, and ends with its standard input.
 * The late column is how much later than the first listener a listener got a message. RECORD gets the
 * messages of one listener: ms from the first on (u32), opcode (u8), size (u32), bytes. */
#include "client.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MESSAGES_MAX = 1 << 14, BATCH = 64, PORTS_MAX = 16 };

struct listener {
    struct client client; /* first */
    bool counts, done;
    uint32_t heard; /* messages since "begin" */
};

struct media_segment {
    struct clients clients;
    struct listener *all;
    size_t count, ended;
    double *first; /* arrival of each message at the first listener, ms */
    float *late;   /* of each message of each listener, ms */
    size_t late_count, late_cap;
    uint64_t bytes;
    double begun;
    FILE *record;
};

static void put32(uint8_t *at, uint32_t value) {
    for (int i = 0; i < 4; i++)
        at[i] = (uint8_t)(value >> (8 * i));
}

static void record(struct media_segment *s, const uint8_t *data, size_t size, int opcode, double now) {
    uint8_t head[9];
    put32(head, (uint32_t)(now - s->begun));
    head[4] = (uint8_t)opcode;
    put32(head + 5, (uint32_t)size);
    fwrite(head, 1, sizeof head, s->record);
    fwrite(data, 1, size, s->record);
}

static void on_message(void *ctx, struct client *client, int opcode, const uint8_t *data, size_t size) {
    struct media_segment *s = ctx;
    struct listener *l = (struct listener *)client;
    double now = now_ms();
    if (opcode == CLIENT_TEXT && !l->done && holds(data, size, "\"type\":\"begin\""))
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
    if (opcode == CLIENT_TEXT && holds(data, size, "\"type\":\"end\"")) {
        l->counts = false;
        l->done = true;
        s->ended++;
    }
}

static void report(struct media_segment *s) {
    size_t n = s->late_count;
    qsort(s->late, n, sizeof *s->late, ascending);
    printf("{\"messages\":%zu,\"bytes\":%llu,\"p50\":%.3f,\"p99\":%.3f,\"max\":%.3f}\n", n,
           (unsigned long long)s->bytes, s->late[n / 2], s->late[n * 99 / 100], s->late[n - 1]);
    fflush(stdout);
}

static size_t read_ports(char *list, int ports[PORTS_MAX]) {
    size_t count = 0;
    for (char *port = strtok(list, ","); port && count < PORTS_MAX; port = strtok(NULL, ","))
        ports[count++] = atoi(port);
    return count;
}

int main(int argc, char **argv) {
    struct media_segment s = {.clients = {.message = on_message, .ctx = &s}};
    int ports[PORTS_MAX];
    size_t port_count = argc > 3 ? read_ports(argv[1], ports) : 0;
    if (!port_count)
        return 2;
    clients_open(&s.clients);
    s.count = strtoul(argv[3], NULL, 10);
    s.all = calloc(s.count, sizeof *s.all);
    s.first = calloc(MESSAGES_MAX, sizeof *s.first);
    s.late_cap = s.count * 2048;
    s.late = malloc(s.late_cap * sizeof *s.late);
    s.record = argc > 4 ? fopen(argv[4], "wb") : NULL;
    for (size_t dialled = 0; dialled < s.count;) {
        for (size_t i = 0; i < BATCH && dialled < s.count; i++, dialled++)
            client_dial(&s.clients, &s.all[dialled].client, ports[dialled % port_count], argv[2]);
        while (s.clients.opened < dialled)
            clients_serve(&s.clients, 1000);
    }
    for (s.clients.last = now_ms(); now_ms() - s.clients.last < 500;)
        clients_serve(&s.clients, 100);
    puts("ready");
    fflush(stdout);
    while (s.ended < s.count)
        clients_serve(&s.clients, 1000);
    if (s.record)
        fclose(s.record);
    report(&s);
    return getchar() == EOF ? 0 : 1;
}
