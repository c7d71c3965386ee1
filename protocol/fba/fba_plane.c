/* SPDX-License-Identifier: MIT */
#include "protocol/fba/fba_plane.h"

const uint8_t fba_group_begin[FBA_GROUPS + 1] = {1, 3, 19, 31, 39, 43, 48, 51, 61, 65, 69};

void fba_ranges_init(struct fba_ranges *r) {
    *r = (struct fba_ranges){0};
    for (int n = 3; n <= FAP_COUNT; n++) {
        r->i_max[n] = r->i_min[n] = (uint8_t)((fap_table[n].i_steps + FBA_RANGE_STEP - 1) / FBA_RANGE_STEP);
        r->p_max[n] = r->p_min[n] = (uint8_t)((fap_table[n].p_steps + FBA_RANGE_STEP - 1) / FBA_RANGE_STEP);
    }
}

int fba_high_most(int part, int quant) {
    static const uint8_t most[FBA_HIGH] = {14, 14, 63, 6, 63, 6, 63};
    return most[part] == 63 && quant ? (63 + quant / 2) / quant : most[part];
}

void fba_plane_reset(struct fba_plane *p) {
    for (int part = 0; part < FBA_HIGH; part++) {
        int most = fba_high_most(part, p->quant);
        fba_model_reset(&p->high[part], -most, most);
    }
    for (int n = 3; n <= FAP_COUNT; n++)
        if (fba_plane_has(p, n))
            fba_model_reset(&p->values[n], -fba_levels(p->ranges.p_min[n], p->quant),
                            fba_levels(p->ranges.p_max[n], p->quant));
}

struct fba_model *fba_plane_model(struct fba_plane *p, int n, bool intra) {
    if (!intra)
        return &p->values[n];
    fba_model_reset(&p->even, -fba_levels(p->ranges.i_min[n], p->quant),
                    fba_levels(p->ranges.i_max[n], p->quant));
    return &p->even;
}
