/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How far the alignment of a work's recording is, as it is kept in WORK.alignment.json of the folder of
 * library_voices.h:
 *   {"state": "aligned" or "failed", "why": of a failure,
 *    "text", "sound": {"size", "modified", "hash"} of what it was made of,
 *    "sentences", "missing", "doubtful", "confidence", "unread", "unwritten": as protocol/library.md has
 * them} */
#ifndef FACCIA_LIBRARY_RECORDINGS_ALIGNMENT_STATE_H
#define FACCIA_LIBRARY_RECORDINGS_ALIGNMENT_STATE_H

#include "server/base/error.h"
#include <jansson.h>
#include <stdbool.h>

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

/* What a file is now: {"size", "modified"}; NULL: it is not there. */
json_t *alignment_stamp(const char *path);

/* Is the file what its stamp says, by size and time? */
bool alignment_is_of(const json_t *report, const char *member, const char *path);

/* As it is kept: WAITING, ALIGNED, STALE or FAILED. *why, to be freed, is NULL but for FAILED. */
enum alignment_state alignment_state_kept(const char *folder, const char *work, const char *sound,
                                          char **why);

/* Keeps that it failed, until text or sound change. */
int alignment_keep_failure(const char *folder, const char *work, const char *sound, const char *why,
                           struct error *e);

/* Adds what is told of an aligned one to an object: of all passages with the work's figures, or of one
 * section's (0 = all). */
void alignment_tell(const char *folder, const char *work, unsigned section, json_t *object);

#endif
