/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/mem.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>

static void *checked(void *p, size_t size) {
    if (!p && size) {
        fprintf(stderr, "faccia: out of memory (allocating %zu bytes)\n", size);
        abort();
    }
    return p;
}

void *mem_alloc(size_t size) {
    return checked(calloc(1, size ? size : 1), size);
}

void *mem_resize(void *p, size_t size) {
    return checked(realloc(p, size ? size : 1), size);
}

char *mem_strndup(const char *s, size_t n) {
    n = strnlen(s, n);
    char *copy = mem_alloc(n + 1);
    memcpy(copy, s, n);
    return copy;
}

char *mem_strdup(const char *s) {
    return mem_strndup(s, strlen(s));
}

void *mem_grow(void *p, size_t *cap, size_t need, size_t element) {
    if (need <= *cap)
        return p;
    size_t wanted = *cap ? *cap * 2 : 8;
    if (wanted < need)
        wanted = need;
    *cap = wanted;
    return mem_resize(p, wanted * element);
}

#if defined __SANITIZE_ADDRESS__ || defined __SANITIZE_THREAD__
static void open_again(void) {
    prctl(PR_SET_DUMPABLE, 1, 0, 0, 0);
}
#endif

void private_memory(void) {
#if defined __SANITIZE_ADDRESS__ || defined __SANITIZE_THREAD__
    atexit(open_again);
#endif
    prctl(PR_SET_DUMPABLE, 0, 0, 0, 0);
}
