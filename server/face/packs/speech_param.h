/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a mouth does, in numbers. */
#ifndef FACCIA_FACE_PACKS_SPEECH_PARAM_H
#define FACCIA_FACE_PACKS_SPEECH_PARAM_H

/* Articulatory parameters, mm relative to rest (Leone, "LUCIA-WebGL", appendix 4.1.2). */
enum speech_param {
    PARAM_LI, /* lower lip, positive = lowered */
    PARAM_LS, /* upper lip, positive = raised */
    PARAM_AR, /* distance of the mouth corners, positive = spread */
    PARAM_PI, /* protrusion of the lower lip, positive = forward */
    PARAM_PS, /* protrusion of the upper lip, positive = forward */
    PARAM_EM, /* jaw, positive = lowered */
    /* The tongue, which the same source names as its next step. */
    PARAM_TH, /* height of the tip, positive = raised */
    PARAM_TA, /* advance of the tip, positive = forward */
    PARAM_TB, /* height of the body, positive = raised */
    PARAM_COUNT
};

extern const char *const speech_params[PARAM_COUNT + 1]; /* their names, NULL-terminated */

#endif
