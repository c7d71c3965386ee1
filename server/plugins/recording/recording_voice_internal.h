/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Shared by the files of the recording plugin: tempo, matching of text, the folder of recordings. */
#ifndef FACCIA_PLUGINS_RECORDING_RECORDING_VOICE_INTERNAL_H
#define FACCIA_PLUGINS_RECORDING_RECORDING_VOICE_INTERNAL_H

#include "server/face/packs/speech_pack.h"
#include "server/library/align/aligned_recording.h"
#include "server/voice/faccia-voice.h"
#include "server/voice/sentence_audio.h"

/* Changes the tempo of a recording without its pitch (libsonic: whole pitch periods are removed or
 * repeated), with the times of its phones and words. */

#define TEMPO_MIN 0.25
#define TEMPO_MAX 4.0

/* Speed from a sample on until the next change. */
struct tempo_change {
    uint32_t from; /* sample; 0 for the first one */
    double speed;  /* TEMPO_MIN to TEMPO_MAX */
};

/* Zero-initialised: no change. */
struct tempo {
    struct tempo_change *changes; /* sorted by sample */
    size_t count, cap;
    double scale; /* correction for rounding to whole periods, close to 1; 0 = not applied yet */
};

/* Sets the speed, clipped to the range, from that sample on, which must not be before earlier ones. */
void tempo_add(struct tempo *tempo, uint32_t from, double speed);
void tempo_free(struct tempo *tempo);

/* Stretches the sound, and moves its phones and words. */
void tempo_apply(struct tempo *tempo, struct sentence_audio *u);

/* Maps a sample of the original to the stretched audio u. Call after tempo_apply. */
uint32_t tempo_at(const struct tempo *tempo, const struct sentence_audio *u, uint64_t sample);

/* A folder of recordings, and matching of sentences to their texts. Every sound NAME.wav (.flac, .ogg,
 * .opus, .mp3, .aiff) with a transcript NAME.txt is a voice NAME. Optional: NAME.json, which describes it,
 * and a file of times (NAME.timing.json, .TextGrid, .lab, .mlf, .times). */

struct match {
    struct text_words tokens;        /* of all spans; bytes of the span's text */
    struct text_words before, after; /* of the text around it */
    uint32_t *spans;                 /* the span of each token */
    size_t cap;
    size_t at; /* index of the first one in the recording's text */
    const struct faccia_sentence *sentence;
};

/* match is zero-initialised. */
void match_words(struct match *match, const struct faccia_sentence *sentence);
void match_free(struct match *match);

/* Sets `at` to the place whose context agrees best with the text around the sentence; of several, the next
 * after that word, or the first. Returns -1 with *e, which tells how far the text agrees. */
int match_find(struct match *match, const struct aligned_recording *reading, size_t from, struct error *e);

/* Start or end of a word, in samples of the stretch that begins at sample `from`. */
uint64_t match_time(const struct match *match, const struct aligned_recording *reading, size_t word, bool end,
                    uint64_t from, uint64_t samples);

enum { FOLDER_RECORDINGS_MAX = 10000 };

/* Identifies a version of a file by size and time. */
struct recorded_file {
    int64_t size, modified; /* -1 = missing; ns */
};

struct recorded {
    char *id, *sound, *text;                        /* its name; paths */
    char *name, *lang, *gender, *quality, *licence; /* as voices have them */
    json_t *names;                                  /* maps names in the times to IPA, or NULL */
    uint32_t rate;                                  /* Hz; 0 = unreadable */
    uint32_t words_per_minute;                      /* approximate; 0 = unknown */
    struct aligned_recording *reading;              /* NULL = not loaded */
    struct recorded_file made_of[3];                /* versions of sound, transcript and times */
    uint64_t used;                                  /* sequence number of the last use */
    size_t next;                                    /* the word after the last one spoken */
};

struct folder {
    char *path, *cache; /* cache: folder of alignments; NULL = beside the sound */
    struct recorded *list;
    size_t count, cap;
};

/* lang: default language. Returns -1 with *e ("bad-voice-config") when the folder cannot be read or a
 * description is invalid. */
int folder_open(struct folder *folder, const char *path, const char *cache, const char *lang,
                struct error *e);
void folder_close(struct folder *folder);
struct recorded *folder_find(const struct folder *folder, const char *id);

/* Loads transcript and times. packs may be empty. Returns -1 with *e. */
int folder_load(const struct folder *folder, struct recorded *r, struct reference_slot *reference,
                const struct speech_packs *packs, const atomic_bool *stop, struct error *e);

/* Tells whether the files are unchanged since loading. */
bool folder_is_current(const struct folder *folder, const struct recorded *r);

/* Saves the times found by alignment. Returns -1 with *e. */
int folder_keep(const struct folder *folder, struct recorded *r, struct error *e);

#endif
