/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A process of its own that asks for more memory is out of it, alone. */
#ifndef FACCIA_VOICE_MEMORY_LIMIT_H
#define FACCIA_VOICE_MEMORY_LIMIT_H

#include <stdint.h>

/* For this process and what it starts; it leaves no core either. Not in builds with the address or thread
 * sanitizer, which map terabytes: there it only leaves no core. */
void memory_limit(uint32_t megabytes);

#endif
