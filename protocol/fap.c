/* SPDX-License-Identifier: MIT */
#include "protocol/fap.h"
#include <string.h>

int fap_by_name(const char *name) {
    for (int n = 1; n <= FAP_COUNT; n++)
        if (!strcmp(fap_table[n].name, name))
            return n;
    return 0;
}

int32_t fap_clamp(int n, int32_t value) {
    const struct fap_info *fap = &fap_table[n];
    if (n <= 2)
        return value;
    return value < fap->min ? fap->min : value > fap->max ? fap->max : value;
}
