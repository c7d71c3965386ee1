/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/library/align/reference.h"
#include "server/base/error.h"
#include "server/base/lang.h"
#include "server/base/mem.h"
#include "server/base/paths.h"
#include "server/live/lip_network.h"
#include "server/voice/wire.h"
#include <errno.h>
#include <fcntl.h>
#include <jansson.h>
#include <poll.h>
#include <spawn.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/socket.h>
#include <sys/types.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

/* ---- the voice worker (faccia-voice), driven without an event loop: one request, then its replies ---- */

struct reference_worker {
    int fd;    /* -1 = not running */
    pid_t pid; /* 0 = started by the keeper */
    struct buf in;
    size_t used; /* bytes of `in` taken by the last frame */
};

#define CODE ERROR_NO_REFERENCE
enum { READ_BYTES = 64 << 10 };

extern char **environ;

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* Starts it with an empty input and its output on standard error. */
static int spawn(pid_t *pid, int fd, const char *program, const char *plugin) {
    char *args[] = {(char *)program, (char *)plugin, NULL};
    posix_spawn_file_actions_t files;
    posix_spawn_file_actions_init(&files);
    posix_spawn_file_actions_addopen(&files, 0, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_adddup2(&files, 2, 1);
    posix_spawn_file_actions_adddup2(&files, fd, WIRE_FD);
    int result = posix_spawn(pid, program, &files, NULL, args, environ);
    posix_spawn_file_actions_destroy(&files);
    return result;
}

/* Passes the other end of the socket to the keeper. */
static int ask_keeper(int fd) {
    union {
        struct cmsghdr header;
        char room[CMSG_SPACE(sizeof fd)];
    } control = {.room = {0}};
    char byte = 0;
    struct iovec data = {&byte, 1};
    struct msghdr message = {
        .msg_iov = &data, .msg_iovlen = 1, .msg_control = &control, .msg_controllen = sizeof control.room};
    struct cmsghdr *part = CMSG_FIRSTHDR(&message);
    part->cmsg_level = SOL_SOCKET;
    part->cmsg_type = SCM_RIGHTS;
    part->cmsg_len = CMSG_LEN(sizeof fd);
    memcpy(CMSG_DATA(part), &fd, sizeof fd);
    return sendmsg(WIRE_SPAWNER_FD, &message, MSG_NOSIGNAL) < 0 ? errno : 0;
}

/* Starts `program plugin`. An empty program asks the keeper (worker_keeper.h) on the descriptor that a
 * plugin's worker has for that. -1 with *e ("no-reference"). */
static int reference_worker_start(struct reference_worker *w, const char *program, const char *plugin,
                                  struct error *e) {
    int ends[2];
    *w = (struct reference_worker){.fd = -1};
    if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends))
        return error_set(e, CODE, "no voice to align with: no socket (%s)", strerror(errno));
    int result = *program ? spawn(&w->pid, ends[1], program, plugin) : ask_keeper(ends[1]);
    close(ends[1]);
    if (!result) {
        w->fd = ends[0];
        return 0;
    }
    close(ends[0]);
    w->pid = 0;
    return error_set(e, CODE, "no voice to align with: %.180s cannot be started (%s)",
                     *program ? program : "a worker", strerror(result));
}

/* Asks it to end, and waits. */
static void reference_worker_stop(struct reference_worker *w) {
    if (w->fd >= 0)
        close(w->fd);
    while (w->pid && waitpid(w->pid, NULL, 0) < 0 && errno == EINTR)
        continue;
    buf_free(&w->in);
    *w = (struct reference_worker){.fd = -1};
}

static int lost(struct reference_worker *w, const char *why, struct error *e) {
    reference_worker_stop(w);
    return error_set(e, CODE, "the voice to align with %s", why);
}

/* Sends a frame made by wire_begin and wire_end, and empties b. -1 with *e. */
static int reference_worker_send(struct reference_worker *w, struct buf *b, struct error *e) {
    for (size_t at = 0; at < b->size;) {
        ssize_t n = send(w->fd, b->data + at, b->size - at, MSG_NOSIGNAL);
        if (n < 0 && errno != EINTR)
            return lost(w, "has ended", e);
        at += n > 0 ? (size_t)n : 0;
    }
    b->size = 0;
    return 0;
}

static int read_more(struct reference_worker *w, double until, struct error *e) {
    struct pollfd socket = {.fd = w->fd, .events = POLLIN};
    double left = until - now();
    int ready = poll(&socket, 1, left > 0 ? (int)(left * 1000) + 1 : 0);
    if (!ready)
        return lost(w, "is silent", e);
    ssize_t n = ready < 0 ? -1 : read(w->fd, buf_reserve(&w->in, READ_BYTES), READ_BYTES);
    if (n == 0 || (n < 0 && errno != EINTR))
        return lost(w, "has ended", e);
    w->in.size += n > 0 ? (size_t)n : 0;
    return 0;
}

/* Returns the next frame other than a keepalive, valid until the next call. -1 with *e when it ended, sent
 * garbage or timed out. */
static int reference_worker_hear(struct reference_worker *w, struct wire_frame *frame, double seconds,
                                 struct error *e) {
    double until = now() + seconds;
    for (;;) {
        buf_consume(&w->in, w->used);
        w->used = 0;
        int found = wire_next(w->in.data, w->in.size, frame, &w->used);
        if (found < 0)
            return lost(w, "sent garbage", e);
        if (found && frame->type != WIRE_ALIVE)
            return 0;
        if (!found && read_more(w, until, e))
            return -1;
    }
}

/* A male and a female variant for every language. */
#define CONFIG "{\"variants\": [\"f2\"]}"

/* Limits of the worker, as the daemon sets them: megabytes of address space; seconds to start, and of
 * silence while speaking, plus some for each byte; processor seconds per sentence. */
enum { MEGABYTES = 4096, START_SECONDS = 30, SILENCE_SECONDS = 10, PROCESSOR_SECONDS = 600 };
#define SILENCE_PER_BYTE 0.05

struct known {
    char *id, *lang;
    bool female;
};

struct reference {
    struct reference_slot from;
    bool unconfined;
    struct reference_worker worker;
    struct known *voices;
    size_t voice_count, voice_cap;
    uint32_t job; /* number of the last sentence */
    struct lip_network *network;
};

/* Stores the list of voices. */
static void keep_voices(struct reference *r, const char *description) {
    json_t *root = json_loads(description, 0, NULL), *voice;
    size_t i;
    json_array_foreach(json_object_get(root, "voices"), i, voice) {
        const char *id = json_string_value(json_object_get(voice, "id"));
        const char *lang = json_string_value(json_object_get(voice, "lang"));
        const char *gender = json_string_value(json_object_get(voice, "gender"));
        if (!id || !lang || !gender)
            continue;
        r->voices = mem_grow(r->voices, &r->voice_cap, r->voice_count + 1, sizeof *r->voices);
        r->voices[r->voice_count++] =
            (struct known){mem_strdup(id), mem_strdup(lang), !strcmp(gender, "female")};
    }
    json_decref(root);
}

static int start(struct reference *r, struct error *e) {
    const struct wire_limits limits = {MEGABYTES, START_SECONDS, !r->unconfined};
    struct wire_frame frame;
    struct buf b = {0};
    if (reference_worker_start(&r->worker, r->from.worker, r->from.path, e))
        return -1;
    size_t place = wire_begin(&b, WIRE_OPEN, 0);
    wire_put_string(&b, CONFIG);
    wire_put_limits(&b, &limits);
    wire_end(&b, place);
    int result = reference_worker_send(&r->worker, &b, e);
    buf_free(&b);
    if (result || reference_worker_hear(&r->worker, &frame, START_SECONDS, e))
        return -1;
    struct wire_reader reader = wire_read(&frame);
    const char *text = wire_get_string(&reader);
    if (text && frame.type == WIRE_HELLO) {
        if (!r->voice_count)
            keep_voices(r, text);
        return 0;
    }
    error_set(e, CODE, "no voice to align with: %s", text ? text : "its worker sent invalid data");
    reference_worker_stop(&r->worker);
    return -1;
}

static struct lip_network *load_network(void) {
    struct paths paths;
    struct error none; /* alignment is less exact without it */
    char path[4096];
    paths_find(&paths);
    snprintf(path, sizeof path, "%s/hear/network.bin", paths.models);
    paths_free(&paths);
    return lip_network_load(path, &none);
}

/* NULL with *e ("no-reference"). */
static struct reference *reference_open(const struct reference_slot *from, struct error *e) {
    struct reference *r = mem_alloc(sizeof *r);
    const char *sandbox = getenv("FACCIA_SANDBOX");
    r->from = *from;
    r->unconfined = from->unconfined || (sandbox && !strcmp(sandbox, "off"));
    r->worker.fd = -1;
    if (!start(r, e)) {
        r->network = load_network();
        return r;
    }
    reference_close(r);
    return NULL;
}

const struct lip_network *reference_network(const struct reference *r) {
    return r->network;
}

void reference_close(struct reference *r) {
    if (!r)
        return;
    reference_worker_stop(&r->worker);
    lip_network_free(r->network);
    for (size_t i = 0; i < r->voice_count; i++) {
        free(r->voices[i].id);
        free(r->voices[i].lang);
    }
    free(r->voices);
    free(r);
}

struct reference *reference_get(struct reference_slot *slot, struct error *e) {
    if (!slot->reference)
        slot->reference = reference_open(slot, e);
    return slot->reference;
}

pid_t reference_process(const struct reference *r) {
    return r->worker.fd >= 0 ? r->worker.pid : 0;
}

const char *reference_voice(const struct reference *r, const char *lang, const char *gender) {
    const struct known *best = NULL;
    lang = lang_usual(lang);
    size_t primary = strcspn(lang, "-");
    bool female = !strcmp(gender, "female");
    for (size_t i = 0; i < r->voice_count; i++) {
        const struct known *v = &r->voices[i];
        if (v->female != female)
            continue;
        if (!strcasecmp(v->lang, lang))
            return v->id;
        if (!best && !strncasecmp(v->lang, lang, primary) && strcspn(v->lang, "-") == primary)
            best = v;
    }
    return best ? best->id : "";
}

static bool take_audio(struct reference_speech *s, const struct wire_frame *frame) {
    struct wire_reader r = wire_read(frame);
    s->rate = wire_get_u32(&r);
    size_t count = (size_t)(r.end - r.at) / sizeof *s->pcm;
    s->pcm = mem_grow(s->pcm, &s->pcm_cap, s->samples + count, sizeof *s->pcm);
    if (count)
        memcpy(s->pcm + s->samples, r.at, count * sizeof *s->pcm);
    s->samples += count;
    return !r.bad && s->rate;
}

/* The stretch that is being spoken. */
struct spoken_stretch {
    uint64_t before; /* samples spoken earlier */
    size_t from;     /* byte where its text begins */
    const struct reference_reading *reading;
    const struct reference_part *last; /* part of the last word */
};

static const struct reference_part *part_of(const struct reference_piece *piece, size_t byte) {
    size_t i = 0;
    while (i + 1 < piece->part_count && piece->parts[i + 1].offset <= byte)
        i++;
    return piece->part_count ? &piece->parts[i] : NULL;
}

/* Finds the bytes of the stretch that a word stands for. False: none, or the word before stands for them. */
static bool place_word(struct spoken_stretch *s, const struct faccia_word *word, size_t *from, size_t *to) {
    *from = word->offset;
    *to = word->offset + word->bytes;
    if (!s->reading->count)
        return true;
    if (word->span >= s->reading->count || !word->bytes)
        return false;
    const struct reference_piece *piece = &s->reading->pieces[word->span];
    const struct reference_part *first = part_of(piece, *from), *last = part_of(piece, *to - 1);
    if (!first || (first == s->last && !first->verbatim))
        return false;
    *from = first->verbatim ? first->from + (*from - first->offset) : first->from;
    *to = last->verbatim ? last->from + (*to - last->offset) : last->to;
    s->last = last;
    return *to > *from;
}

static bool take_events(struct reference_speech *s, const struct wire_frame *frame,
                        struct spoken_stretch *stretch) {
    struct wire_reader r = wire_read(frame);
    struct wire_event event;
    const uint64_t before = stretch->before;
    while (wire_get_event(&r, &event)) {
        size_t from, to;
        if (event.kind == WIRE_PHONE) {
            const struct faccia_phone *phone = &event.phone;
            s->phones = mem_grow(s->phones, &s->phone_cap, s->phone_count + 1, sizeof *s->phones);
            struct reference_phone *p = &s->phones[s->phone_count++];
            *p = (struct reference_phone){
                .stress = (uint8_t)phone->stress, .start = before + phone->start, .end = before + phone->end};
            snprintf(p->ipa, sizeof p->ipa, "%s", phone->ipa);
        } else if (event.kind == WIRE_WORD && place_word(stretch, &event.word, &from, &to)) {
            s->words = mem_grow(s->words, &s->word_cap, s->word_count + 1, sizeof *s->words);
            s->words[s->word_count++] =
                (struct reference_word){stretch->from + from, stretch->from + to, before + event.word.start};
        }
    }
    return !r.bad;
}

/* 1 = more will come, 0 = finished. */
static int take(struct reference *r, const struct wire_frame *frame, struct reference_speech *out,
                struct spoken_stretch *stretch, struct error *e) {
    struct wire_reader reader = wire_read(frame);
    bool good = frame->job == r->job;
    if (good && frame->type == WIRE_DONE) {
        uint32_t failed = wire_get_u32(&reader);
        const char *message = wire_get_string(&reader);
        return failed ? error_set(e, CODE, "the voice to align with failed: %s", message ? message : "") : 0;
    }
    if (good && frame->type == WIRE_AUDIO)
        good = take_audio(out, frame);
    else if (good && frame->type == WIRE_EVENTS)
        good = take_events(out, frame, stretch);
    else
        good = false;
    if (good)
        return 1;
    reference_worker_stop(&r->worker);
    return error_set(e, CODE, "the voice to align with sent invalid data");
}

static int ask(struct reference *r, const char *voice, const char *text,
               const struct reference_reading *reading, struct error *e) {
    size_t count = reading->count ? reading->count : 1;
    struct faccia_span *spans = mem_alloc(count * sizeof *spans);
    for (size_t i = 0; i < count; i++)
        spans[i] = (struct faccia_span){.kind = FACCIA_SPAN_TEXT,
                                        .text = reading->count ? reading->pieces[i].words : text,
                                        .phones = reading->count ? reading->pieces[i].phones : NULL,
                                        .pitch = 1,
                                        .range = 1,
                                        .volume = 1};
    const struct faccia_sentence sentence = {.voice = voice, .spans = spans, .span_count = count};
    struct buf b = {0};
    size_t place = wire_begin(&b, WIRE_SPEAK, ++r->job);
    wire_put_u32(&b, PROCESSOR_SECONDS);
    wire_put_sentence(&b, &sentence);
    wire_end(&b, place);
    int result = reference_worker_send(&r->worker, &b, e);
    buf_free(&b);
    free(spans);
    return result;
}

void reference_reading_free(struct reference_reading *reading) {
    for (size_t i = 0; i < reading->count; i++) {
        free(reading->pieces[i].words);
        free(reading->pieces[i].phones);
        free(reading->pieces[i].parts);
    }
    free(reading->pieces);
    *reading = (struct reference_reading){0};
}

int reference_speak(struct reference *r, const char *voice, const char *text, size_t from, size_t to,
                    struct reference_speech *out, struct error *e) {
    const double silence = SILENCE_SECONDS + SILENCE_PER_BYTE * (double)(to - from);
    char *own = mem_strndup(text + from, to - from);
    struct reference_reading reading = {0};
    struct wire_frame frame;
    int more = 1;
    if (r->from.read)
        r->from.read(r->from.read_ctx, own, strlen(own), &reading);
    struct spoken_stretch stretch = {out->samples, from, &reading, NULL};
    if ((r->worker.fd < 0 && start(r, e)) || ask(r, voice, own, &reading, e))
        more = -1;
    while (more > 0 && !(more = reference_worker_hear(&r->worker, &frame, silence, e)))
        more = take(r, &frame, out, &stretch, e);
    reference_reading_free(&reading);
    free(own);
    return more;
}

void reference_clear(struct reference_speech *s) {
    s->samples = s->phone_count = s->word_count = 0;
}

void reference_free(struct reference_speech *s) {
    free(s->pcm);
    free(s->phones);
    free(s->words);
    *s = (struct reference_speech){0};
}
