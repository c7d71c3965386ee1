/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One recording being aligned by a process of its own (server/app/aligner.c), which is watched from the
 * thread that started it. */
#ifndef FACCIA_LIBRARY_RECORDINGS_ALIGNMENT_JOB_H
#define FACCIA_LIBRARY_RECORDINGS_ALIGNMENT_JOB_H

#include <stdbool.h>
#include <sys/types.h>

/* How recordings are aligned. */
struct aligner {
    const char *program; /* faccia-align */
    const char *worker;  /* faccia-voice */
    const char *plugin;  /* of the voice to align to */
    unsigned percent;    /* of one processor, 1 to 100; 0 = nothing is aligned */
    unsigned megabytes;  /* address space */
    bool unconfined;     /* without the sandbox */
};

struct alignment_job {
    pid_t pid; /* 0 = none runs */
    int fd;    /* what it says */
    char line[512];
    size_t length;
    double share;     /* of the sound, so far */
    char result[512]; /* its last word: "done", "failed: WHY", "later: WHY" */
};

enum alignment_end {
    ALIGNMENT_GOES_ON,
    ALIGNMENT_DONE,
    ALIGNMENT_REFUSED, /* text and sound do not fit, or cannot be read: it has kept that; result is why */
    ALIGNMENT_DIED,    /* of itself; result is why */
    ALIGNMENT_LATER,   /* what it needs is not there now, or somebody killed it; result is why */
};

/* False: it cannot be started; result is why. */
bool alignment_job_start(struct alignment_job *job, const struct aligner *aligner, const char *folder,
                         const char *work, const char *sound);

/* When there is something to read on fd. */
enum alignment_end alignment_job_read(struct alignment_job *job);

/* Kills it, with all that it has started. */
void alignment_job_stop(struct alignment_job *job);

#endif
