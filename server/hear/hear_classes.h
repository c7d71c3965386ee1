/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What can be told apart by looking at a mouth; models/tools/hear/sounds.py says which phones are which. */
#ifndef FACCIA_HEAR_HEAR_CLASSES_H
#define FACCIA_HEAR_HEAR_CLASSES_H

enum hear_class {
    HEAR_SILENCE,
    HEAR_CLOSED, /* p b m */
    HEAR_TEETH,  /* f v */
    HEAR_ROUNDED,
    HEAR_DENTAL,
    HEAR_HISS,
    HEAR_TIP,
    HEAR_LIQUID,
    HEAR_BACK,
    HEAR_OPEN,
    HEAR_MIDDLE,
    HEAR_MIDDLE_ROUND,
    HEAR_CLOSE,
    HEAR_CLOSE_ROUND,
    HEAR_CLASSES
};

struct hear_class_name {
    const char *name;        /* "closed" */
    const char *ipa, *sampa; /* the phone that stands for all of them; "" and "_" of silence */
};

extern const struct hear_class_name hear_classes[HEAR_CLASSES];

#endif
