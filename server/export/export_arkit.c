/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Curves for other engines: ARKit's 52 shapes in the columns of Live Link Face, and as members of NDJSON
 * frames; visemes as the same. */
#include "server/codec/arkit_weights.h"
#include "server/export/export.h"
#include <ctype.h>
#include <math.h>
#include <stdio.h>

/* A weight of less is none: a hundredth of a millimetre. */
#define WEIGHT_LEAST 0.00005

/* Live Link Face has turns as parts of half a turn: -180 to 180 degrees are -1 to 1. */
#define HALF_TURN 3.14159265358979323846

enum { TURNS = 9, WHOLE = 63 /* FAP 1: all of its first viseme */ };

const char *const export_viseme_names[] = {"sil", "PP", "FF", "TH", "DD", "kk", "CH", "SS",
                                           "nn",  "RR", "aa", "E",  "I",  "O",  "U"};
enum { VISEMES = sizeof export_viseme_names / sizeof *export_viseme_names };

static struct arkit_solver *solver_of(struct export *x) {
    if (!x->coder)
        x->coder = arkit_solver_new();
    return x->coder;
}

void export_arkit_free(struct export *x) {
    arkit_solver_free(x->coder);
    x->coder = NULL;
}

static void put_header(struct export *x) {
    static const char *const turns[TURNS] = {"HeadYaw",     "HeadPitch",     "HeadRoll",
                                             "LeftEyeYaw",  "LeftEyePitch",  "LeftEyeRoll",
                                             "RightEyeYaw", "RightEyePitch", "RightEyeRoll"};
    buf_printf(&x->out, "Timecode,BlendShapeCount");
    for (int i = 0; i < ARKIT_SHAPES; i++)
        buf_printf(&x->out, ",%c%s", toupper(arkit_table[i].name[0]), arkit_table[i].name + 1);
    for (int i = 0; i < TURNS; i++)
        buf_printf(&x->out, ",%s", turns[i]);
    buf_printf(&x->out, "\r\n");
}

/* Hours, minutes, seconds, the frame within its second, and thousandths of a frame. */
static void put_time(struct export *x, uint32_t k) {
    double second = floor(k / x->fps + 1e-9), at = fmax(0, k - second * x->fps);
    unsigned whole = (unsigned)second, thousandths = (unsigned)lround(at * 1000);
    buf_printf(&x->out, "%02u:%02u:%02u:%02u.%03u", whole / 3600, whole / 60 % 60, whole % 60,
               thousandths / 1000, thousandths % 1000);
}

/* Live Link Face counts a turn to the left, up, and to the left shoulder as positive. */
static void put_turns(struct export *x, const struct fap_frame *frame) {
    struct arkit_turns t = arkit_turns_of(frame);
    const double turns[TURNS] = {t.head_yaw,   -t.head_pitch,   -t.head_roll,
                                 t.eye_yaw[0], -t.eye_pitch[0], 0,
                                 t.eye_yaw[1], -t.eye_pitch[1], 0};
    for (int i = 0; i < TURNS; i++)
        buf_printf(&x->out, ",%.6f", turns[i] / HALF_TURN + 0.0);
}

static void put_row(struct export *x, const struct fap_frame *frame, uint32_t k) {
    double weights[ARKIT_SHAPES];
    arkit_weights(solver_of(x), frame, weights);
    put_time(x, k);
    buf_printf(&x->out, ",%d", ARKIT_SHAPES + TURNS);
    for (int i = 0; i < ARKIT_SHAPES; i++)
        buf_printf(&x->out, ",%.6f", weights[i]);
    put_turns(x, frame);
    buf_printf(&x->out, "\r\n");
}

void export_arkit_piece(struct export *x, const struct media_segment *segment, uint32_t to) {
    uint32_t end = export_frames_until(x, segment, to);
    if (!x->segments && !x->at)
        put_header(x);
    for (; x->frames < end; x->frames++) {
        struct fap_frame frame;
        export_frame(x, segment, x->frames, &frame);
        put_row(x, &frame, x->frames);
    }
}

void export_arkit_end(struct export *x) {
    (void)x;
}

static void put_weight(struct export *x, const char **comma, const char *name, double weight) {
    char text[64];
    if (weight < WEIGHT_LEAST)
        return;
    buf_add(&x->out, text, (size_t)snprintf(text, sizeof text, "%s\"%s\":%.5g", *comma, name, weight));
    *comma = ",";
}

void export_arkit_weights(struct export *x, const struct fap_frame *frame) {
    struct arkit_turns t = arkit_turns_of(frame);
    const char *comma = "";
    double weights[ARKIT_SHAPES];
    arkit_weights(solver_of(x), frame, weights);
    buf_printf(&x->out, ",\"arkit\":{");
    for (int i = 0; i < ARKIT_SHAPES; i++)
        put_weight(x, &comma, arkit_table[i].name, weights[i]);
    buf_printf(&x->out, "},\"head\":[%.5g,%.5g,%.5g]", t.head_yaw, t.head_pitch, t.head_roll);
}

void export_viseme_weights(struct export *x, const struct fap_frame *frame) {
    double weights[VISEMES] = {0};
    const struct fap_viseme *v = &frame->viseme;
    const char *comma = "";
    if (fap_frame_has(frame, 1)) {
        weights[v->select1 < VISEMES ? v->select1 : 0] += fmin(v->blend, WHOLE) / WHOLE;
        weights[v->select2 < VISEMES ? v->select2 : 0] += 1 - fmin(v->blend, WHOLE) / WHOLE;
    } else {
        weights[0] = 1;
    }
    buf_printf(&x->out, ",\"visemes\":{");
    for (int i = 0; i < VISEMES; i++)
        put_weight(x, &comma, export_viseme_names[i], weights[i]);
    buf_printf(&x->out, "}");
}
