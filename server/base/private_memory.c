/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/private_memory.h"
#include <stdlib.h>
#include <sys/prctl.h>

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
