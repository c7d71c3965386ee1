/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the table says of a voice, as the correction goes by it. */
#ifndef FACCIA_VOICE_BOUNDARY_TABLE_INTERNAL_H
#define FACCIA_VOICE_BOUNDARY_TABLE_INTERNAL_H

#include <stddef.h>

/* Where a phone that ends with one of the letters `before` is followed by one that begins with one of
 * `after`, the boundary is heard so many seconds later than the voice says. Letters are of the IPA, in UTF-8.
 */
struct boundary_rule {
    const char *before, *after;
    double seconds;
};

/* The first rule that fits counts. */
struct voice_boundaries {
    const char *voice;
    struct boundary_rule *rules;
    size_t count;
};

#endif
