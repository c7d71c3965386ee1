/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The cast of a work: which voice and which head each speaker has, and how it speaks. Chosen from what the
 * source says of its persons, always in the same way; a file WORK.cast.json beside the work overrides it. */
#ifndef FACCIA_LIBRARY_CAST_H
#define FACCIA_LIBRARY_CAST_H

#include "server/base/error.h"
#include "server/library/works/work.h"
#include <jansson.h>
#include <stdbool.h>
#include <stddef.h>

enum {
    CAST_MOST = 500, /* members; those who say least are left out, and speak as the narrator does */
    CAST_FILE_BYTES = 256 << 10,
    CAST_PROBLEMS = 20,
};

#define CAST_FILE_ENDING ".cast.json"

enum cast_age { AGE_UNKNOWN, AGE_CHILD, AGE_ADULT, AGE_OLD };

/* How its sex is known. */
enum cast_source { FROM_NOTHING, FROM_SOURCE, FROM_DESCRIPTION, FROM_NAME, FROM_FILE };

struct cast_member {
    char *id, *name, *about;     /* about NULL: none */
    char *voice, *head, *affect; /* NULL: the default */
    char *first;                 /* the first words it says; NULL: not known */
    double pitch, rate;          /* factors of the voice's own; 0: to be chosen */
    enum person_sex sex;
    enum cast_age age;
    enum cast_source sex_from;
    size_t passages, characters; /* that it speaks */
};

struct cast {
    struct cast_member narrator;
    struct cast_member *members; /* who says most comes first */
    size_t count;
    bool told;  /* of prose: the narrator tells who speaks */
    char *file; /* the one beside the work, relative to the folder; NULL: none */
    struct error problems[CAST_PROBLEMS];
    size_t problem_count;
};

/* What there is to choose from. Borrowed. */
struct cast_voice {
    const char *id, *lang, *gender, *quality;
};
struct cast_head {
    const char *name, *gender, *age; /* "": any; age "child": for children only */
};
struct cast_offer {
    const struct cast_voice *voices;
    size_t voice_count;
    const struct cast_head *heads; /* the first is the default */
    size_t head_count;
};

/* Adds a member, about whom the caller then sets what is known. In descending order of `characters`. */
struct cast_member *cast_add(struct cast *cast, const char *id, const char *name);

/* Reads a file's content into the cast: overrides persons, and notes voices and heads for cast_choose. -1
 * with *e ("bad-cast") at its line, or in a field. Unknown persons are problems of the cast. */
int cast_read(struct cast *cast, const void *data, size_t size, struct error *e);

/* True when the name ends as that of a cast. */
bool cast_file_is(const char *path);

/* Checks such a file without a work. */
int cast_check(const void *data, size_t size, struct error *e);

/* Completes sex and age by words, and gives each member a voice of the language and a head, unless the file
 * did. Those who say most choose first: a voice of their sex that few have taken, then another pitch and rate
 * of one. Without a voice of that sex, the pitch of another is changed. */
void cast_choose(struct cast *cast, const char *lang, const struct cast_offer *offer);

/* A stretch of a text that somebody speaks, in UTF-16 units. */
struct cast_speech {
    size_t start, end;
    char *who;    /* id */
    char *affect; /* by stage directions; NULL: none */
};

/* Makes the value of `speakers` (of speak) for a text; speeches ascend. voices: adds each member's voice.
 * Returns NULL if there are no speakers; the caller frees it. */
char *cast_speakers(const struct cast *cast, const struct cast_speech *speeches, size_t count, bool voices);

void cast_speeches_free(struct cast_speech *speeches, size_t count);

const struct cast_member *cast_find(const struct cast *cast, const char *id);
void cast_free(struct cast *cast);

json_t *cast_json(const struct cast *cast);

/* cast_words.c */
enum person_sex cast_sex_of_words(const char *text);                  /* of a description, or NULL */
enum person_sex cast_sex_of_name(const char *name, const char *lang); /* by the ending of a given name */
enum cast_age cast_age_of_words(const char *text);

/* The id of a speaker whom the source only names. */
void cast_id_of_name(const char *name, char out[64]);

/* cast_tally.c: counts who speaks, section by section. Zeroed at first. */
struct cast_tally {
    struct cast_tallied {
        char *id, *name, *first; /* name NULL: the text has none; first: words that it says */
        size_t order, passages, characters;
    } * list; /* sorted by id */
    size_t count, cap;
};
void cast_tally_section(struct cast_tally *tally, const struct section *section);
void cast_tally_add(struct cast_tally *tally, const char *id, const char *name, const char *text,
                    size_t size);

/* Makes the members of the cast, with what the source says of them. Frees the tally. */
void cast_tally_take(struct cast_tally *tally, const struct work_meta *meta, struct cast *cast);
void cast_tally_free(struct cast_tally *tally);

/* The id of who speaks a block. False: nobody. */
enum { CAST_ID_BYTES = 208 };
bool cast_id_of_block(const struct block *block, char out[CAST_ID_BYTES]);

/* cast_dialogue.c: the dialogue of prose. Persons have the id of their name; others are "voice-1" and
 * "voice-2". */

/* Finds who speaks text[0..size) of prose. Free the speeches: cast_speeches_free. */
void cast_dialogue_find(const char *text, size_t size, const char *lang, struct cast_speech **speeches,
                        size_t *count);

/* Bytes of a block's text that somebody speaks. */
struct cast_stretch {
    size_t block, from, to;
    char *who; /* id */
};

/* Finds who speaks in the paragraphs of a section. Free the list: cast_stretches_free. */
void cast_dialogue_stretches(const struct section *section, const char *lang, struct cast_stretch **list,
                             size_t *count);
void cast_stretches_free(struct cast_stretch *list, size_t count);

/* Adds `speeches` to the paragraphs of a section, as they are answered (protocol/library.md). */
void cast_dialogue_blocks(json_t *blocks, const char *lang);

void cast_dialogue_section(struct cast_tally *tally, const struct section *section, const char *lang);

/* library_cast.c: reads the file beside a work, if there is one. -1 with *e. */
int library_cast_beside(const char *folder, const char *path, struct cast *cast, struct error *e);

#endif
