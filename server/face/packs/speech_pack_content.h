/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Contents of a speech pack, private to the face stage. The format is described in
 * models/speech/README.md. */
#ifndef FACCIA_FACE_PACKS_SPEECH_PACK_CONTENT_H
#define FACCIA_FACE_PACKS_SPEECH_PACK_CONTENT_H

#include "server/face/packs/speech_pack.h"
#include <stdint.h>

/* Articulatory parameters, mm relative to rest (Leone, "LUCIA-WebGL", appendix 4.1.2). */
enum speech_param {
    PARAM_LI, /* lower lip, positive = lowered */
    PARAM_LS, /* upper lip, positive = raised */
    PARAM_AR, /* distance of the mouth corners, positive = spread */
    PARAM_PI, /* protrusion of the lower lip, positive = forward */
    PARAM_PS, /* protrusion of the upper lip, positive = forward */
    PARAM_EM, /* jaw, positive = lowered */
    /* The tongue, which the source announces as its next step. */
    PARAM_TH, /* height of the tip, positive = raised */
    PARAM_TA, /* advance of the tip, positive = forward */
    PARAM_TB, /* height of the body, positive = raised */
    PARAM_COUNT
};

extern const char *const speech_params[PARAM_COUNT + 1]; /* their names, NULL-terminated */

struct alphabet;

/* The twelve coefficients of one segment for one parameter (same source, table 3.1). */
struct coefficients {
    double t;                  /* place of the target in the segment, 0..1 */
    double T;                  /* target, mm */
    double alpha;              /* amplitude of the dominance, 0..1 */
    double k;                  /* resistance, 0..1 */
    double theta_bw, theta_fw; /* extent before and after the target */
    double c_bw, c_fw;         /* activation and release */
    double p_bw, p_fw;         /* exponents of the shape */
    double beta_bw, beta_fw;   /* slopes of the shape */
};

enum contact_kind { CONTACT_NONE, CONTACT_LIPS, CONTACT_TEETH };

/* A contact required during the phone, at any speech rate. */
struct contact_rule {
    enum contact_kind kind;
    double onset, release; /* s after the phone's start and before its end; see contact.h */
    double press;          /* LIPS: mm that the inner lips are pressed beyond touching */
    double reach;          /* TEETH: mm below its rest at which the lower lip meets the upper incisors */
    double retract;        /* TEETH: mm that it lies behind its rest */
};

struct speech_group {
    char *name;
    bool vowel;
    uint8_t viseme; /* of FAP 1, 0..14 */
    size_t context; /* vowel: the context it makes for consonants; consonant: for vowels */
    struct coefficients coefficients[PARAM_COUNT]; /* t and T unused */
};

struct speech_phone {
    char *ipa, *sampa;
    const struct speech_group *group; /* NULL for a phone made of parts */
    uint8_t viseme;
    struct contact_rule contact;
    /* [context * PARAM_COUNT + param], without and with primary stress; equal for consonants */
    struct coefficients *plain, *stressed;
    /* a diphthong or similar: a sequence of phones with their shares of the time */
    struct speech_part {
        const struct speech_phone *phone;
        double share;
    } * parts;
    size_t part_count;
    size_t feature_letter; /* 1 + index in the alphabet for a single letter of it, else 0 */
};

/* Distances on the modelled speaker's neutral face, mm (ISO/IEC 14496-2, annex C: face animation parameter
 * units). */
struct speech_fapu {
    double irisd, es, ens, mns, mw;
};

/* How the mouth rests in pauses. */
struct speech_rest {
    double reach, leave; /* s after a pause's start and before its end at which the mouth is at rest */
    double partial;      /* s: time constant of how far a short pause gets to rest */
    struct coefficients coefficients[PARAM_COUNT];
};

struct context_table;
struct spelling;

enum { VOWEL_CONTEXT_PAUSE = 0, SPEECH_MAX_CONTEXTS = 16 };

struct speech_pack {
    struct speech_pack *base; /* the inherited pack, to which this one holds a reference; NULL for none */
    unsigned references;
    struct alphabet *alphabet;
    char *lang, *name;
    char **voices, **abbreviations;
    struct speech_fapu fapu;
    struct speech_rest rest;
    double undershoot[PARAM_COUNT]; /* s, see targets.h; 0 = none */
    double trough;                  /* contact.h: 0..1, negative = consonants have their own targets */
    char **vowel_contexts;          /* kinds of phones after a vowel; the first is a pause */
    char **consonant_contexts;      /* kinds of vowels beside a consonant */
    size_t vowel_context_count, consonant_context_count;
    struct speech_group *groups;
    size_t group_count;
    struct speech_phone **phones; /* sorted by ipa */
    size_t phone_count;
    struct context_table *visemes; /* context_table.h; owned; NULL = none */
    struct spelling *letters;      /* spelling.h; likewise */
    size_t longest;                /* bytes of the longest ipa or sampa key, including the base's */
};

/* Finds the phone with exactly that IPA key, else that SAMPA key, in the pack or its base. */
const struct speech_phone *speech_pack_phone(const struct speech_pack *pack, const char *key, size_t bytes);

static inline bool speech_phone_is_vowel(const struct speech_phone *phone) {
    return phone->group->vowel;
}

#endif
