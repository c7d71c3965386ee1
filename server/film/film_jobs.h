/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Films made for clients of the daemon, one at a time: a job speaks its text with the daemon's voices, then
 * `faccia film` draws it in a process of its own. */
#ifndef FACCIA_FILM_FILM_JOBS_H
#define FACCIA_FILM_FILM_JOBS_H

#include "server/base/error.h"
#include <stdbool.h>
#include <stdint.h>

struct pipeline;
struct speech_request;

struct film_jobs_options {
    const char *program;      /* path of faccia; "": no films can be made */
    const char *models, *web; /* folders */
    unsigned most;            /* jobs, finished ones included; 0: no films */
    unsigned most_of_client;  /* the same of one client */
    unsigned seconds;         /* longest film */
};

/* What is filmed; borrowed. The texts are those of the options of `faccia film`, NULL: not given. */
struct film_order {
    const struct speech_request *speech;
    const char *suffix; /* of the file: "mp4" */
    const char *model, *partner, *size, *background, *view, *quality, *captions;
    const char *at, *expression; /* of a .png; with an expression, nothing is spoken */
};

enum film_stage { FILM_WAITING, FILM_SPEAKING, FILM_DRAWING, FILM_DONE, FILM_STOPPED };

enum { FILM_ID_BYTES = 33 };

/* In the environment of a `faccia film` that makes a job: it ends with the daemon. */
#define FILM_JOB_VARIABLE "FACCIA_FILM_JOB"

struct film_job;
struct film_jobs;

struct film_jobs *film_jobs_new(const struct pipeline *pipeline, const struct film_jobs_options *options);

/* Whether films can be made here; -1 with *e ("film-failed"), which says what is missing. */
int film_jobs_check(const struct film_jobs *jobs, struct error *e);

/* Adds a job. Returns NULL with *e: "film-failed" if films cannot be made here, "queue-full" if all jobs, or
 * all of the client, are unfinished, or as synthesis_open. The oldest finished job makes room for it: that of
 * the client if it has as many as it may. */
struct film_job *film_jobs_add(struct film_jobs *jobs, const struct film_order *order, struct error *e);

/* Returns NULL if there is none. A job is valid until the loop's next turn. */
struct film_job *film_jobs_find(struct film_jobs *jobs, const char *id);

/* Stops the job if it runs, and removes its film. */
void film_job_remove(struct film_job *job);

const char *film_job_id(const struct film_job *job);
enum film_stage film_job_stage(const struct film_job *job);
double film_job_share(const struct film_job *job);              /* of its pictures that are drawn, 0 to 1 */
const struct error *film_job_error(const struct film_job *job); /* of FILM_STOPPED */
const char *film_job_suffix(const struct film_job *job);
uint64_t film_job_bytes(const struct film_job *job); /* of FILM_DONE */
int film_job_open(const struct film_job *job);       /* descriptor of its film; -1 with errno */

/* Stops all jobs. Then run the loop until it is empty and free them. NULL is allowed. */
void film_jobs_close(struct film_jobs *jobs);
void film_jobs_free(struct film_jobs *jobs);

#endif
