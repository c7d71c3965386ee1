/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/live/opus_process.h"
#include "server/base/buf.h"
#include "server/base/files.h"
#include "server/base/mem.h"
#include <errno.h>
#include <fcntl.h>
#include <opus/opus.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* Processor time for all packets: twelve hours of speech take less than ten minutes. */
enum { MEGABYTES = 512, SECONDS = 3600, WHY_BYTES = 160, OPUS_CHANNELS = 2 };

/* Precedes each packet to the process. */
struct question {
    uint32_t size; /* 0 = lost */
};

/* Precedes the samples of each packet from the process. */
struct answer {
    int32_t status;  /* 0, or an error of libopus */
    uint32_t frames; /* 16-bit samples of all channels follow */
    uint32_t size;   /* of the packet */
};

int opus_packet_decode(struct OpusDecoder *opus, unsigned rate, const uint8_t *bytes, size_t size,
                       int16_t *samples, int *concealed) {
    const int lost = (int)rate / OPUS_PACKETS_A_SECOND, most = lost * OPUS_PACKET_LONGEST;
    bool whole = bytes && size && size <= OPUS_PACKET_BYTES_MOST;
    int frames = whole ? opus_decode(opus, bytes, (opus_int32)size, samples, most, 0) : OPUS_INVALID_PACKET;
    *concealed = frames < 0 ? opus_decode(opus, NULL, 0, samples, lost, 0) : 0;
    return frames;
}

/* ---- child ---- */

static bool read_exactly(int fd, void *data, size_t size) {
    char *at = data;
    while (size) {
        ssize_t got = read(fd, at, size);
        if (got < 0 && errno == EINTR)
            continue;
        if (got <= 0)
            return false;
        at += got;
        size -= (size_t)got;
    }
    return true;
}

static bool answer_packet(OpusDecoder *opus, unsigned rate, unsigned channels, const uint8_t *packet,
                          size_t size, int16_t *samples, int out) {
    int concealed, frames = opus_packet_decode(opus, rate, packet, size, samples, &concealed);
    struct answer a = {.size = (uint32_t)size};
    a.status = frames < 0 ? frames : 0;
    a.frames = (uint32_t)(frames > 0 ? frames : concealed > 0 ? concealed : 0);
    return write_all(out, &a, sizeof a) && write_all(out, samples, a.frames * channels * sizeof *samples);
}

int opus_process_serve(unsigned rate, unsigned channels, int in, int out) {
    int status = OPUS_OK;
    OpusDecoder *opus = opus_decoder_create((opus_int32)rate, (int)channels, &status);
    if (status != OPUS_OK)
        return -1;
    uint8_t *packet = mem_alloc(OPUS_PACKET_BYTES_MOST);
    int16_t *samples =
        mem_alloc((size_t)rate / OPUS_PACKETS_A_SECOND * OPUS_PACKET_LONGEST * channels * sizeof *samples);
    struct question q;
    bool well = true;
    while (well && read_exactly(in, &q, sizeof q))
        well = q.size <= OPUS_PACKET_BYTES_MOST && read_exactly(in, packet, q.size) &&
               answer_packet(opus, rate, channels, packet, q.size, samples, out);
    free(packet);
    free(samples);
    opus_decoder_destroy(opus);
    return well ? 0 : -1;
}

/* ---- parent ---- */

struct opus_process {
    struct reader_process process;
    uv_pipe_t to, from;
    uv_timer_t timer;
    unsigned handles; /* not closed yet */
    unsigned rate, channels;
    const struct opus_process_calls *calls;
    void *ctx;
    struct buf heard; /* the beginning of the next answer */
    size_t waiting;   /* bytes sent without an answer, with their headers */
    uint64_t at;      /* bytes answered */
    bool ended;
    char room[65536];
};

struct sent {
    uv_write_t write;
    struct question head;
    uint8_t packet[];
};

static void on_closed(uv_handle_t *handle) {
    struct opus_process *p = handle->data;
    if (--p->handles)
        return;
    buf_free(&p->heard);
    free(p);
}

/* Ends the process, and keeps the reason. */
static void end(struct opus_process *p, char *why, size_t cap) {
    if (p->ended)
        return;
    p->ended = true;
    p->waiting = 0;
    uv_timer_stop(&p->timer);
    uv_read_stop((uv_stream_t *)&p->from);
    reader_process_end(&p->process, why, cap);
}

static void fail(struct opus_process *p, const char *reason) {
    char why[WHY_BYTES] = "";
    end(p, why, sizeof why);
    p->calls->failed(p->ctx, reason ? reason : *why ? why : "ended its process");
}

static void on_late(uv_timer_t *timer) {
    fail(timer->data, "took more than 10 s");
}

/* The longest wait counts from the last answer. */
static void watch(struct opus_process *p) {
    if (p->waiting)
        uv_timer_start(&p->timer, on_late, OPUS_PROCESS_SECONDS * 1000, 0);
    else
        uv_timer_stop(&p->timer);
}

/* Takes a whole answer. False: it has not come, or makes no sense. */
static bool take_answer(struct opus_process *p, size_t *at) {
    const size_t most = p->rate / OPUS_PACKETS_A_SECOND * OPUS_PACKET_LONGEST, left = p->heard.size - *at;
    struct answer a;
    if (left < sizeof a)
        return false;
    memcpy(&a, (char *)p->heard.data + *at, sizeof a);
    size_t bytes = (size_t)a.frames * p->channels * sizeof(int16_t);
    size_t asked = a.size + sizeof(struct question);
    if (a.frames > most || a.status > 0 || asked > p->waiting) {
        fail(p, "made the process that reads it send invalid data");
        return false;
    }
    if (left < sizeof a + bytes)
        return false;
    int16_t *samples = mem_alloc(bytes + 1);
    memcpy(samples, (char *)p->heard.data + *at + sizeof a, bytes);
    *at += sizeof a + bytes;
    p->waiting -= asked;
    uint64_t from = p->at;
    p->at += a.size;
    p->calls->packet(p->ctx, samples, a.frames, a.status, from);
    free(samples);
    return !p->ended;
}

static void on_room(uv_handle_t *handle, size_t wanted, uv_buf_t *room) {
    struct opus_process *p = handle->data;
    (void)wanted;
    *room = uv_buf_init(p->room, sizeof p->room);
}

static void on_read(uv_stream_t *stream, ssize_t size, const uv_buf_t *room) {
    struct opus_process *p = stream->data;
    size_t at = 0;
    if (p->ended || !size)
        return;
    if (size < 0) {
        fail(p, NULL);
        return;
    }
    buf_add(&p->heard, room->base, (size_t)size);
    while (take_answer(p, &at))
        continue;
    buf_consume(&p->heard, at);
    if (!p->ended && at)
        watch(p);
}

static void on_written(uv_write_t *write, int status) {
    (void)status; /* a process that is gone is noticed by its silence */
    free(write->data);
}

bool opus_process_write(struct opus_process *p, const uint8_t *bytes, size_t size) {
    if (p->ended)
        return true;
    size = size <= OPUS_PACKET_BYTES_MOST ? size : 0;
    if (p->waiting + size + sizeof(struct question) > OPUS_PROCESS_WAITING)
        return false;
    struct sent *sent = mem_alloc(sizeof *sent + size);
    sent->head.size = (uint32_t)size;
    if (size)
        memcpy(sent->packet, bytes, size);
    sent->write.data = sent;
    uv_buf_t parts[] = {uv_buf_init((char *)&sent->head, sizeof sent->head),
                        uv_buf_init((char *)sent->packet, (unsigned)size)};
    if (uv_write(&sent->write, (uv_stream_t *)&p->to, parts, size ? 2 : 1, on_written)) {
        free(sent);
        return true; /* the process is gone, which on_read tells */
    }
    bool first = !p->waiting;
    p->waiting += size + sizeof sent->head;
    if (first)
        watch(p);
    return true;
}

bool opus_process_waits(const struct opus_process *p) {
    return p->waiting > 0;
}

void opus_process_free(struct opus_process *p) {
    char why[WHY_BYTES];
    if (!p)
        return;
    end(p, why, sizeof why);
    uv_close((uv_handle_t *)&p->to, on_closed);
    uv_close((uv_handle_t *)&p->from, on_closed);
    uv_close((uv_handle_t *)&p->timer, on_closed);
}

/* Gives the ends of both pipes to the loop. process.fd stays with reader_process_end, which closes it. */
static void watch_pipes(struct opus_process *p, uv_loop_t *loop, int to) {
    uv_pipe_init(loop, &p->to, 0);
    uv_pipe_init(loop, &p->from, 0);
    uv_timer_init(loop, &p->timer);
    p->to.data = p->from.data = p->timer.data = p;
    p->handles = 3;
    uv_pipe_open(&p->to, to);
    uv_pipe_open(&p->from, fcntl(p->process.fd, F_DUPFD_CLOEXEC, 0));
    uv_read_start((uv_stream_t *)&p->from, on_room, on_read);
}

struct opus_process *opus_process_new(uv_loop_t *loop, const struct reader *reader, unsigned rate,
                                      unsigned channels, const struct opus_process_calls *calls, void *ctx,
                                      struct error *e) {
    const struct reader_limits limits = {SECONDS, MEGABYTES};
    char numbers[2][16];
    snprintf(numbers[0], sizeof numbers[0], "%u", rate);
    snprintf(numbers[1], sizeof numbers[1], "%u", channels);
    const char *const args[] = {"opus", numbers[0], numbers[1], NULL};
    int ends[2];
    if (pipe2(ends, O_CLOEXEC)) {
        error_set(e, ERROR_BAD_SOUND, "Opus cannot be decoded: %s", strerror(errno));
        return NULL;
    }
    struct opus_process *p = mem_alloc(sizeof *p);
    *p = (struct opus_process){.rate = rate, .channels = channels, .calls = calls, .ctx = ctx};
    int failed = reader_process_start(&p->process, reader, &limits, args, ends[0], NULL, e);
    close(ends[0]);
    if (!failed) {
        reader_process_go_on(&p->process, UINT32_MAX / 1000); /* the timer watches each packet instead */
        watch_pipes(p, loop, ends[1]);
        return p;
    }
    close(ends[1]);
    free(p);
    e->code = ERROR_BAD_SOUND;
    return NULL;
}
