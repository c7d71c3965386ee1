/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/hear/hear_classes.h"

const struct hear_class_name hear_classes[HEAR_CLASSES] = {
    [HEAR_SILENCE] = {"silence", "", "_"}, [HEAR_CLOSED] = {"closed", "m", "m"},
    [HEAR_TEETH] = {"teeth", "f", "f"},    [HEAR_ROUNDED] = {"rounded", "ʃ", "S"},
    [HEAR_DENTAL] = {"dental", "θ", "T"},  [HEAR_HISS] = {"hiss", "s", "s"},
    [HEAR_TIP] = {"tip", "t", "t"},        [HEAR_LIQUID] = {"liquid", "l", "l"},
    [HEAR_BACK] = {"back", "k", "k"},      [HEAR_OPEN] = {"open", "a", "a"},
    [HEAR_MIDDLE] = {"middle", "ɛ", "E"},  [HEAR_MIDDLE_ROUND] = {"middle-round", "ɔ", "O"},
    [HEAR_CLOSE] = {"close", "i", "i"},    [HEAR_CLOSE_ROUND] = {"close-round", "u", "u"},
};
