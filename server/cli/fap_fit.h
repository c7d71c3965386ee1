/* SPDX-License-Identifier: GPL-3.0-or-later */
/* FAP interpolation tables for `faccia fap` (protocol/fba/fapfit.h). */
#ifndef FACCIA_CLI_FAP_FIT_H
#define FACCIA_CLI_FAP_FIT_H

#include "protocol/fapfile.h"

/* Applies the table of a file to an animation: removes the FAPs that it gives back within half a step of
 * `quant` and marks them in `left`; or else fills in those that are missing. -1 after a message. */
int fap_fit_use(const char *path, struct fapfile *face, bool remove, int quant, uint8_t left[FAP_MASK_BYTES]);

/* faccia fap fit. Returns an exit code. */
int fap_fit_main(int argc, char **argv);

#endif
