/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Many WebSocket listeners (RFC 6455), for broadcast.mjs and cluster-rooms.mjs, in as many processes as the
 * descriptor limit requires. Usage: listeners PORT[,PORT]... PATH COUNT [RECORD]; they take turns with the
 * ports. Prints "ready" when all are connected and have heard nothing for half a second; then counts messages
 * of each from the event "begin" to the event "end" of an utterance, prints the counts as one line of JSON,
 * and exits when its standard input ends. The late column is how much later than the first listener of all a
 * listener got a message. RECORD gets the messages of the first listener: ms from the first on (u32), opcode
 * (u8), size (u32), bytes. */
#include "client.h"
#include <poll.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

enum { MESSAGES_MAX = 1 << 14, EACH_MAX = 2048, BATCH = 64, PORTS_MAX = 16, OTHER_FILES = 64 };

struct listener {
    struct client client; /* first */
    bool counts, done;
    uint32_t heard; /* messages since "begin" */
};

/* Memory shared by the processes. */
struct heard {
    atomic_size_t quiet, done; /* processes */
    atomic_size_t messages;
    atomic_ullong bytes;
    _Atomic double first[MESSAGES_MAX]; /* arrival of each message at the first listener of all, ms */
    size_t late_cap;
    float late[]; /* of each message of each listener, ms */
};

/* One process of listeners. */
struct crowd {
    struct clients clients;
    struct heard *heard;
    struct listener *all;
    size_t count, ended;
    FILE *record;
};

static void put32(uint8_t *at, uint32_t value) {
    for (int i = 0; i < 4; i++)
        at[i] = (uint8_t)(value >> (8 * i));
}

static void record(const struct crowd *s, const uint8_t *data, size_t size, int opcode, double now) {
    uint8_t head[9];
    put32(head, (uint32_t)(now - s->heard->first[0]));
    head[4] = (uint8_t)opcode;
    put32(head + 5, (uint32_t)size);
    fwrite(head, 1, sizeof head, s->record);
    fwrite(data, 1, size, s->record);
}

static void on_message(void *ctx, struct client *client, int opcode, const uint8_t *data, size_t size) {
    struct crowd *s = ctx;
    struct listener *l = (struct listener *)client;
    double now = now_ms();
    if (opcode == CLIENT_TEXT && !l->done && holds(data, size, "\"type\":\"begin\""))
        l->counts = true;
    if (!l->counts || l->heard == MESSAGES_MAX)
        return;
    uint32_t index = l->heard++;
    double first = 0;
    if (atomic_compare_exchange_strong(&s->heard->first[index], &first, now))
        first = now;
    size_t number = s->heard->messages++;
    if (number < s->heard->late_cap)
        s->heard->late[number] = now > first ? (float)(now - first) : 0;
    s->heard->bytes += size;
    if (s->record && l == s->all)
        record(s, data, size, opcode, now);
    if (opcode == CLIENT_TEXT && holds(data, size, "\"type\":\"end\"")) {
        l->counts = false;
        l->done = true;
        s->ended++;
    }
}

static void report(struct heard *h) {
    size_t n = h->messages < h->late_cap ? h->messages : h->late_cap;
    qsort(h->late, n, sizeof *h->late, ascending);
    printf("{\"messages\":%zu,\"bytes\":%llu,\"p50\":%.3f,\"p99\":%.3f,\"max\":%.3f}\n", (size_t)h->messages,
           (unsigned long long)h->bytes, h->late[n / 2], h->late[n * 99 / 100], h->late[n - 1]);
    fflush(stdout);
}

static size_t read_ports(char *list, int ports[PORTS_MAX]) {
    size_t count = 0;
    for (char *port = strtok(list, ","); port && count < PORTS_MAX; port = strtok(NULL, ","))
        ports[count++] = atoi(port);
    return count;
}

/* Listens until the process ends. from: number of its first listener. */
static void listen_on(struct crowd *s, const int *ports, size_t port_count, size_t from, const char *path) {
    clients_open(&s->clients);
    s->all = calloc(s->count, sizeof *s->all);
    for (size_t dialled = 0; dialled < s->count;) {
        for (size_t i = 0; i < BATCH && dialled < s->count; i++, dialled++)
            client_dial(&s->clients, &s->all[dialled].client, ports[(from + dialled) % port_count], path);
        while (s->clients.opened < dialled)
            clients_serve(&s->clients, 1000);
    }
    for (s->clients.last = now_ms(); now_ms() - s->clients.last < 500;)
        clients_serve(&s->clients, 100);
    s->heard->quiet++;
    while (s->ended < s->count)
        clients_serve(&s->clients, 1000);
    if (s->record)
        fclose(s->record);
    s->heard->done++;
    for (;;)
        clients_serve(&s->clients, 1000);
}

/* Waits until all processes have reached a stage; a process that exits has failed. */
static void wait_for(const atomic_size_t *count, size_t all) {
    while (*count < all) {
        if (waitpid(-1, NULL, WNOHANG) > 0)
            exit(1);
        poll(NULL, 0, 10);
    }
}

static size_t files_of_one(void) {
    struct rlimit most;
    if (getrlimit(RLIMIT_NOFILE, &most) || most.rlim_cur <= OTHER_FILES)
        die("descriptors");
    return most.rlim_cur - OTHER_FILES;
}

int main(int argc, char **argv) {
    int ports[PORTS_MAX];
    size_t port_count = argc > 3 ? read_ports(argv[1], ports) : 0;
    size_t count = port_count ? strtoul(argv[3], NULL, 10) : 0;
    if (!count)
        return 2;
    size_t processes = (count - 1) / files_of_one() + 1;
    size_t size = sizeof(struct heard) + count * EACH_MAX * sizeof(float);
    struct heard *heard =
        mmap(NULL, size, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    if (heard == MAP_FAILED)
        die("memory");
    heard->late_cap = count * EACH_MAX;
    pid_t children[processes];
    for (size_t i = 0; i < processes; i++) {
        size_t from = count * i / processes;
        struct crowd s = {.heard = heard, .count = count * (i + 1) / processes - from};
        s.clients = (struct clients){.message = on_message, .ctx = &s};
        s.record = argc > 4 && !i ? fopen(argv[4], "wb") : NULL;
        children[i] = fork();
        if (children[i] < 0)
            die("fork");
        if (!children[i]) {
            prctl(PR_SET_PDEATHSIG, SIGKILL);
            listen_on(&s, ports, port_count, from, argv[2]);
        }
        if (s.record)
            fclose(s.record);
    }
    wait_for(&heard->quiet, processes);
    puts("ready");
    fflush(stdout);
    wait_for(&heard->done, processes);
    report(heard);
    int end = getchar();
    for (size_t i = 0; i < processes; i++)
        kill(children[i], SIGKILL);
    return end == EOF ? 0 : 1;
}
