/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/mem.h"
#include "server/base/program.h"
#include "server/library/align/long_alignment.h"
#include "server/plugins/command/command_internal.h"
#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/eventfd.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

void cm_aligner_close(struct cm_aligner *aligner) {
    reference_close(aligner->slot.reference);
}

/* Words of a piece are byte ranges of the text. */
static void take(struct times *times, const struct long_alignment_piece *piece, const char *text) {
    times->phones = mem_grow(times->phones, &times->phone_cap, times->phone_count + piece->phone_count,
                             sizeof *times->phones);
    for (size_t i = 0; i < piece->phone_count; i++) {
        const struct long_alignment_phone *from = &piece->phones[i];
        struct times_phone *p = &times->phones[times->phone_count++];
        *p = (struct times_phone){.start = from->start, .end = from->end, .stress = from->stress};
        snprintf(p->ipa, sizeof p->ipa, "%s", from->ipa);
        snprintf(p->name, sizeof p->name, "%s", from->ipa);
    }
    times->words =
        mem_grow(times->words, &times->word_cap, times->word_count + piece->word_count, sizeof *times->words);
    for (size_t i = 0; i < piece->word_count; i++) {
        const struct long_alignment_word *w = &piece->words[i];
        times->words[times->word_count++] =
            (struct times_word){mem_strndup(text + w->from, w->to - w->from), w->start, w->end};
    }
}

/* Returns -1 with a message when there is no reference voice for the language or the sound is far too
 * short for the text; the mouth then stays closed. Whether sound and text match is not checked: the
 * program was given the text, and for short sentences the distances are inconclusive. */
static int cm_align(struct cm_aligner *aligner, const struct cm_sound *sound, const char *text,
                    const struct faccia_voice_info *voice, const atomic_bool *stop, struct times *times,
                    char *message, size_t cap) {
    struct sound_memory memory = {sound->samples, sound->count};
    const struct sound_source source = sound_in_memory(&memory, sound->rate);
    const struct long_alignment_options options = {
        .lang = voice->lang, .gender = voice->gender, .stop = stop, .made = true};
    struct error e;
    struct reference *reference = reference_get(&aligner->slot, &e);
    struct long_alignment *alignment =
        reference ? long_alignment_open(&source, reference, text, strlen(text), &options, &e) : NULL;
    struct long_alignment_piece piece;
    int found = alignment ? 1 : -1;
    while (found > 0 && (found = long_alignment_next(alignment, &piece, &e)) > 0) {
        take(times, &piece, text);
        long_alignment_piece_free(&piece);
    }
    long_alignment_free(alignment);
    if (found < 0)
        snprintf(message, cap, "the mouth stays closed: %.100s", e.message);
    return found;
}

/* Input and output of programs. */

#define RATE_USUAL 170

/* Writes a placeholder's value to out; returns NULL for an unknown one. */
static const char *value_of(const struct cm_speaking *s, const struct faccia_span *span, const char *name,
                            size_t length, char out[32]) {
    const struct faccia_voice_info *info = &s->voice->info;
    double own = info->rate ? info->rate : RATE_USUAL, rate = span->rate > 0 ? span->rate : own;
    const struct {
        const char *name;
        const char *text;
        double number;
    } known[] = {
        {"text", span->text, 0},      {"lang", info->lang, 0},      {"voice", info->id, 0},
        {"output", s->output, 0},     {"times", s->times, 0},       {"plugins", s->beside, 0},
        {"rate", NULL, round(rate)},  {"speed", NULL, rate / own},  {"stretch", NULL, own / rate},
        {"pitch", NULL, span->pitch}, {"range", NULL, span->range}, {"volume", NULL, span->volume},
    };
    for (size_t i = 0; i < sizeof known / sizeof *known; i++) {
        if (strlen(known[i].name) != length || memcmp(known[i].name, name, length) != 0)
            continue;
        snprintf(out, 32, "%.4g", known[i].number);
        return known[i].text ? known[i].text : out;
    }
    return NULL;
}

/* Fills in the placeholders of an argv word. The caller frees the result. */
static char *fill_in(const struct cm_speaking *s, const struct faccia_span *span, const char *word) {
    struct buf b = {0};
    char number[32];
    for (const char *end; *word; word = end) {
        const char *value = NULL;
        end = word + 1;
        if (*word == '{' && (end = strchr(word, '}')) != NULL)
            value = value_of(s, span, word + 1, (size_t)(end - word) - 1, number);
        end = value ? end + 1 : word + 1;
        buf_add(&b, value ? value : word, value ? strlen(value) : 1);
    }
    buf_add(&b, "", 1);
    return (char *)b.data;
}

static enum cm_result cm_run(const struct cm_run *run, struct cm_stop *stop, struct buf *out, char *message,
                             size_t cap);

enum cm_result cm_ask(const struct cm_speaking *s, const json_t *words, const struct faccia_span *span,
                      struct buf *out) {
    size_t count = json_array_size(words);
    char **argv = mem_alloc((count + 1) * sizeof *argv);
    for (size_t i = 0; i < count; i++)
        argv[i] = fill_in(s, span, json_string_value(json_array_get(words, i)));
    const struct cm_run setup = {argv, s->voice->feed ? span->text : NULL, s->voice->seconds,
                                 s->voice->bytes};
    enum cm_result result = cm_run(&setup, s->stop, out, s->message, s->cap);
    for (size_t i = 0; i < count; i++)
        free(argv[i]);
    free(argv);
    return result;
}

int cm_take_file(const struct cm_speaking *s, const char *path, struct buf *out) {
    int fd = open(path, O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
    struct stat info;
    ssize_t n = fd < 0 || fstat(fd, &info) < 0 || !S_ISREG(info.st_mode) ? -1 : 1;
    while (n > 0 && out->size <= s->voice->bytes) {
        n = read(fd, buf_reserve(out, 65536), 65536);
        out->size += n > 0 ? (size_t)n : 0;
    }
    if (fd >= 0)
        close(fd);
    unlink(path);
    if (n >= 0 && out->size <= s->voice->bytes)
        return 0;
    snprintf(s->message, s->cap, "\"%.60s\" %s", json_string_value(json_array_get(s->voice->argv, 0)),
             n < 0 ? "did not write its file" : "wrote too much");
    return -1;
}

/* Delivery to the sink: sound, phones, words. */

#define BREAK_MAX 600.0
#define PAST 0.25 /* seconds: programs round, and may count a final pause missing in the sound */

enum cm_result cm_give_silence(struct cm_speaking *s, double seconds) {
    static const int16_t silence[4096];
    size_t left = (size_t)(fmin(fmax(seconds, 0), BREAK_MAX) * s->rate), part;
    bool stop = false;
    for (; left && !stop; left -= part) {
        part = left < sizeof silence / sizeof *silence ? left : sizeof silence / sizeof *silence;
        stop = s->sink->audio(s->sink->ctx, silence, part, s->rate) != 0;
        s->at += part;
    }
    return stop ? CM_STOPPED : CM_DONE;
}

static uint64_t sample_of(const struct cm_speaking *s, double seconds) {
    return s->at + (uint64_t)(seconds * s->rate + 0.5);
}

static int give_phones(const struct cm_speaking *s, const struct times *times) {
    int stop = 0;
    for (size_t i = 0; i < times->phone_count && !stop; i++) {
        const struct times_phone *p = &times->phones[i];
        stop = s->sink->phone(s->sink->ctx, &(struct faccia_phone){p->ipa, p->name, sample_of(s, p->start),
                                                                   sample_of(s, p->end), p->stress});
    }
    return stop;
}

/* Finds the words in the span's text in order; those not found are skipped. */
static int give_words(const struct cm_speaking *s, uint32_t span, const struct times *times) {
    const char *text = s->sentence->spans[span].text;
    size_t at = 0;
    int stop = 0;
    for (size_t i = 0; i < times->word_count && !stop; i++) {
        const struct times_word *w = &times->words[i];
        const char *found = *w->text ? strstr(text + at, w->text) : NULL;
        if (!found)
            continue;
        const struct faccia_word word = {span, (size_t)(found - text), strlen(w->text),
                                         sample_of(s, w->start), sample_of(s, w->end)};
        at = word.offset + word.bytes;
        stop = s->sink->word(s->sink->ctx, &word);
    }
    return stop;
}

/* Reads the times that the program reports. */
static enum cm_result told_times(const struct cm_speaking *s, const struct faccia_span *span,
                                 struct times *times) {
    struct buf written = {0};
    struct error e;
    enum cm_result result = CM_DONE;
    if (s->voice->timing.argv)
        result = cm_ask(s, s->voice->timing.argv, span, &written);
    else if (cm_take_file(s, s->times, &written) < 0)
        result = CM_FAILED;
    if (result == CM_DONE &&
        times_read(times, &s->voice->timing.options, (char *)written.data, written.size, &e)) {
        char text[320];
        if (e.place == PLACE_LINE)
            snprintf(s->message, s->cap, "the times, line %zu: %s", e.line, e.message);
        else
            snprintf(s->message, s->cap, "the times: %s", error_text(&e, text, sizeof text));
        result = CM_FAILED;
    }
    buf_free(&written);
    return result;
}

/* Rejects times that run past the sound, because the program miscounted. */
static bool fits(const struct times *times, const struct cm_sound *sound) {
    return !times->phone_count || times->phones[times->phone_count - 1].end * sound->rate <
                                      (double)sound->count + PAST * sound->rate;
}

static void align(const struct cm_speaking *s, const char *text, const struct cm_sound *sound,
                  struct times *times) {
    char why[200];
    if (cm_align(s->aligner, sound, text, &s->voice->info, &s->stop->stopped, times, why, sizeof why))
        s->sink->warning(s->sink->ctx, why);
}

/* Finds words for a program that reports only phones, by alignment, if possible. */
static void find_words(const struct cm_speaking *s, const char *text, const struct cm_sound *sound,
                       struct times *times) {
    struct times found = {0};
    char why[200];
    if (!cm_align(s->aligner, sound, text, &s->voice->info, &s->stop->stopped, &found, why, sizeof why)) {
        times->words = found.words;
        times->word_count = found.word_count;
        found.words = NULL;
        found.word_count = 0;
    }
    times_free(&found);
}

static enum cm_result find_times(const struct cm_speaking *s, const struct faccia_span *span,
                                 const struct cm_sound *sound, struct times *times) {
    enum cm_result result = s->voice->timing.given ? told_times(s, span, times) : CM_DONE;
    bool told = s->voice->timing.given && fits(times, sound);
    if (result != CM_DONE)
        return result;
    if (s->voice->timing.given && !told) {
        s->sink->warning(s->sink->ctx, "the program's times run past its sound, which is aligned instead");
        times_free(times);
    }
    if (!told)
        align(s, span->text, sound, times);
    else if (!times->word_count)
        find_words(s, span->text, sound, times);
    return result;
}

static enum cm_result give_times(struct cm_speaking *s, uint32_t index, const struct cm_sound *sound) {
    struct times times = {0};
    enum cm_result result = find_times(s, &s->sentence->spans[index], sound, &times);
    if (*times.unnamed) {
        char text[120];
        snprintf(text, sizeof text, "the voice's table has no IPA for the phone \"%s\"", times.unnamed);
        s->sink->warning(s->sink->ctx, text);
    }
    if (result == CM_DONE && (give_phones(s, &times) || give_words(s, index, &times)))
        result = CM_STOPPED;
    times_free(&times);
    return result;
}

enum cm_result cm_give(struct cm_speaking *s, uint32_t span, const struct buf *bytes) {
    struct cm_sound sound;
    char why[160];
    if (cm_sound_read(&sound, bytes->data, bytes->size, s->voice->raw, why, sizeof why) < 0) {
        snprintf(s->message, s->cap, "\"%.60s\" %s", json_string_value(json_array_get(s->voice->argv, 0)),
                 why);
        return CM_FAILED;
    }
    s->rate = sound.rate;
    enum cm_result result = s->at ? CM_DONE : cm_give_silence(s, s->silence);
    if (result == CM_DONE)
        result = give_times(s, span, &sound);
    if (result == CM_DONE && s->sink->audio(s->sink->ctx, sound.samples, sound.count, sound.rate))
        result = CM_STOPPED;
    s->at += sound.count;
    free(sound.samples);
    return result;
}

enum { READ_BYTES = 64 << 10, PROGRAM_NOT_FOUND = 127 };

int cm_stop_open(struct cm_stop *stop) {
    stop->wake = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
    return stop->wake < 0 ? -1 : 0;
}

void cm_stop_close(struct cm_stop *stop) {
    if (stop->wake >= 0)
        close(stop->wake);
}

void cm_stop_now(struct cm_stop *stop) {
    const uint64_t one = 1;
    atomic_store(&stop->stopped, true);
    if (write(stop->wake, &one, sizeof one) < 0)
        return; /* full: already signalled */
}

void cm_stop_reset(struct cm_stop *stop) {
    uint64_t count;
    if (read(stop->wake, &count, sizeof count) < 0)
        count = 0;
    atomic_store(&stop->stopped, false);
}

/* A program and its three pipes. */
struct child {
    pid_t pid;
    int in, out, complaints;
    char complaint[160]; /* last complete line */
    char line[160];      /* line in progress */
    size_t length;
};

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

_Noreturn static void become(const struct cm_run *run, pid_t parent, int in, int out, int complaints) {
    const struct rlimit file = {run->bytes, run->bytes};
    setpgid(0, 0);
    program_end_with(parent);
    program_give_back_signals();
    signal(SIGINT, SIG_DFL);
    signal(SIGTERM, SIG_DFL);
    in = fcntl(in, F_DUPFD, 10), out = fcntl(out, F_DUPFD, 10), complaints = fcntl(complaints, F_DUPFD, 10);
    dup2(in, 0);
    dup2(out, 1);
    dup2(complaints, 2);
    close_range(3, ~0u, 0);
    setrlimit(RLIMIT_FSIZE, &file);
    execvp(run->argv[0], run->argv);
    dprintf(2, "%s\n", strerror(errno));
    _exit(PROGRAM_NOT_FOUND);
}

static void shut(int *fd) {
    if (*fd >= 0)
        close(*fd);
    *fd = -1;
}

static bool start(struct child *child, const struct cm_run *run) {
    int pipes[3][2] = {{-1, -1}, {-1, -1}, {-1, -1}};
    bool open = !pipe2(pipes[0], O_CLOEXEC) && !pipe2(pipes[1], O_CLOEXEC) && !pipe2(pipes[2], O_CLOEXEC);
    const pid_t parent = getpid();
    child->pid = open ? fork() : -1;
    if (child->pid == 0)
        become(run, parent, pipes[0][0], pipes[1][1], pipes[2][1]);
    shut(&pipes[0][0]), shut(&pipes[1][1]), shut(&pipes[2][1]);
    child->in = pipes[0][1], child->out = pipes[1][0], child->complaints = pipes[2][0];
    if (child->pid < 0)
        return false;
    setpgid(child->pid, child->pid); /* the child does the same: either may be first */
    fcntl(child->in, F_SETFL, O_NONBLOCK);
    return true;
}

static void end_line(struct child *child) {
    if (child->length)
        snprintf(child->complaint, sizeof child->complaint, "%.*s", (int)child->length, child->line);
    child->length = 0;
}

static void hear_complaint(struct child *child) {
    char text[1024];
    ssize_t n = read(child->complaints, text, sizeof text);
    for (ssize_t i = 0; i < n; i++) {
        unsigned char c = (unsigned char)text[i];
        if (c == '\n' || c == '\r')
            end_line(child);
        else if (child->length < sizeof child->line)
            child->line[child->length++] = c < ' ' || c >= 0x7F ? '?' : (char)c;
    }
    if (n <= 0) {
        end_line(child);
        shut(&child->complaints);
    }
}

static void feed(struct child *child, const char **input) {
    ssize_t n = write(child->in, *input, strlen(*input));
    if (n > 0)
        *input += n;
    if (!**input || (n < 0 && errno != EAGAIN && errno != EINTR)) /* the program need not read all input */
        shut(&child->in);
}

/* Exchanges data until the program has closed both outputs. Returns NULL, or an error. */
static const char *converse(struct child *child, const struct cm_run *run, struct cm_stop *stop,
                            struct buf *out) {
    const double deadline = now() + run->seconds;
    const char *input = run->input ? run->input : "";
    if (!*input)
        shut(&child->in);
    while (child->out >= 0 || child->complaints >= 0) {
        struct pollfd polled[] = {{child->out, POLLIN, 0},
                                  {child->complaints, POLLIN, 0},
                                  {child->in, POLLOUT, 0},
                                  {stop->wake, POLLIN, 0}};
        double left = deadline - now();
        if (atomic_load(&stop->stopped))
            return "was stopped";
        if (left <= 0)
            return "took too long";
        if (poll(polled, 4, (int)(left * 1000) + 1) < 0 && errno != EINTR)
            return "contains no speech";
        if (polled[1].revents)
            hear_complaint(child);
        if (polled[2].revents)
            feed(child, &input);
        if (!polled[0].revents)
            continue;
        ssize_t n = read(child->out, buf_reserve(out, READ_BYTES), READ_BYTES);
        if (n <= 0)
            shut(&child->out);
        else
            out->size += (size_t)n;
        if (out->size > run->bytes)
            return "wrote too much";
    }
    return NULL;
}

/* Waits for a program that has closed its outputs. */
static const char *await_end(struct child *child, double deadline, struct cm_stop *stop, int *status) {
    while (waitpid(child->pid, status, WNOHANG) == 0) {
        if (atomic_load(&stop->stopped))
            return "was stopped";
        if (now() > deadline)
            return "took too long";
        usleep(1000);
    }
    child->pid = 0;
    return NULL;
}

/* Standard output goes to *out. Returns CM_FAILED with a message that ends with the program's last line of
 * errors. */
static enum cm_result cm_run(const struct cm_run *run, struct cm_stop *stop, struct buf *out, char *message,
                             size_t cap) {
    struct child child = {.in = -1, .out = -1, .complaints = -1};
    char how[48] = "";
    int status = 0;
    double deadline = now() + run->seconds;
    const char *wrong = start(&child, run) ? converse(&child, run, stop, out) : "cannot be started";
    if (!wrong)
        wrong = await_end(&child, deadline, stop, &status);
    if (child.pid > 0) {
        kill(-child.pid, SIGKILL);
        waitpid(child.pid, NULL, 0);
    }
    shut(&child.in), shut(&child.out), shut(&child.complaints);
    end_line(&child);
    if (!wrong && WIFSIGNALED(status))
        snprintf(how, sizeof how, "was killed by signal %d", WTERMSIG(status));
    else if (!wrong && WEXITSTATUS(status) == PROGRAM_NOT_FOUND)
        snprintf(how, sizeof how, "cannot be started");
    else if (!wrong && WEXITSTATUS(status))
        snprintf(how, sizeof how, "exited with status %d", WEXITSTATUS(status));
    if (!wrong && !*how)
        return CM_DONE;
    snprintf(message, cap, "\"%.60s\" %s%s%s", run->argv[0], wrong ? wrong : how,
             *child.complaint ? ": " : "", child.complaint);
    return atomic_load(&stop->stopped) ? CM_STOPPED : CM_FAILED;
}
