/* SPDX-License-Identifier: GPL-3.0-or-later */
/* VSML, the voice signal markup of Festival's Italian voices (vsml.dtd of ISTC-CNR Padova). */
#ifndef FACCIA_MARKUP_LANGUAGES_VOQUAL_H
#define FACCIA_MARKUP_LANGUAGES_VOQUAL_H

#include "server/markup/markup_reader.h"

/* Handles the element "voqual" with its attributes `type` and `level`: a quality of the voice over its
 * content. */
void voqual_begin(struct markup_reader *r, struct tag *tag);

/* Handles the element "signalctrl" with its attributes `type` and `level`: one property of the sound. */
void voqual_begin_signal(struct markup_reader *r, struct tag *tag);

#endif
