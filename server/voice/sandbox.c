/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/private_memory.h"
#include "server/voice/sandbox_internal.h"
#include <stdlib.h>
#include <sys/prctl.h>

/* libpulse, which espeak-ng brings along, looks for the desktop's sound server, and would complain of all
 * that it is refused meanwhile. */
static void keep_quiet(void) {
    setenv("PULSE_SERVER", "unix:/dev/null", 1);
    setenv("PULSE_CLIENTCONFIG", "/dev/null", 1);
}

/* The order matters: the identity in a new namespace is written to /proc/self, which is closed afterwards;
 * files are opened for the rules; the filter of calls refuses all of that. */
void sandbox_enter(const struct sandbox *s, struct sandbox_gaps *gaps) {
    const uint32_t capabilities = s->needs->capabilities;
    *gaps = (struct sandbox_gaps){0};
    keep_quiet();
    sandbox_spaces(capabilities, gaps->spaces, sizeof gaps->spaces);
    sandbox_drop_rights();
    private_memory();
    prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0);
    sandbox_files(s, gaps->files, sizeof gaps->files);
    sandbox_calls(capabilities, s->daemon, gaps->calls, sizeof gaps->calls);
}
