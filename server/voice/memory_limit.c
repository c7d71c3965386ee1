/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/voice/memory_limit.h"
#include <sys/resource.h>

void memory_limit(uint32_t megabytes) {
    const struct rlimit none = {0, 0};
    setrlimit(RLIMIT_CORE, &none);
#if !defined __SANITIZE_ADDRESS__ && !defined __SANITIZE_THREAD__
    const rlim_t bytes = (rlim_t)megabytes << 20;
    const struct rlimit space = {bytes, bytes};
    setrlimit(RLIMIT_AS, &space);
#else
    (void)megabytes;
#endif
}
