/* SPDX-License-Identifier: GPL-3.0-or-later */
/* EmotionML 1.0, alone or inside SSML. */
#ifndef FACCIA_MARKUP_EMOTIONML_H
#define FACCIA_MARKUP_EMOTIONML_H

#include "server/markup/markup_reader.h"

void emotionml_begin_emotion(struct markup_reader *r, struct tag *tag);
void emotionml_end_emotion(struct markup_reader *r, struct frame *frame);
void emotionml_begin_category(struct markup_reader *r, struct tag *tag);
void emotionml_begin_dimension(struct markup_reader *r, struct tag *tag);
void emotionml_begin_unused(struct markup_reader *r, struct tag *tag);

/* Rows for the element table of a vocabulary. */
#define EMOTIONML_EMOTION                                                                                    \
    {                                                                                                        \
        .name = "emotion", .begin = emotionml_begin_emotion, .end = emotionml_end_emotion,                   \
        .ignored = " start end time-ref-uri time-ref-anchor-point expressed-through ",                       \
        .quiet = " category-set dimension-set appraisal-set action-tendency-set "                            \
    }
#define EMOTIONML_CATEGORY                                                                                   \
    { .name = "category", .begin = emotionml_begin_category, .ignored = " confidence " }
#define EMOTIONML_DIMENSION                                                                                  \
    { .name = "dimension", .begin = emotionml_begin_dimension, .ignored = " confidence " }
#define EMOTIONML_UNUSED(NAME)                                                                               \
    {                                                                                                        \
        .name = NAME, .flags = ELEMENT_SILENT, .begin = emotionml_begin_unused,                              \
        .quiet = " name value confidence freq samples "                                                      \
    }
#define EMOTIONML_ABOUT(NAME)                                                                                \
    { .name = NAME, .flags = ELEMENT_SILENT, .quiet = " uri role media-type type name " }

#endif
