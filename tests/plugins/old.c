/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Built for an interface that does not exist. */
#include "tests/plugins/stub.h"

static int stub_open(const char *config, void **self, char *message, size_t cap) {
    (void)config, (void)self, (void)message, (void)cap;
    return 0;
}

STUB_TABLE(FACCIA_VOICE_ABI + 100);
