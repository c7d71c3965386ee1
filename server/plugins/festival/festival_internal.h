/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Shared by the files of the Festival plugin: voices, the child process, text and prosody, pieces. */
#ifndef FACCIA_PLUGINS_FESTIVAL_FESTIVAL_INTERNAL_H
#define FACCIA_PLUGINS_FESTIVAL_FESTIVAL_INTERNAL_H

#include "server/base/buf.h"
#include "server/voice/faccia-voice.h"

#include <jansson.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <sys/types.h>

/* The plugin's voices, from festival.json, where new voices and languages can be added. */

enum { FE_VOICES_MAX = 64 };

/* Spelling rules and phones of a language. */
struct fe_language {
    const char *letters;     /* non-ASCII letters that its rules read, UTF-8; all in ISO-8859-1 */
    const char *punctuation; /* ASCII punctuation that Festival strips from a word's end */
    const json_t *symbols;   /* character -> words */
    const json_t *phones;    /* Festival's name -> IPA, "" = a pause */
};

struct fe_voice {
    struct faccia_voice_info info;
    const char *festival; /* its name: "lp_diphone" */
    bool hts;             /* accepts a rate per utterance, and no pitch */
    double units;         /* factor on diphones before joining, to avoid overflow */
    double gain;          /* factor on the audio afterwards */
    struct fe_language language;
};

struct fe_voices {
    struct fe_voice list[FE_VOICES_MAX]; /* installed ones */
    size_t count;
    json_t *root; /* owns the JSON strings */
};

/* The Festival process: requests go to its standard input, answers come on descriptor 3, messages on
 * standard error. All waits can be cancelled from another thread. */

struct fe_child {
    const char *program, *script;
    pid_t pid; /* 0 = none */
    int in, out, complaints;
    struct buf answer;   /* data read */
    size_t taken;        /* bytes consumed */
    char complaint[200]; /* last line of its messages */
    int wake;            /* eventfd, written by fe_child_cancel */
    atomic_bool cancelled;
};

enum fe_result { FE_OK, FE_CANCELLED, FE_DIED };

int fe_child_open(struct fe_child *child, const char *program, const char *script);
void fe_child_close(struct fe_child *child);

/* Starts the process if none runs; returns false with errno on failure. */
bool fe_child_start(struct fe_child *child);

/* Sends a request. */
enum fe_result fe_child_send(struct fe_child *child, const struct buf *request);

/* Read the answer's next line without its end, or its next size bytes; valid until the next call. */
enum fe_result fe_child_line(struct fe_child *child, const char **line);
enum fe_result fe_child_bytes(struct fe_child *child, size_t size, const void **bytes);

/* Ends the process and describes how it had ended, or "". */
void fe_child_kill(struct fe_child *child, char *how, size_t cap);

/* From any thread: makes waits return FE_CANCELLED until fe_child_begin. */
void fe_child_cancel(struct fe_child *child);
void fe_child_begin(struct fe_child *child);

/* Text and prosody for Festival. Tokens: words in characters that the voice's rules can read, with
 * punctuation. Festival's rules fail or crash on anything else, so nothing else is passed on. */

/* Factors, 1 = unchanged. */
struct fe_prosody {
    double stretch; /* of durations */
    double pitch;   /* of the mean fundamental frequency */
    double range;   /* of its range in octaves */
    double volume;  /* of the samples */
};

/* Maps prosody and emphasis of a span to these factors. Emotions are already contained in them
 * (models/expressions.json). */
struct fe_prosody fe_prosody_of(const struct fe_voice *voice, const struct faccia_span *span);

/* Scales the samples [from, to) by gain and a volume that moves from *now to its target within some ms; a
 * soft limiter prevents overflow. */
void fe_amplify(int16_t *samples, size_t from, size_t to, uint32_t sample_rate, double gain, double volume,
                double *now);

enum { FE_WORD_BYTES = 64, FE_PUNCTUATION_BYTES = 8 };

struct fe_token {
    char word[FE_WORD_BYTES]; /* ISO-8859-1 */
    char before[FE_PUNCTUATION_BYTES], after[FE_PUNCTUATION_BYTES];
    uint32_t span;
    size_t offset, bytes; /* in the span's text */
};

struct fe_tokens {
    struct fe_token *list;
    size_t count, cap;
    char unread[64]; /* unreadable characters, UTF-8, each once, for a warning */
};

/* Appends the tokens of a text; spell: one per letter and digit. */
void fe_tokens_add(struct fe_tokens *tokens, const struct fe_language *language, uint32_t span,
                   const char *text, bool spell);

/* Appends a token again in its simplest form: runs of letters, and single digits. */
void fe_tokens_add_plain(struct fe_tokens *tokens, const struct fe_token *token);

void fe_tokens_free(struct fe_tokens *tokens);

/* A part of a sentence that Festival synthesises at once: its tokens with prosody, the request, and
 * delivery of the answer to the sink. */

struct fe_said_phone {
    char name[16];
    double start, end; /* seconds */
    uint32_t stress;
};

struct fe_said_word {
    size_t token;
    double start, end;
};

struct fe_mark {
    const char *name;
    size_t token; /* the token it precedes */
};

struct fe_piece {
    const struct fe_voice *voice;
    const struct faccia_sink *sink;
    uint64_t at; /* samples delivered */
    struct fe_tokens tokens;
    struct fe_prosody *prosody; /* of each token */
    size_t prosody_cap;
    struct fe_mark *marks;
    size_t mark_count, mark_cap, marks_given;
    /* the answer */
    struct fe_said_phone *phones;
    size_t phone_count, phone_cap;
    struct fe_said_word *words;
    size_t word_count, word_cap;
    const int16_t *samples;
    size_t sample_count;
    uint32_t sample_rate;
};

void fe_piece_begin(struct fe_piece *piece, const struct fe_voice *voice, const struct faccia_sink *sink);
void fe_piece_free(struct fe_piece *piece);

/* Collect tokens. A mark precedes the text added next. */
void fe_piece_add(struct fe_piece *piece, uint32_t span, const char *text, bool spell,
                  const struct fe_prosody *prosody);
void fe_piece_mark(struct fe_piece *piece, const char *name);

/* Returns where a stretch of at most max tokens from `from` ends, after punctuation if there is any in its
 * second half. */
size_t fe_piece_cut(const struct fe_piece *piece, size_t from, size_t max);

/* Makes the request for the tokens [from, to), with `lead` and `trail` seconds of silence. plain: in plain
 * form. */
void fe_piece_request(const struct fe_piece *piece, size_t from, size_t to, bool plain, double lead,
                      double trail, struct buf *request);

/* Reads the answer. *refused: Festival reported an error instead. */
enum fe_result fe_piece_answer(struct fe_piece *piece, struct fe_child *child, bool *refused);

/* Delivers the answer for the tokens up to `to`, with the marks before them. Returns false when the sink
 * says stop. */
bool fe_piece_deliver(struct fe_piece *piece, size_t to);

/* Delivers the remaining marks and silence, and clears the piece. Returns false when the sink says stop. */
bool fe_piece_finish(struct fe_piece *piece, double seconds);

#endif
