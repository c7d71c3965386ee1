/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/library/recordings/alignments.h"
#include "server/base/log.h"
#include "server/base/mem.h"
#include "server/library/library_files.h"
#include "server/library/recordings/library_voices.h"
#include <errno.h>
#include <limits.h>
#include <math.h>
#include <poll.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/eventfd.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

struct alignment {
    struct recorded_work of;
    enum alignment_state state;
    double share;
    char *why;         /* set when FAILED */
    bool given;        /* its times are in a file beside it */
    bool changed;      /* changed since it was last looked at */
    unsigned attempts; /* failed attempts since it last changed */
    double not_before; /* earliest next attempt; s of the monotonic clock */
};

struct alignments {
    const char *folder, *voices, *lang;
    const struct reader *reader;
    struct aligner aligner;
    pthread_t thread;
    int wake; /* eventfd that wakes the thread */
    atomic_bool stop;
    pthread_mutex_t mutex; /* protects what follows; only the thread changes the list, so it reads the list
                              without locking */
    struct recorded_works seen; /* replaces the list at the next turn */
    bool is_seen;
    struct alignment *list; /* sorted by work */
    size_t count;
};

/* ---- the list of recordings and their states ---- */

static void recorded_works_free(struct recorded_works *works) {
    for (size_t i = 0; i < works->count; i++) {
        free(works->list[i].path);
        free(works->list[i].sound);
    }
    free(works->list);
    *works = (struct recorded_works){0};
}

static void alignments_drop(struct alignment *list, size_t count) {
    for (size_t i = 0; i < count; i++) {
        free(list[i].of.path);
        free(list[i].of.sound);
        free(list[i].why);
    }
    free(list);
}

static int compare(const void *a, const void *b) {
    return strcmp(((const struct recorded_work *)a)->work, ((const struct recorded_work *)b)->work);
}

static struct alignment *alignments_find(const struct alignments *a, const char *work) {
    size_t low = 0, high = a->count;
    while (low < high) {
        size_t middle = (low + high) / 2;
        int order = strcmp(a->list[middle].of.work, work);
        if (!order)
            return &a->list[middle];
        if (order < 0)
            low = middle + 1;
        else
            high = middle;
    }
    return NULL;
}

static bool is_same(const struct recorded_work *a, const struct recorded_work *b) {
    return !strcmp(a->path, b->path) && !strcmp(a->sound, b->sound) && a->size == b->size &&
           a->modified == b->modified && a->sound_size == b->sound_size &&
           a->sound_modified == b->sound_modified;
}

/* Takes over the latest list. True when there is a new one. */
static bool alignments_take(struct alignments *a) {
    pthread_mutex_lock(&a->mutex);
    struct recorded_works seen = a->seen;
    bool any = a->is_seen;
    a->seen = (struct recorded_works){0};
    a->is_seen = false;
    pthread_mutex_unlock(&a->mutex);
    if (!any)
        return false;
    if (seen.count)
        qsort(seen.list, seen.count, sizeof *seen.list, compare);
    struct alignment *list = mem_alloc((seen.count + 1) * sizeof *list);
    for (size_t i = 0; i < seen.count; i++) {
        struct alignment *one = &list[i], *before = alignments_find(a, seen.list[i].work);
        *one = (struct alignment){.of = seen.list[i], .changed = true};
        if (before && is_same(&before->of, &one->of)) {
            one->changed = before->changed;
            one->attempts = before->attempts;
            one->not_before = before->not_before;
        }
        if (before) {
            one->state = before->state;
            one->share = before->share;
            one->given = before->given;
            one->why = before->why ? mem_strdup(before->why) : NULL;
        }
    }
    free(seen.list); /* its strings moved to the new list */
    struct alignment *old = a->list;
    size_t old_count = a->count;
    pthread_mutex_lock(&a->mutex);
    a->list = list;
    a->count = seen.count;
    pthread_mutex_unlock(&a->mutex);
    alignments_drop(old, old_count);
    return true;
}

static void alignments_set(struct alignments *a, struct alignment *one, enum alignment_state state,
                           const char *why) {
    char *copy = why ? mem_strdup(why) : NULL;
    pthread_mutex_lock(&a->mutex);
    free(one->why);
    one->why = copy;
    one->state = state;
    one->share = 0;
    pthread_mutex_unlock(&a->mutex);
}

/* Prepares the recording's voice if its text changed, then loads the stored alignment. */
static void look_at(struct alignments *a, struct alignment *one) {
    struct error e;
    char text[512], *why = NULL;
    char *sound = library_file_path(a->folder, one->of.sound);
    int ready = library_voice_prepare(a->folder, one->of.path, one->of.work, a->voices, a->lang, a->reader,
                                      &a->stop, &e);
    one->given = ready > 0 && library_voice_has_times(a->voices, one->of.work);
    if (ready < 0)
        alignments_set(a, one, ALIGNMENT_FAILED, error_text(&e, text, sizeof text));
    else if (!ready)
        alignments_set(a, one, ALIGNMENT_FAILED, "the work can be read only in part");
    else if (one->given)
        alignments_set(a, one, ALIGNMENT_ALIGNED, NULL);
    else {
        enum alignment_state state = alignment_state_kept(a->voices, one->of.work, sound, &why);
        alignments_set(a, one, state, why);
    }
    one->changed = false;
    free(why);
    free(sound);
}

/* Looks at the recordings that have changed. */
static void alignments_look(struct alignments *a) {
    for (size_t i = 0; i < a->count && !atomic_load(&a->stop); i++)
        if (a->list[i].changed)
            look_at(a, &a->list[i]);
}

/* ---- reports ---- */

static double hundredths(double share) {
    return round(100 * share) / 100;
}

/* Counts recordings by state, and returns the one that is being aligned, or NULL. The caller holds the
 * mutex. */
static const struct alignment *count(const struct alignments *a, size_t counts[ALIGNMENT_STATES]) {
    const struct alignment *now = NULL;
    memset(counts, 0, ALIGNMENT_STATES * sizeof *counts);
    for (size_t i = 0; i < a->count; i++) {
        counts[a->list[i].state]++;
        if (a->list[i].state == ALIGNMENT_ALIGNING)
            now = &a->list[i];
    }
    return now;
}

json_t *alignments_summary(struct alignments *a) {
    size_t counts[ALIGNMENT_STATES];
    if (!a)
        return NULL;
    json_t *summary = json_object();
    pthread_mutex_lock(&a->mutex);
    const struct alignment *now = count(a, counts);
    for (int i = 0; i < ALIGNMENT_STATES; i++)
        json_object_set_new(summary, alignment_states[i], json_integer((json_int_t)counts[i]));
    if (now) {
        json_object_set_new(summary, "work", json_string(now->of.work));
        json_object_set_new(summary, "share", json_real(hundredths(now->share)));
    }
    pthread_mutex_unlock(&a->mutex);
    return summary;
}

const char *alignments_state(struct alignments *a, const char *work) {
    if (!a)
        return NULL;
    pthread_mutex_lock(&a->mutex);
    const struct alignment *one = alignments_find(a, work);
    const char *state = one ? alignment_states[one->state] : NULL;
    pthread_mutex_unlock(&a->mutex);
    return state;
}

json_t *alignments_recording(struct alignments *a, const char *work, unsigned section) {
    if (!a)
        return NULL;
    pthread_mutex_lock(&a->mutex);
    const struct alignment *one = alignments_find(a, work);
    json_t *told = one ? json_pack("{so ss* ss ss*}", "voice", json_sprintf("recording:%s", work), "file",
                                   one->of.sound, "state", alignment_states[one->state], "why", one->why)
                       : NULL;
    if (told && one->state == ALIGNMENT_ALIGNING)
        json_object_set_new(told, "share", json_real(hundredths(one->share)));
    bool known = told && one->state == ALIGNMENT_ALIGNED && !one->given;
    pthread_mutex_unlock(&a->mutex);
    if (known)
        alignment_tell(a->voices, work, section, told);
    return told;
}

void alignments_metrics(struct alignments *a, struct buf *out) {
    size_t counts[ALIGNMENT_STATES];
    if (!a)
        return;
    pthread_mutex_lock(&a->mutex);
    const struct alignment *now = count(a, counts);
    double share = now ? now->share : 0;
    pthread_mutex_unlock(&a->mutex);
    buf_printf(out, "# HELP faccia_library_recordings Recordings of the library, by how far their alignment "
                    "is.\n# TYPE faccia_library_recordings gauge\n");
    for (int i = 0; i < ALIGNMENT_STATES; i++)
        buf_printf(out, "faccia_library_recordings{state=\"%s\"} %zu\n", alignment_states[i], counts[i]);
    buf_printf(out,
               "# HELP faccia_library_alignment_share Share of the recording that is being aligned.\n"
               "# TYPE faccia_library_alignment_share gauge\nfaccia_library_alignment_share %.4g\n",
               share);
}

/* ---- the thread: aligns recordings one after the other ---- */

enum {
    NICE = 10,
    ATTEMPTS = 3, /* failures before giving up until the recording changes or the daemon restarts */
    AGAIN_SECONDS = 20,
    LOOK_MS = 2000, /* polling interval while a retry is due */
};

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + (double)t.tv_nsec / 1e9;
}

struct worker {
    struct alignments *alignments;
    struct alignment_job job;
    char work[80]; /* work that is being aligned */
};

static void tell_done(struct alignments *a, const struct alignment *one) {
    json_t *figures = json_object();
    alignment_tell(a->voices, one->of.work, 0, figures);
    log_info("library: aligned %s: %lld sentences, %lld not heard, %lld doubtful", one->of.sound,
             (long long)json_integer_value(json_object_get(figures, "sentences")),
             (long long)json_integer_value(json_object_get(figures, "missing")),
             (long long)json_integer_value(json_object_get(figures, "doubtful")));
    json_decref(figures);
}

static void fail(struct alignments *a, struct alignment *one, const char *why) {
    log_warn("library: cannot align %s: %s", one->of.sound, why);
    alignments_set(a, one, ALIGNMENT_FAILED, why);
}

/* Schedules a retry, or gives up after ATTEMPTS failures. */
static void put_off(struct alignments *a, struct alignment *one, const char *why) {
    if (++one->attempts >= ATTEMPTS) {
        fail(a, one, why);
        return;
    }
    log_info("library: will align %s later: %s", one->of.sound, why);
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

/* Starts the next job. True when something waits for its retry. */
static bool begin(struct worker *w) {
    struct alignments *a = w->alignments;
    bool some_wait;
    struct alignment *one = next_of(a, &some_wait);
    if (!one)
        return some_wait;
    char *sound = library_file_path(a->folder, one->of.sound);
    bool started = alignment_job_start(&w->job, &a->aligner, a->voices, one->of.work, sound, a->folder);
    free(sound);
    if (!started) {
        put_off(a, one, w->job.result);
        return true;
    }
    log_info("library: aligning %s", one->of.sound);
    snprintf(w->work, sizeof w->work, "%s", one->of.work);
    alignments_set(a, one, ALIGNMENT_ALIGNING, NULL);
    return false;
}

/* Applies a new list. A running job goes on unless its recording changed or disappeared. */
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
    setpriority(PRIO_PROCESS, (id_t)syscall(SYS_gettid), NICE); /* for this thread only */
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
    a->folder = realpath(folder, NULL); /* the sandbox accepts canonical paths only */
    if (!a->folder)
        a->folder = mem_strdup(folder);
    a->aligner.program = mem_strdup(aligner->program);
    a->aligner.worker = mem_strdup(aligner->worker);
    a->aligner.plugin = mem_strdup(aligner->plugin);
    a->aligner.normalization = mem_strdup(aligner->normalization);
    a->wake = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
    pthread_mutex_init(&a->mutex, NULL);
    if (a->wake >= 0 && !pthread_create(&a->thread, NULL, run, a))
        return a;
    log_warn("library: cannot align recordings in the background: %s", strerror(errno));
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
    free((char *)a->aligner.normalization);
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
