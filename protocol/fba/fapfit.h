/* SPDX-License-Identifier: MIT */
/* FAP interpolation tables: the FIT node of MPEG-4 (ISO/IEC 14496-1). A sender leaves out the FAPs that a
 * receiver can compute from others by such a table. Sets of FAPs are the nodes of a graph; each link gives
 * every FAP of its child set as a rational polynomial of the FAPs of its parent set. Reads and writes the
 * node as text, as it stands in scenes: `FIT { FAPs [...] ... }` (VRML, BIFS text) or `<FIT FAPs="..."/>`
 * (XMT-A). See protocol/mpeg4.md. */
#ifndef FACCIA_PROTOCOL_FAPFIT_H
#define FACCIA_PROTOCOL_FAPFIT_H

#include "protocol/fap.h"
#include <stddef.h>

enum {
    FAPFIT_SETS_MAX = FAP_COUNT,
    FAPFIT_LINKS_MAX = 512,
    FAPFIT_NUMBERS_MAX = 1 << 18, /* in all fields together */
    FAPFIT_EXPONENT_MAX = 15,
    FAPFIT_HIGH = 69, /* first index of a field of FAP 1 or 2: viseme_select1, viseme_select2, viseme_blend,
                         expression_select1, _intensity1, _select2, _intensity2 */
    FAPFIT_INDEX_MAX = 75,
};

/* The fields of the node. */
enum fapfit_field {
    FAPFIT_FAPS,  /* the sets, each closed by -1 */
    FAPFIT_GRAPH, /* pairs: parent set, child set, counted from 1 */
    FAPFIT_NUMERATOR_EXP,
    FAPFIT_DENOMINATOR_EXP,
    FAPFIT_NUMERATOR_IMPULSE, /* pairs for each term of a numerator: field of FAP 1 or 2, its value */
    FAPFIT_NUMERATOR_TERMS,   /* of each function, in the order of the links and of the child's FAPs */
    FAPFIT_DENOMINATOR_TERMS,
    FAPFIT_NUMERATOR_COEFS,
    FAPFIT_DENOMINATOR_COEFS,
    FAPFIT_FIELDS
};

/* As the node spells them. */
extern const char *const fapfit_names[FAPFIT_FIELDS];

struct fapfit_list {
    double *at;
    size_t count, cap;
};

struct fapfit_set {
    uint8_t index[FAPFIT_INDEX_MAX], count;
};

struct fapfit_link {
    uint8_t parent, child;                                       /* sets, from 0 */
    uint32_t terms, above, below, above_exp, below_exp, impulse; /* where its functions begin in the fields */
};

/* A table. Release with fapfit_free. */
struct fapfit {
    struct fapfit_list field[FAPFIT_FIELDS];
    struct fapfit_set set[FAPFIT_SETS_MAX];
    struct fapfit_link link[FAPFIT_LINKS_MAX];
    size_t sets, links;
};

struct fapfit_error {
    size_t line, column; /* 1-based, columns in bytes */
    const char *message; /* static */
};

/* Reads the first FIT node in text[0..size). Returns 0 (then call fapfit_free), or -1 with *error; a table is
 * 120 KB, so callers keep it on the heap. */
int fapfit_read(const char *text, size_t size, struct fapfit *out, struct fapfit_error *error);
void fapfit_free(struct fapfit *fit);

/* Appends a number to a field. -1: out of memory, or more than FAPFIT_NUMBERS_MAX. */
int fapfit_add(struct fapfit *fit, enum fapfit_field field, double number);
/* Checks the fields against each other and fills sets and links. -1 with a static message. */
int fapfit_settle(struct fapfit *fit, const char **message);

/* Gives a frame the FAPs that it lacks and the table has: set by set, each from the first of its parents
 * whose FAPs are all there, until nothing changes. Values are limited to the FAP's range. A FAP stays absent
 * where its denominator is 0. Returns how many were set. */
size_t fapfit_apply(const struct fapfit *fit, struct fap_frame *frame);

/* Gives frames those of the FAPs in `left` (as fap_frame's mask) that they lack, for streams that leave them
 * to the receiver without a table: an inner lip as the outer one and the reverse, one side as the other,
 * until nothing changes. */
void fapfit_supply(const uint8_t left[FAP_MASK_BYTES], struct fap_frame *frames, size_t count);

/* Finds what in an animation follows from other FAPs: each FAP that is a constant multiple of a FAP before it
 * (or 0) within half a step of fap_quant `quant`, in all frames that have it. Returns -1 when memory is
 * short; call fapfit_free in any case. The table has no sets if nothing follows. */
int fapfit_find(const struct fap_frame *frames, size_t count, int quant, struct fapfit *out);

/* Removes from all frames the FAPs that the table gives back within half a step of `quant`, and marks them in
 * `left` (as fap_frame's mask). Returns how many. */
size_t fapfit_leave(const struct fapfit *fit, struct fap_frame *frames, size_t count, int quant,
                    uint8_t left[FAP_MASK_BYTES]);

#endif
