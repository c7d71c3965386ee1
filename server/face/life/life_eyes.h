/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Figures of eyes, lids and head. Private to what makes the face live. */
#ifndef FACCIA_FACE_LIFE_LIFE_EYES_H
#define FACCIA_FACE_LIFE_LIFE_EYES_H

#define DEGREE 1745.33 /* in FAP angle units, 1e-5 rad */

/* Upper and lower lid meet after IRISD in all: 1024 FAP units. They follow the eye up and down, the upper one
 * nearly as far (on an eyeball of twice the iris's diameter, 1 degree is 1024 * pi / 180 units). */
#define LID_UPPER 940
#define LID_LOWER 84
#define LID_UPPER_FOLLOWS 15.0 /* FAP units per degree */
#define LID_LOWER_FOLLOWS 7.0

/* Durations of a blink, s: closing is about twice as fast as opening (C. Evinger et al., Invest. Ophthalmol.
 * Vis. Sci. 32, 1991). */
#define BLINK_CLOSING 0.085
#define BLINK_CLOSED 0.025
#define BLINK_OPENING 0.165

#endif
