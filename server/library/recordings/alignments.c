/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The thread that has recordings aligned. */
#include "server/library/recordings/alignments.h"
#include "server/base/log.h"
#include "server/base/mem.h"
#include "server/library/library_files.h"
#include "server/library/recordings/alignments_internal.h"
#include <errno.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/eventfd.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

enum {
    NICE = 10,
    ATTEMPTS = 3, /* that come to nothing, before it is left until it changes or the daemon starts anew */
    AGAIN_SECONDS = 20,
    LOOK_MS = 2000, /* while something waits for its next attempt */
};

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + (double)t.tv_nsec / 1e9;
}

struct worker {
    struct alignments *alignments;
    struct alignment_job job;
    char work[80]; /* that it is about */
};

static void tell_done(struct alignments *a, const struct alignment *one) {
    json_t *figures = json_object();
    alignment_tell(a->voices, one->of.work, 0, figures);
    log_info("library: %s is aligned: %lld sentences, %lld not heard, %lld doubtful", one->of.sound,
             (long long)json_integer_value(json_object_get(figures, "sentences")),
             (long long)json_integer_value(json_object_get(figures, "missing")),
             (long long)json_integer_value(json_object_get(figures, "doubtful")));
    json_decref(figures);
}

static void fail(struct alignments *a, struct alignment *one, const char *why) {
    log_warn("library: %s cannot be aligned: %s", one->of.sound, why);
    alignments_set(a, one, ALIGNMENT_FAILED, why);
}

/* It came to nothing for now. */
static void put_off(struct alignments *a, struct alignment *one, const char *why) {
    if (++one->attempts >= ATTEMPTS) {
        fail(a, one, why);
        return;
    }
    log_info("library: %s is to be aligned later: %s", one->of.sound, why);
    one->not_before = now() + AGAIN_SECONDS;
    alignments_set(a, one, ALIGNMENT_WAITING, NULL);
}

static void ended(struct worker *w, enum alignment_end end) {
    struct alignments *a = w->alignments;
    struct alignment *one = alignments_find(a, w->work);
    struct error e;
    char *why, text[512];
    if (!one)
        return;
    char *sound = library_file_path(a->folder, one->of.sound);
    if (end == ALIGNMENT_DIED && alignment_keep_failure(a->voices, w->work, sound, w->job.result, &e))
        log_warn("library: %s", error_text(&e, text, sizeof text));
    if (end == ALIGNMENT_DONE) {
        enum alignment_state state = alignment_state_kept(a->voices, w->work, sound, &why);
        if (state == ALIGNMENT_ALIGNED)
            tell_done(a, one);
        if (state == ALIGNMENT_ALIGNED || state == ALIGNMENT_FAILED)
            alignments_set(a, one, state, why);
        else
            put_off(a, one, "text or sound changed meanwhile");
        free(why);
    } else if (end == ALIGNMENT_LATER)
        put_off(a, one, w->job.result);
    else
        fail(a, one, w->job.result);
    free(sound);
}

static struct alignment *next_of(const struct alignments *a, bool *some_wait) {
    double time = now();
    *some_wait = false;
    for (size_t i = 0; i < a->count && a->aligner.percent; i++) {
        struct alignment *one = &a->list[i];
        if (one->changed || (one->state != ALIGNMENT_WAITING && one->state != ALIGNMENT_STALE))
            continue;
        if (one->not_before <= time)
            return one;
        *some_wait = true;
    }
    return NULL;
}

/* True when something waits, but not now. */
static bool begin(struct worker *w) {
    struct alignments *a = w->alignments;
    bool some_wait;
    struct alignment *one = next_of(a, &some_wait);
    if (!one)
        return some_wait;
    char *sound = library_file_path(a->folder, one->of.sound);
    bool started = alignment_job_start(&w->job, &a->aligner, a->voices, one->of.work, sound);
    free(sound);
    if (!started) {
        put_off(a, one, w->job.result);
        return true;
    }
    log_info("library: %s is being aligned", one->of.sound);
    snprintf(w->work, sizeof w->work, "%s", one->of.work);
    alignments_set(a, one, ALIGNMENT_ALIGNING, NULL);
    return false;
}

/* What is being aligned goes on, unless it is another now, or gone. */
static void look(struct worker *w) {
    struct alignments *a = w->alignments;
    if (!alignments_take(a))
        return;
    const struct alignment *one = w->job.pid ? alignments_find(a, w->work) : NULL;
    if (w->job.pid && (!one || one->changed))
        alignment_job_stop(&w->job);
    alignments_look(a);
}

static void hear(struct worker *w) {
    struct alignments *a = w->alignments;
    enum alignment_end end = alignment_job_read(&w->job);
    if (end != ALIGNMENT_GOES_ON) {
        ended(w, end);
        return;
    }
    struct alignment *one = alignments_find(a, w->work);
    pthread_mutex_lock(&a->mutex);
    one->share = w->job.share;
    pthread_mutex_unlock(&a->mutex);
}

static void *run(void *ctx) {
    struct worker w = {.alignments = ctx};
    struct alignments *a = ctx;
    setpriority(PRIO_PROCESS, (id_t)syscall(SYS_gettid), NICE); /* of this thread alone */
    while (!atomic_load(&a->stop)) {
        uint64_t count;
        look(&w);
        bool later = !w.job.pid && begin(&w);
        struct pollfd files[] = {{.fd = a->wake, .events = POLLIN},
                                 {.fd = w.job.pid ? w.job.fd : -1, .events = POLLIN}};
        if (poll(files, 2, later ? LOOK_MS : -1) < 0 && errno != EINTR)
            break;
        if (files[0].revents && read(a->wake, &count, sizeof count) < 0)
            continue;
        if (files[1].revents)
            hear(&w);
    }
    alignment_job_stop(&w.job);
    return NULL;
}

static void wake(struct alignments *a) {
    const uint64_t one = 1;
    while (write(a->wake, &one, sizeof one) < 0 && errno == EINTR)
        continue;
}

struct alignments *alignments_open(const char *folder, const char *voices, const char *lang,
                                   const struct aligner *aligner, const struct reader *reader) {
    struct alignments *a = mem_alloc(sizeof *a);
    *a = (struct alignments){.voices = voices, .lang = lang, .reader = reader, .aligner = *aligner};
    a->folder = realpath(folder, NULL); /* the sandbox knows no other paths */
    if (!a->folder)
        a->folder = mem_strdup(folder);
    a->aligner.program = mem_strdup(aligner->program);
    a->aligner.worker = mem_strdup(aligner->worker);
    a->aligner.plugin = mem_strdup(aligner->plugin);
    a->wake = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
    pthread_mutex_init(&a->mutex, NULL);
    if (a->wake >= 0 && !pthread_create(&a->thread, NULL, run, a))
        return a;
    log_warn("library: recordings cannot be aligned in the background: %s", strerror(errno));
    a->thread = 0;
    alignments_close(a);
    return NULL;
}

void alignments_close(struct alignments *a) {
    if (!a)
        return;
    atomic_store(&a->stop, true);
    if (a->thread) {
        wake(a);
        pthread_join(a->thread, NULL);
    }
    if (a->wake >= 0)
        close(a->wake);
    recorded_works_free(&a->seen);
    alignments_drop(a->list, a->count);
    pthread_mutex_destroy(&a->mutex);
    free((char *)a->folder);
    free((char *)a->aligner.program);
    free((char *)a->aligner.worker);
    free((char *)a->aligner.plugin);
    free(a);
}

void alignments_see(struct alignments *a, struct recorded_works *works) {
    if (!a) {
        recorded_works_free(works);
        return;
    }
    pthread_mutex_lock(&a->mutex);
    recorded_works_free(&a->seen);
    a->seen = *works;
    a->is_seen = true;
    pthread_mutex_unlock(&a->mutex);
    *works = (struct recorded_works){0};
    wake(a);
}
