/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Loads a speech pack as the state of a test group. */
#ifndef FACCIA_TESTS_PACK_FIXTURE_H
#define FACCIA_TESTS_PACK_FIXTURE_H

#include "server/face/packs/speech_pack.h"
#include <stdio.h>

/* lang: "it" */
static inline int pack_load(void **state, const char *lang) {
    char path[512];
    struct error e = {0};
    snprintf(path, sizeof path, SOURCE_ROOT "/models/speech/%s.json", lang);
    *state = speech_pack_load(path, &e);
    return *state ? 0 : -1;
}

static inline int pack_unload(void **state) {
    speech_pack_free(*state);
    return 0;
}

#endif
