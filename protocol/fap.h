/* SPDX-License-Identifier: MIT */
/* The 68 face animation parameters of MPEG-4 (ISO/IEC 14496-2, annex C) and one frame of their values.
 * FAPs are numbered 1..68 as in the standard; every array here is indexed by that number, entry 0 is unused.
 */
#ifndef FACCIA_PROTOCOL_FAP_H
#define FACCIA_PROTOCOL_FAP_H

#include <stdbool.h>
#include <stdint.h>

enum {
    FAP_COUNT = 68,     /* highest FAP number */
    FAP_MASK_BYTES = 9, /* 68 bits, FAP n = bit (n-1)%8 of byte (n-1)/8 */
};

/* Face animation parameter units. A value v of a FAP in a length unit means v * UNIT / 1024, where UNIT is
 * the distance measured on the neutral face; in AU it means v * 1e-5 rad. */
enum fap_unit {
    FAP_UNIT_NONE,
    FAP_UNIT_IRISD,
    FAP_UNIT_ES,
    FAP_UNIT_ENS,
    FAP_UNIT_MNS,
    FAP_UNIT_MW,
    FAP_UNIT_AU
};

struct fap_info {
    const char *name;      /* "open_jaw" */
    const char *direction; /* sense of a positive value: "down", "left" (of the subject), "forward"... */
    const char *fdp;       /* feature point that it moves: "2.1"; "" for FAP 1 and 2 */
    uint8_t group;         /* 1..10 */
    uint8_t unit;          /* enum fap_unit */
    bool bidirectional;    /* false: negative values have no meaning */
    uint16_t quant_step;   /* MPEG-4 quantiser step, in FAP units */
    int32_t min, max;      /* range in FAP units; 0,0 for FAP 1 and 2 */
    uint16_t i_steps;      /* half ranges of the intra and predicted coding, in quantiser steps */
    uint16_t p_steps;
};

/* Indexed by FAP number, 1..FAP_COUNT. */
extern const struct fap_info fap_table[FAP_COUNT + 1];

/* FAP 1: a blend of two of the 14 static visemes; select 0..14, blend 0..63 (63 = all of the first). */
struct fap_viseme {
    uint8_t select1, select2, blend, def;
};

/* FAP 2: two of the six expressions; select 0..6, intensity 0..63. */
struct fap_expression {
    uint8_t select1, intensity1, select2, intensity2, init_face, def;
};

/* One frame. value[n] is in FAP units and means something only where the mask has bit n. */
struct fap_frame {
    uint8_t mask[FAP_MASK_BYTES];
    struct fap_viseme viseme;
    struct fap_expression expression;
    int32_t value[FAP_COUNT + 1];
};

static inline bool fap_frame_has(const struct fap_frame *f, int n) {
    return (f->mask[(n - 1) / 8] >> ((n - 1) % 8)) & 1;
}

static inline void fap_frame_set(struct fap_frame *f, int n, int32_t value) {
    f->mask[(n - 1) / 8] |= (uint8_t)(1u << ((n - 1) % 8));
    f->value[n] = value;
}

/* The FAP of that name, 1..68, or 0. */
int fap_by_name(const char *name);

/* The value limited to the FAP's range (FAP 1 and 2: unchanged). */
int32_t fap_clamp(int n, int32_t value);

#endif
