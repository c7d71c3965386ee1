/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Where the sentence that is asked for stands in a recording's text. */
#ifndef FACCIA_RECORDING_RECORDING_FOLDER_H
#define FACCIA_RECORDING_RECORDING_FOLDER_H

#include "server/align/aligned_recording.h"
#include "server/face/packs/speech_pack.h"
#include "server/voice/faccia-voice.h"

struct match {
    struct text_words tokens;        /* of all spans; bytes of the span's text */
    struct text_words before, after; /* of the text around it */
    uint32_t *spans;                 /* whose each is */
    size_t cap;
    size_t at; /* the first one's word in the recording's text */
    const struct faccia_sentence *sentence;
};

/* match starts zeroed. */
void match_words(struct match *match, const struct faccia_sentence *sentence);
void match_free(struct match *match);

/* Sets at: the place whose neighbours agree best with the text around the sentence; of several, the next from
 * that word on, or the first of all. -1 with *e, which says how far the text
 * agrees. */
int match_find(struct match *match, const struct aligned_recording *reading, size_t from, struct error *e);

/* When the word begins or ends, in samples of the stretch that begins at sample `from` and has so many. */
uint64_t match_time(const struct match *match, const struct aligned_recording *reading, size_t word, bool end,
                    uint64_t from, uint64_t samples);

/* A folder of recordings: every sound NAME.wav (.flac, .ogg, .opus, .mp3, .aiff) with its transcript NAME.txt
 * is a voice NAME. Beside them may lie NAME.json, which describes it, and a file of times (NAME.timing.json,
 * .TextGrid, .lab, .mlf, .times). */

enum { FOLDER_RECORDINGS_MAX = 10000 };

/* What a file is: another one differs in size or time. */
struct recorded_file {
    int64_t size, modified; /* -1: it is not there; ns */
};

struct recorded {
    char *id, *sound, *text;                        /* its name; paths */
    char *name, *lang, *gender, *quality, *licence; /* as voices have them */
    json_t *names;                                  /* the times' names -> IPA, or NULL */
    uint32_t rate;                                  /* Hz; 0 = the sound cannot be read */
    uint32_t words_per_minute;                      /* of its text in its time, about; 0 = not known */
    struct aligned_recording *reading;              /* NULL = not loaded */
    struct recorded_file made_of[3];                /* it: sound, transcript, times */
    uint64_t used;                                  /* when it was spoken last; larger is later */
    size_t next;                                    /* the word after the last one spoken */
};

struct folder {
    char *path, *cache; /* cache: where alignments are kept; NULL = beside the sound */
    struct recorded *list;
    size_t count, cap;
};

/* lang: of recordings that do not tell theirs. -1 with *e ("bad-voice-config"): the folder cannot be read, or
 * a description is wrong. */
int folder_open(struct folder *folder, const char *path, const char *cache, const char *lang,
                struct error *e);
void folder_close(struct folder *folder);
struct recorded *folder_find(const struct folder *folder, const char *id);

/* Loads transcript and times. packs may be empty. -1 with *e. */
int folder_load(const struct folder *folder, struct recorded *r, struct reference_slot *reference,
                const struct speech_packs *packs, const atomic_bool *stop, struct error *e);

/* Is what was loaded still what lies there? Others may change the text, or have found the times. */
bool folder_is_current(const struct folder *folder, const struct recorded *r);

/* Keeps what was found by alignment. -1 with *e. */
int folder_keep(const struct folder *folder, struct recorded *r, struct error *e);

#endif
