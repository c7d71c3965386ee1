/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/app/library_place.h"
#include "server/base/mem.h"
#include <errno.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

/* Makes the folder, of which the one above is there or can be made. */
static bool make(const char *folder) {
    return !mkdir(folder, 0700) || errno == EEXIST;
}

char *library_index_place(const struct settings *s, struct error *e) {
    struct buf path = {0};
    char *real = realpath(s->library, NULL);
    uint64_t hash = 14695981039346656037u; /* FNV-1a: a library of another folder has another index */
    for (const char *c = real ? real : s->library; *c; c++)
        hash = (hash ^ (unsigned char)*c) * 1099511628211u;
    free(real);
    if (s->index)
        return mem_strdup(s->index);
    char *cache = settings_cache_folder();
    if (!cache) {
        error_in_field(e, ERROR_BAD_INDEX, "--library-index",
                       "there is no cache folder: say where it is to be");
        return NULL;
    }
    bool well = make(cache);
    buf_printf(&path, "%s/faccia", cache);
    buf_add(&path, "", 1);
    well = well && make((char *)path.data);
    path.size--;
    buf_printf(&path, "/library-%016llx.index", (unsigned long long)hash);
    buf_add(&path, "", 1);
    if (!well)
        error_in_field(e, ERROR_BAD_INDEX, "--library-index", "%.150s: %.80s", cache, strerror(errno));
    free(cache);
    if (!well)
        buf_free(&path);
    return (char *)path.data;
}
