/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a plugin says that it needs, read from its file: none of its code runs, as it does when it is loaded.
 */
#ifndef FACCIA_VOICE_PLUGIN_NEEDS_H
#define FACCIA_VOICE_PLUGIN_NEEDS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct needs {
    uint32_t capabilities; /* FACCIA_VOICE_..., and for an old plugin what it could not say */
    char *reads;           /* FACCIA_VOICE_READS: paths, each with its NUL; */
    size_t reads_size;     /* and all of them */
};

/* False, and nothing is needed, when the file is no shared object with a constant table. */
bool needs_read(struct needs *needs, const char *path);
void needs_free(struct needs *needs);

/* What a table says, and what one of an older interface could not say. */
uint32_t needs_stated(uint32_t abi, uint32_t capabilities);

#endif
