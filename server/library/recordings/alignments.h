/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Aligns the library's recordings to their texts in the background, one after the other. A separate process
 * (faccia-align) aligns each; a thread starts and watches it. */
#ifndef FACCIA_LIBRARY_RECORDINGS_ALIGNMENTS_H
#define FACCIA_LIBRARY_RECORDINGS_ALIGNMENTS_H

#include "server/base/buf.h"
#include "server/base/error.h"
#include "server/base/work/reader_process.h"
#include <jansson.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/types.h>

/* The alignment program and its limits. */
struct aligner {
    const char *program;       /* path of faccia-align */
    const char *worker;        /* path of faccia-voice */
    const char *plugin;        /* plugin of the reference voice */
    const char *normalization; /* folder with the rules for reading texts */
    unsigned percent;          /* share of one processor, 1 to 100; 0 = alignment is off */
    unsigned megabytes;        /* limit of its address space */
    bool unconfined;           /* run without the sandbox */
};

struct alignment_job {
    pid_t pid; /* 0 = not running */
    int fd;    /* its standard output */
    char line[512];
    size_t length;
    double share;     /* of the sound aligned so far, 0 to 1 */
    char result[512]; /* its last line: "done", "failed: REASON", "later: REASON" */
};

enum alignment_end {
    ALIGNMENT_GOES_ON,
    ALIGNMENT_DONE,
    ALIGNMENT_REFUSED, /* text and sound do not match or cannot be read, which it has stored; result is the
                          reason */
    ALIGNMENT_DIED,    /* it crashed; result is the reason */
    ALIGNMENT_LATER,   /* something it needs is missing or it was killed; result is the reason */
};

/* False: it cannot be started; result is the reason. */
bool alignment_job_start(struct alignment_job *job, const struct aligner *aligner, const char *folder,
                         const char *work, const char *sound, const char *library);

/* Call when fd is readable. */
enum alignment_end alignment_job_read(struct alignment_job *job);

/* Kills its process group. */
void alignment_job_stop(struct alignment_job *job);

/* State of a work's alignment, stored as WORK.alignment.json in the folder of library_voices.h: {"state":
 * "aligned" or "failed", "why": reason of a failure, "text", "sound": {"size", "modified", "hash"} of its
 * sources, "sentences", "missing", "doubtful", "confidence", "unread", "unwritten": see
 * protocol/library.md} */

#define ALIGNMENT_ENDING ".alignment.json"

enum alignment_state {
    ALIGNMENT_WAITING,
    ALIGNMENT_ALIGNING,
    ALIGNMENT_ALIGNED,
    ALIGNMENT_STALE,
    ALIGNMENT_FAILED,
    ALIGNMENT_STATES
};
extern const char *const alignment_states[ALIGNMENT_STATES];

/* Size and time of a file as {"size", "modified"}; NULL: it does not exist. */
json_t *alignment_stamp(const char *path);

/* Loads the stored state: WAITING, ALIGNED, STALE or FAILED. *why is set for FAILED; free it. */
enum alignment_state alignment_state_kept(const char *folder, const char *work, const char *sound,
                                          char **why);

/* Stores a failure, which is valid until text or sound change. */
int alignment_keep_failure(const char *folder, const char *work, const char *sound, const char *why,
                           struct error *e);

/* Adds the results of an alignment to an object: of the whole work, with its figures (section 0), or of
 * one section. */
void alignment_tell(const char *folder, const char *work, unsigned section, json_t *object);

struct alignments;

/* A work with a recording. Times in ns since the epoch. */
struct recorded_work {
    char work[80];
    char *path, *sound; /* relative to the library's folder */
    int64_t size, modified, sound_size, sound_modified;
};

struct recorded_works {
    struct recorded_work *list;
    size_t count, cap;
};

/* folder: of the library; voices: see library_voices.h; lang: default language of works. The strings and
 * the reader must outlive it. */
struct alignments *alignments_open(const char *folder, const char *voices, const char *lang,
                                   const struct aligner *aligner, const struct reader *reader);

/* Stops thread and process: at once, or after the current block of a work. */
void alignments_close(struct alignments *alignments);

/* Replaces the list of recordings; takes ownership of it. Call it from one thread only. */
void alignments_see(struct alignments *alignments, struct recorded_works *works);

/* The functions below may be called from any thread, and with NULL. */

/* Number of recordings in each state, see "alignment" in protocol/library.md. NULL for NULL. */
json_t *alignments_summary(struct alignments *alignments);

/* State of a work's recording; NULL: it is not known to have one. */
const char *alignments_state(struct alignments *alignments, const char *work);

/* Describes a work's recording, with the results of one section (0 = all, with the work's figures). NULL:
 * none. */
json_t *alignments_recording(struct alignments *alignments, const char *work, unsigned section);

/* Appends metrics in Prometheus' text format. */
void alignments_metrics(struct alignments *alignments, struct buf *out);

#endif
