/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What faccia hear writes, while it hears. */
#ifndef FACCIA_APP_HEAR_WRITE_H
#define FACCIA_APP_HEAR_WRITE_H

#include "server/app/cli_file.h"
#include "server/hear/lip_features.h"
#include "server/hear/lip_recogniser.h"

struct lip_output {
    const char *path; /* NULL: not asked for */
    struct cli_file file;
};

/* Begins with the paths alone. */
struct hear_write {
    struct lip_output fap, json, lines;
    FILE *frames; /* those of the .fap, whose first line tells how many there are */
    uint32_t frame_count;
    double fps;
    size_t phones;
};

/* Where no path is there the lines go to standard output. All: -1 after a message. */
int hear_write_begin(struct hear_write *write, const char *lang, double fps, int lookahead);
int hear_write_flush(struct hear_write *write);
int hear_write_end(struct hear_write *write);
int hear_write_close(struct hear_write *write, bool well);

/* Of a hearing; ctx is the hear_write. */
void hear_write_frame(void *ctx, uint32_t k, const struct fap_frame *frame);
void hear_write_phone(void *ctx, const struct lip_phone *phone);

#endif
