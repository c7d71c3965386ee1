/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/stream/face_ease.h"
#include <math.h>

static bool is_mouth(int n) {
    return (n >= 3 && n <= 18) || (n >= 43 && n <= 47) || (n >= 51 && n <= 60);
}

static double smooth(double x) {
    return x >= 1 ? 1 : x * x * (3 - 2 * x);
}

/* Between two faces that are possible (lids and lips that do not pass through each other) lies a possible
 * one.
 */
static void mix(struct fap_frame *frame, const struct fap_frame *from, double mouth, double upper) {
    for (int n = 3; n <= FAP_COUNT; n++) {
        double w = is_mouth(n) ? mouth : upper;
        if (w < 1 && frame->value[n] != from->value[n])
            frame->value[n] = (int32_t)lround(from->value[n] + w * (frame->value[n] - from->value[n]));
    }
}

void face_ease_cut(struct face_ease *ease, const struct fap_frame *from, uint64_t now) {
    ease->until = now + EASE_SOON_MS;
    ease->from_is_set = from != NULL;
    if (from)
        ease->from = *from;
}

static void begin(struct face_ease *ease, uint64_t now) {
    if (!ease->until)
        return;
    ease->active = ease->shown && now < ease->until;
    ease->age = 0;
    ease->until = 0;
    if (!ease->from_is_set)
        ease->from = ease->last;
}

void face_ease_frames(struct face_ease *ease, enum ease_what what, uint64_t now, double fps,
                      struct fap_frame *frames, size_t count) {
    if (!count)
        return;
    begin(ease, now);
    ease->active = ease->active && what != EASE_NOTHING;
    for (size_t i = 0; i < count && ease->active; i++) {
        ease->age += 1 / fps;
        mix(&frames[i], &ease->from, what == EASE_ALL ? smooth(ease->age / EASE_MOUTH) : 1,
            smooth(ease->age / EASE_UPPER));
        ease->active = ease->age < EASE_UPPER;
    }
    ease->last = frames[count - 1];
    ease->shown = true;
}

void face_ease_towards(const struct fap_frame *to, struct fap_frame *frames, double from, double end,
                       size_t count) {
    for (size_t i = 0; i < count; i++) {
        double left = 1 - smooth(from + (end - from) * (double)(i + 1) / (double)count);
        mix(&frames[i], to, left, left);
    }
}
