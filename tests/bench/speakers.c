/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Many speakers in one process, each on a separate stream, for speakers.mjs. Usage: speakers PORT COUNT
 * SPREAD WARM SECONDS PATH < TEXTS. Has each speak a line of its standard input, the first at once and the
 * last after SPREAD seconds; prints "warm" WARM seconds after that, counts for SECONDS, and prints the counts
 * as one line of JSON. A media chunk is late when it comes after the first one of its utterance by more than
 * its time stamp; a missing one counts as late, too. The delay is counted from the time at which the lead
 * allows a chunk to leave. */
#include "client.h"
#include "protocol/chunk/compact.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { BATCH = 64, LEAD_MS = 400, CHUNK_MS = 200, LATE_PER_SECOND = 24 };

struct speaker {
    struct client client; /* first */
    struct compact reader;
    char *text;
    double asked, begun, until; /* ms; until: end of the media received */
};

struct media_segment {
    struct clients clients;
    struct speaker *all;
    size_t count;
    bool counts;
    float *delays, *firsts; /* ms */
    size_t delay_count, delay_cap, first_count, late, chunks;
    double media; /* ms */
};

static double most(double a, double b) {
    return a > b ? a : b;
}

static void on_message(void *ctx, struct client *client, int opcode, const uint8_t *data, size_t size) {
    struct media_segment *s = ctx;
    struct speaker *k = (struct speaker *)client;
    struct chunk chunk;
    const uint8_t *fap;
    size_t fap_size;
    double now = now_ms();
    if (opcode == CLIENT_TEXT && holds(data, size, "\"type\":\"error\""))
        exit((fprintf(stderr, "%.*s\n", (int)size, data), 1));
    if (opcode != CLIENT_BINARY)
        return;
    const char *wrong = compact_read(&k->reader, data, size, &chunk, &fap, &fap_size);
    if (wrong)
        exit((fprintf(stderr, "a speaker's chunk: %s\n", wrong), 1));
    if (!k->begun) {
        k->begun = now;
        s->firsts[s->first_count++] = (float)(now - k->asked);
    }
    double stamp = 1000.0 * chunk.start / chunk.sample_rate;
    double length = 1000.0 * chunk.samples / chunk.sample_rate;
    k->until = k->begun + stamp + length;
    if (!s->counts || !chunk.samples)
        return;
    s->chunks++;
    s->media += length;
    s->late += now > k->begun + stamp;
    if (s->delay_count < s->delay_cap)
        s->delays[s->delay_count++] = (float)(now - most(k->begun, k->begun + stamp - LEAD_MS));
}

static char *read_line(void) {
    char *line = NULL;
    size_t cap = 0;
    ssize_t length = getline(&line, &cap, stdin);
    if (length < 2)
        exit((fprintf(stderr, "too few texts\n"), 1));
    line[length - 1] = 0;
    return line;
}

static void speak_all(struct media_segment *s, double spread) {
    double start = now_ms();
    for (size_t i = 0; i < s->count; i++) {
        double due = start + spread * 1000 * (double)i / (double)s->count;
        while (now_ms() < due)
            clients_serve(&s->clients, (int)(due - now_ms()) + 1);
        s->all[i].asked = now_ms();
        client_send(&s->all[i].client, s->all[i].text, strlen(s->all[i].text));
    }
}

static void serve_until(struct media_segment *s, double end) {
    while (now_ms() < end)
        clients_serve(&s->clients, (int)most(1, end - now_ms()));
}

/* Counts chunks that should have arrived by now. */
static void count_missing(struct media_segment *s, double now) {
    for (size_t i = 0; i < s->count; i++) {
        const struct speaker *k = &s->all[i];
        double missing = now - (k->begun > 0 ? k->until : k->asked);
        if (missing > CHUNK_MS) {
            s->late += (size_t)(missing / CHUNK_MS);
            s->chunks += (size_t)(missing / CHUNK_MS);
        }
    }
}

static float at(float *values, size_t count, double part) {
    if (!count)
        return 0;
    qsort(values, count, sizeof *values, ascending);
    return values[(size_t)((double)(count - 1) * part)];
}

static void report(struct media_segment *s) {
    printf("{\"chunks\":%zu,\"late\":%zu,\"media\":%.3f,\"p50\":%.2f,\"p99\":%.2f,", s->chunks, s->late,
           s->media / 1000, (double)at(s->delays, s->delay_count, 0.5),
           (double)at(s->delays, s->delay_count, 0.99));
    printf("\"begun\":%zu,\"first50\":%.2f,\"first99\":%.2f}\n", s->first_count,
           (double)at(s->firsts, s->first_count, 0.5), (double)at(s->firsts, s->first_count, 0.99));
    fflush(stdout);
}

int main(int argc, char **argv) {
    struct media_segment s = {.clients = {.message = on_message, .ctx = &s}};
    if (argc < 7)
        return 2;
    double spread = atof(argv[3]), warm = atof(argv[4]), seconds = atof(argv[5]);
    clients_open(&s.clients);
    s.count = strtoul(argv[2], NULL, 10);
    s.all = calloc(s.count, sizeof *s.all);
    s.firsts = calloc(s.count, sizeof *s.firsts);
    s.delay_cap = s.count * (size_t)(LATE_PER_SECOND * (seconds + 1));
    s.delays = malloc(s.delay_cap * sizeof *s.delays);
    for (size_t dialled = 0; dialled < s.count;) {
        for (size_t i = 0; i < BATCH && dialled < s.count; i++, dialled++) {
            s.all[dialled].text = read_line();
            client_dial(&s.clients, &s.all[dialled].client, atoi(argv[1]), argv[6]);
        }
        while (s.clients.opened < dialled)
            clients_serve(&s.clients, 1000);
    }
    speak_all(&s, spread);
    serve_until(&s, now_ms() + warm * 1000);
    puts("warm");
    fflush(stdout);
    s.counts = true;
    double end = now_ms() + seconds * 1000;
    serve_until(&s, end);
    count_missing(&s, end);
    report(&s);
    return getchar() == EOF ? 0 : 1;
}
