/* SPDX-License-Identifier: GPL-3.0-or-later */
/* AAC-LC in ADTS frames (ISO/IEC 14496-3, 1.A.2) from mono 16-bit sound, by vo-aacenc. */
#ifndef FACCIA_EXPORT_AAC_CODER_H
#define FACCIA_EXPORT_AAC_CODER_H

#include "server/base/buf.h"
#include <stddef.h>
#include <stdint.h>

struct aac_coder;

/* rate: one of MPEG-4's, 8000 to 48000. Frames are appended to `out`. NULL if the library refuses. */
struct aac_coder *aac_coder_new(uint32_t rate, struct buf *out);
void aac_coder_put(struct aac_coder *coder, const int16_t *pcm, size_t count);
/* Writes what is left, with silence to the end of the last frame. */
void aac_coder_end(struct aac_coder *coder);
void aac_coder_free(struct aac_coder *coder); /* NULL is ignored */

#endif
