/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the files of the alignments share. */
#ifndef FACCIA_LIBRARY_RECORDINGS_ALIGNMENTS_INTERNAL_H
#define FACCIA_LIBRARY_RECORDINGS_ALIGNMENTS_INTERNAL_H

#include "server/library/recordings/alignment_state.h"
#include "server/library/recordings/alignments.h"
#include <pthread.h>
#include <stdatomic.h>

struct alignment {
    struct recorded_work of;
    enum alignment_state state;
    double share;
    char *why;         /* of FAILED; else NULL */
    bool given;        /* its times lie beside it */
    bool changed;      /* it has not been looked at since */
    unsigned attempts; /* that came to nothing, at what it is now */
    double not_before; /* the next one; s of the monotonic clock */
};

struct alignments {
    const char *folder, *voices, *lang;
    const struct reader *reader;
    struct aligner aligner;
    pthread_t thread;
    int wake; /* eventfd: something is to be looked at */
    atomic_bool stop;
    pthread_mutex_t mutex; /* over what follows; the thread alone changes the list, and reads it freely */
    struct recorded_works seen; /* that are to take the list's place */
    bool is_seen;
    struct alignment *list; /* by work */
    size_t count;
};

/* alignments_list.c, the thread's */

/* Takes over what was seen. True when there was anything new. */
bool alignments_take(struct alignments *alignments);

/* Looks at what has changed. */
void alignments_look(struct alignments *alignments);
void alignments_set(struct alignments *alignments, struct alignment *one, enum alignment_state state,
                    const char *why);
struct alignment *alignments_find(const struct alignments *alignments, const char *work);
void alignments_drop(struct alignment *list, size_t count);

#endif
