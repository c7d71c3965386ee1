/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Cannot be opened, and says why. */
#include "tests/plugins/stub.h"
#include <stdio.h>

static int stub_open(const char *config, void **self, char *message, size_t cap) {
    (void)config, (void)self;
    snprintf(message, cap, "it has lost its voice");
    return -1;
}

STUB_TABLE(FACCIA_VOICE_ABI);
