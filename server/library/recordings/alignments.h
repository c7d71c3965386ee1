/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The recordings of the library, which a thread of its own has aligned to their texts, one after the other.
 */
#ifndef FACCIA_LIBRARY_RECORDINGS_ALIGNMENTS_H
#define FACCIA_LIBRARY_RECORDINGS_ALIGNMENTS_H

#include "server/base/buf.h"
#include "server/base/reader_process.h"
#include "server/library/recordings/alignment_job.h"
#include <jansson.h>
#include <stddef.h>
#include <stdint.h>

struct alignments;

/* A work with a recording. Times in ns. */
struct recorded_work {
    char work[80];
    char *path, *sound; /* from the library's folder on */
    int64_t size, modified, sound_size, sound_modified;
};

struct recorded_works {
    struct recorded_work *list;
    size_t count, cap;
};
void recorded_works_free(struct recorded_works *works);

/* folder: the library's; voices: of library_voices.h; lang: of works that do not tell theirs. All, and
 * the reader, must outlive it. */
struct alignments *alignments_open(const char *folder, const char *voices, const char *lang,
                                   const struct aligner *aligner, const struct reader *reader);

/* Returns when thread and process have ended: at once, or when the reading of a work can be broken off. */
void alignments_close(struct alignments *alignments);

/* What has a recording now; taken over. Called from one thread. */
void alignments_see(struct alignments *alignments, struct recorded_works *works);

/* From any thread. All may be called with NULL. */

/* How many are how far: as "alignment" of protocol/library.md. NULL with NULL. */
json_t *alignments_summary(struct alignments *alignments);

/* Of a work; NULL: it is not known to have a recording. */
const char *alignments_state(struct alignments *alignments, const char *work);

/* What is told of a work's recording, with what is told of one section (0 = all, and the work's figures).
 * NULL as above. */
json_t *alignments_recording(struct alignments *alignments, const char *work, unsigned section);

/* As metrics, in Prometheus' text format. */
void alignments_metrics(struct alignments *alignments, struct buf *out);

#endif
