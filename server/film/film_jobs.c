/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/film/film_jobs.h"
#include "server/base/mem.h"
#include "server/film/film_browser.h"
#include "server/film/film_folder.h"
#include "server/film/film_media.h"
#include "server/film/film_process.h"
#include "server/synthesis/pipeline.h"
#include "server/synthesis/synthesis.h"
#include "server/voice/sentence_audio.h"
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { ARGUMENTS = 40 };

/* Files of a job, in the jobs' folder: ID.fap and so on. */
static const char *const kinds[] = {"fap", "wav", "vtt"};
enum { FACE, SOUND, WORDS, KINDS };

struct film_job {
    struct film_jobs *jobs;
    struct film_job *next;
    char id[FILM_ID_BYTES], suffix[8];
    uint32_t client; /* its key in the quota */
    enum film_stage stage;
    bool removed;               /* freed when its thread or its process has ended */
    char *arguments[ARGUMENTS]; /* of `faccia film`, NULL-terminated */
    size_t argument_count;
    struct synthesis *synthesis;
    struct film_media media; /* its faces are not used */
    struct export face;      /* .fap */
    bool begun, too_long;
    struct error problem; /* the last one of the voice; ERROR_NONE: none */
    uv_work_t work;       /* writes the files */
    bool writing;
    int number; /* errno of writing */
    struct film_process *process;
    struct error error;
    uint64_t bytes;
};

struct film_jobs {
    const struct pipeline *pipeline;
    struct film_jobs_options options; /* owns its paths */
    struct film_folder folder;        /* made for the first job */
    struct film_job *first;           /* oldest first */
    struct film_job *current;         /* NULL: none runs */
    bool closed;
};

static const char prefix[] = "/tmp/faccia-films"; /* of the folder */

static void go_on(struct film_jobs *jobs);

static char *whole_path(const char *path) {
    char *real = path && *path ? realpath(path, NULL) : NULL;
    return real ? real : mem_strdup(path ? path : "");
}

struct film_jobs *film_jobs_new(const struct pipeline *pipeline, const struct film_jobs_options *options) {
    struct film_jobs *jobs = mem_alloc(sizeof *jobs);
    jobs->pipeline = pipeline;
    jobs->options = *options;
    jobs->options.program = whole_path(options->program);
    jobs->options.models = whole_path(options->models);
    jobs->options.web = whole_path(options->web);
    if (options->most)
        film_folder_sweep(prefix);
    return jobs;
}

/* Files */

static void file_of(const struct film_job *job, const char *suffix, char out[PATH_MAX]) {
    snprintf(out, PATH_MAX, "%s/%s.%s", job->jobs->folder.path, job->id, suffix);
}

static void remove_inputs(const struct film_job *job) {
    char path[PATH_MAX];
    for (int i = 0; i < KINDS; i++) {
        file_of(job, kinds[i], path);
        unlink(path);
    }
}

/* Returns errno, or 0. */
static int write_one(const struct film_job *job, int kind, const struct buf *bytes) {
    char path[PATH_MAX];
    file_of(job, kinds[kind], path);
    FILE *file = fopen(path, "wbx");
    bool well = file && fwrite(bytes->data, 1, bytes->size, file) == bytes->size;
    well = file && !fclose(file) && well;
    return well ? 0 : errno ? errno : EIO;
}

static void free_media(struct film_job *job) {
    if (job->begun) {
        film_media_free(&job->media);
        export_free(&job->face);
    }
    synthesis_free(job->synthesis);
    job->synthesis = NULL;
    job->begun = false;
}

static void free_job(struct film_job *job) {
    char path[PATH_MAX];
    free_media(job);
    remove_inputs(job);
    file_of(job, job->suffix, path);
    unlink(path);
    for (size_t i = 0; i < job->argument_count; i++)
        free(job->arguments[i]);
    free(job);
}

/* The end of a job */

static bool is_finished(const struct film_job *job) {
    return job->stage == FILM_DONE || job->stage == FILM_STOPPED;
}

/* Frees what it needed, and starts the next one. */
static void finish(struct film_job *job, enum film_stage stage) {
    struct film_jobs *jobs = job->jobs;
    job->stage = stage;
    jobs->current = NULL;
    if (job->removed) {
        free_job(job);
    } else {
        free_media(job);
        remove_inputs(job);
    }
    go_on(jobs);
}

/* Drawing */

/* The message after the last "faccia: " that the program has printed. */
static void take_message(struct film_job *job, const char *said) {
    static const char before[] = "faccia: ", film[] = "film: ";
    const char *message = NULL;
    for (const char *at = said; (at = strstr(at, before)); at += strlen(before))
        message = at + strlen(before);
    if (message && !strncmp(message, film, strlen(film)))
        message += strlen(film);
    if (!message)
        message = "the film cannot be made";
    int length = (int)strlen(message);
    while (length && message[length - 1] == ' ')
        length--;
    error_set(&job->error, ERROR_FILM_FAILED, "%.*s", length, message);
}

static void on_drawn(void *ctx, bool well) {
    struct film_job *job = ctx;
    struct stat status;
    char path[PATH_MAX];
    file_of(job, job->suffix, path);
    well = well && !stat(path, &status);
    if (well)
        job->bytes = (uint64_t)status.st_size;
    else
        take_message(job, film_process_said(job->process));
    film_process_close(job->process);
    job->process = NULL;
    finish(job, well ? FILM_DONE : FILM_STOPPED);
}

static void draw(struct film_job *job) {
    enum { NO_INPUT = 0 };
    static const char *const environment[] = {FILM_JOB_VARIABLE "=1", NULL};
    const struct film_process_options options = {.args = job->arguments,
                                                 .input = NO_INPUT,
                                                 .given = -1,
                                                 .folder = job->jobs->folder.path,
                                                 .environment = environment,
                                                 .ended = on_drawn,
                                                 .ctx = job};
    job->stage = FILM_DRAWING;
    job->process = film_process_start(job->jobs->pipeline->loop, &options, &job->error);
    if (!job->process)
        finish(job, FILM_STOPPED);
}

/* Writing */

static void write_files(uv_work_t *work) {
    struct film_job *job = work->data;
    const struct buf *const files[KINDS] = {&job->face.out, &job->media.sound.out, &job->media.captions.out};
    for (int i = 0; i < KINDS && !job->number; i++)
        job->number = write_one(job, i, files[i]);
}

static void after_writing(uv_work_t *work, int status) {
    struct film_job *job = work->data;
    job->writing = false;
    if (job->number || status)
        error_set(&job->error, ERROR_FILM_FAILED, "%s: %s", job->jobs->folder.path,
                  job->number ? strerror(job->number) : uv_strerror(status));
    free_media(job);
    if (job->removed || job->number || status)
        finish(job, FILM_STOPPED);
    else
        draw(job);
}

/* Speaking */

/* The voice, and its language, are known from the first segment on. */
static void begin_media(struct film_job *job) {
    const struct export_source source = export_source_of(job->synthesis);
    film_media_begin(&job->media, &source);
    export_begin(&job->face, export_by_name("fap"), &source);
    job->begun = true;
}

static void on_segment(void *ctx, struct media_segment segment) {
    struct film_job *job = ctx;
    const struct sentence_audio *audio = segment.audio;
    if (!job->begun)
        begin_media(job);
    uint64_t end = (uint64_t)segment.start + audio->samples;
    job->too_long |= end > (uint64_t)job->jobs->options.seconds * audio->sample_rate;
    job->media.captions.source.text = synthesis_request(job->synthesis)->text;
    if (!job->too_long && film_media_add(&job->media, &segment, job->media.faces.source.fps)) {
        buf_consume(&job->media.faces.out, job->media.faces.out.size);
        export_segment(&job->face, &segment);
    }
    media_segment_free(&segment);
    if (job->too_long) {
        error_set(&job->error, ERROR_TEXT_TOO_LONG, "a film may take at most %u seconds",
                  job->jobs->options.seconds);
        finish(job, FILM_STOPPED);
    } else {
        synthesis_release(job->synthesis);
    }
}

static void on_problem(void *ctx, const struct error *e, bool warning) {
    struct film_job *job = ctx;
    if (!warning)
        job->problem = *e;
}

static void on_spoken(void *ctx, size_t spoken) {
    struct film_job *job = ctx;
    if (!spoken) {
        job->error = job->problem;
        if (job->problem.code == ERROR_NONE)
            error_plain(&job->error, ERROR_EMPTY_TEXT);
        finish(job, FILM_STOPPED);
        return;
    }
    film_media_end(&job->media);
    export_end(&job->face);
    job->work.data = job;
    job->writing = true;
    uv_queue_work(job->jobs->pipeline->loop, &job->work, write_files, after_writing);
}

static const struct synthesis_callbacks callbacks = {on_segment, on_problem, on_spoken};

/* Begins a job; without a voice, by drawing. */
static void start(struct film_job *job) {
    job->jobs->current = job;
    if (!job->synthesis) {
        draw(job);
        return;
    }
    job->stage = FILM_SPEAKING;
    synthesis_start(job->synthesis);
}

static void go_on(struct film_jobs *jobs) {
    for (struct film_job *job = jobs->first; job && !jobs->current && !jobs->closed; job = job->next)
        if (job->stage == FILM_WAITING)
            start(job);
}

/* Adding */

static int make_folder(struct film_jobs *jobs, struct error *e) {
    if (jobs->folder.path || !film_folder_make(&jobs->folder, prefix))
        return 0;
    return error_set(e, ERROR_FILM_FAILED, "%s: %s", prefix, strerror(errno));
}

int film_jobs_check(const struct film_jobs *jobs, struct error *e) {
    if (!jobs->options.most)
        return error_set(e, ERROR_FILM_FAILED, "this server makes no films (--max-films 0)");
    if (!*jobs->options.program || access(jobs->options.program, X_OK))
        return error_set(e, ERROR_FILM_FAILED, "the server has no program 'faccia', which makes films");
    if (!film_browser_found() || !film_process_found("ffmpeg"))
        return error_set(e, ERROR_FILM_FAILED,
                         "the server needs chromium-headless-shell and ffmpeg to make films");
    return 0;
}

/* Removes the oldest finished job, of a client or of all, if there are as many as may be. -1 with *e. */
static int make_room_for(struct film_jobs *jobs, const uint32_t *client, unsigned most, struct error *e) {
    struct film_job *oldest = NULL;
    unsigned count = 0;
    for (struct film_job *job = jobs->first; job; job = job->next) {
        if (client && job->client != *client)
            continue;
        count++;
        if (!oldest && is_finished(job))
            oldest = job;
    }
    if (count < most)
        return 0;
    if (!oldest)
        return error_set(e, ERROR_QUEUE_FULL, "%u films%s are being made or are waiting", count,
                         client ? " of this client" : "");
    film_job_remove(oldest);
    return 0;
}

static int make_room(struct film_jobs *jobs, uint32_t client, struct error *e) {
    return make_room_for(jobs, &client, jobs->options.most_of_client, e) ||
                   make_room_for(jobs, NULL, jobs->options.most, e)
               ? -1
               : 0;
}

static void add_argument(struct film_job *job, const char *text) {
    job->arguments[job->argument_count++] = mem_strdup(text);
}

static void add_option(struct film_job *job, const char *name, const char *value) {
    if (!value)
        return;
    add_argument(job, name);
    add_argument(job, value);
}

static void add_arguments(struct film_job *job, const struct film_order *order) {
    const struct film_jobs_options *o = &job->jobs->options;
    char path[PATH_MAX], life[32];
    snprintf(life, sizeof life, "%g", order->speech->life);
    add_argument(job, o->program);
    add_option(job, "--models", o->models);
    add_option(job, "--web", o->web);
    add_argument(job, "film");
    static const char *const options[KINDS] = {"--from", "--audio", "--words"};
    for (int i = 0; i < KINDS && job->synthesis; i++) {
        file_of(job, kinds[i], path);
        add_option(job, options[i], path);
    }
    file_of(job, job->suffix, path);
    add_option(job, "--output", path);
    add_option(job, "--model", order->model);
    add_option(job, "--partner", order->partner);
    add_option(job, "--size", order->size);
    add_option(job, "--background", order->background);
    add_option(job, "--view", order->view);
    add_option(job, "--quality", order->quality);
    add_option(job, "--captions", order->captions);
    add_option(job, "--at", order->at);
    add_option(job, "--expression", order->expression);
    if (order->speech->still)
        add_argument(job, "--still");
    if (order->speech->life >= 0)
        add_option(job, "--life", life);
}

struct film_job *film_jobs_add(struct film_jobs *jobs, const struct film_order *order, struct error *e) {
    char id[FILM_ID_BYTES];
    if (film_jobs_check(jobs, e) || make_folder(jobs, e) || film_secret(id, sizeof id, e))
        return NULL;
    struct film_job *job = mem_alloc(sizeof *job);
    job->jobs = jobs;
    memcpy(job->id, id, sizeof id);
    job->client = order->speech->quota_key;
    snprintf(job->suffix, sizeof job->suffix, "%s", order->suffix);
    if (!order->expression)
        job->synthesis = synthesis_open(jobs->pipeline, order->speech, &callbacks, job, e);
    if ((!job->synthesis && !order->expression) || make_room(jobs, job->client, e)) {
        free_job(job);
        return NULL;
    }
    add_arguments(job, order);
    struct film_job **end = &jobs->first;
    while (*end)
        end = &(*end)->next;
    *end = job;
    go_on(jobs);
    return job;
}

/* Looking */

struct film_job *film_jobs_find(struct film_jobs *jobs, const char *id) {
    for (struct film_job *job = jobs->first; job; job = job->next)
        if (!strcmp(job->id, id))
            return job;
    return NULL;
}

const char *film_job_id(const struct film_job *job) {
    return job->id;
}

enum film_stage film_job_stage(const struct film_job *job) {
    return job->stage;
}

/* The program prints lines such as "  30 %: picture 30 of 100". */
double film_job_share(const struct film_job *job) {
    static const char mark[] = " %: picture ";
    double share = job->stage == FILM_DONE ? 1 : 0;
    const char *at = job->process ? film_process_said(job->process) : "";
    while ((at = strstr(at, mark))) {
        unsigned drawn, all;
        at += strlen(mark);
        if (sscanf(at, "%u of %u", &drawn, &all) == 2 && all && drawn <= all)
            share = (double)drawn / all;
    }
    return share;
}

const struct error *film_job_error(const struct film_job *job) {
    return &job->error;
}

const char *film_job_suffix(const struct film_job *job) {
    return job->suffix;
}

uint64_t film_job_bytes(const struct film_job *job) {
    return job->bytes;
}

int film_job_open(const struct film_job *job) {
    char path[PATH_MAX];
    file_of(job, job->suffix, path);
    return open(path, O_RDONLY | O_CLOEXEC);
}

/* The end */

void film_job_remove(struct film_job *job) {
    struct film_job **at = &job->jobs->first;
    while (*at != job)
        at = &(*at)->next;
    *at = job->next;
    job->removed = true;
    if (job->process)
        film_process_interrupt(job->process);
    else if (job->writing) /* freed afterwards */
        return;
    else if (job->jobs->current == job)
        finish(job, FILM_STOPPED);
    else
        free_job(job);
}

void film_jobs_close(struct film_jobs *jobs) {
    if (!jobs)
        return;
    jobs->closed = true;
    while (jobs->first)
        film_job_remove(jobs->first);
}

void film_jobs_free(struct film_jobs *jobs) {
    if (!jobs)
        return;
    film_folder_remove(&jobs->folder);
    free((char *)jobs->options.program);
    free((char *)jobs->options.models);
    free((char *)jobs->options.web);
    free(jobs);
}
