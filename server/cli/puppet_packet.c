/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/cli/puppet_packet.h"
#include "server/cli/puppet_text.h"
#include <ctype.h>
#include <math.h>
#include <string.h>
#include <strings.h>

enum { DEPTH_MAX = 4, BUNDLE_HEADER = 16 };
/* Live Link Face: version, number of values, and the places of the head's turns among them. */
enum { LINK_VERSION = 6, LINK_VALUES = 61, LINK_YAW = 52, LINK_PITCH, LINK_ROLL, LINK_TIME = 16 };

struct receiver {
    struct puppet_face *face;
    puppet_take *take;
    void *ctx;
};

static uint32_t get32(const uint8_t *at) {
    return (uint32_t)at[0] << 24 | (uint32_t)at[1] << 16 | (uint32_t)at[2] << 8 | at[3];
}

static double get_float(const uint8_t *at) {
    uint32_t bits = get32(at);
    float value;
    memcpy(&value, &bits, sizeof value);
    return (double)value;
}

/* ---- the Virtual Motion Capture protocol ---- */

/* Returns the text at *at, and moves *at behind its padding to four bytes; NULL: it does not end. */
static const char *text_at(const uint8_t *data, size_t size, size_t *at) {
    const char *text = (const char *)data + *at;
    const void *end = *at < size ? memchr(text, '\0', size - *at) : NULL;
    if (!end)
        return NULL;
    size_t length = (size_t)((const char *)end - text);
    *at += (length / 4 + 1) * 4;
    return *at <= size ? text : NULL;
}

static struct puppet_bone product(struct puppet_bone a, struct puppet_bone b) {
    return (struct puppet_bone){.w = a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z,
                                .x = a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y,
                                .y = a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x,
                                .z = a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w};
}

/* Bones turn as Unity's, left-handed with y up and z forwards: about y, then x, then z. */
static void set_head(struct puppet_face *f) {
    static const struct puppet_bone rest = {.w = 1};
    const struct puppet_bone q = product(f->neck.known ? f->neck : rest, f->skull.known ? f->skull : rest);
    f->head.head_yaw = -atan2(2 * (q.w * q.y + q.x * q.z), 1 - 2 * (q.x * q.x + q.y * q.y));
    f->head.head_pitch = asin(fmax(-1, fmin(1, 2 * (q.w * q.x - q.y * q.z))));
    f->head.head_roll = -atan2(2 * (q.w * q.z + q.x * q.y), 1 - 2 * (q.x * q.x + q.z * q.z));
    f->turned = true;
}

static void take_bone(struct puppet_face *f, const char *name, const uint8_t *values) {
    struct puppet_bone *bone = !strcmp(name, "Head") ? &f->skull : !strcmp(name, "Neck") ? &f->neck : NULL;
    double q[4], length = 0;
    for (int i = 0; i < 4; i++) {
        q[i] = get_float(values + 4 * (3 + i)); /* behind the position */
        length += q[i] * q[i];
    }
    length = sqrt(length);
    if (!bone || !(length > 0.5 && length < 2)) /* of a rotation it is 1 */
        return;
    *bone = (struct puppet_bone){q[0] / length, q[1] / length, q[2] / length, q[3] / length, true};
    set_head(f);
}

static void take_weight(struct puppet_face *f, const char *name, double weight) {
    for (int i = 0; i < ARKIT_SHAPES; i++)
        if (!strcasecmp(name, arkit_table[i].name) && isfinite(weight)) {
            f->weights[i] = weight;
            f->pending = true;
        }
}

static void take_message(const uint8_t *data, size_t size, const struct receiver *r) {
    enum { BONE = 7 * 4 };
    size_t at = 0;
    const char *address = text_at(data, size, &at), *types = address ? text_at(data, size, &at) : NULL;
    if (!types)
        return;
    if (!strcmp(address, "/VMC/Ext/Blend/Apply") && r->face->pending) {
        r->face->pending = false;
        r->face->time = -1;
        r->take(r->ctx, r->face);
        return;
    }
    bool weight = !strcmp(address, "/VMC/Ext/Blend/Val") && !strcmp(types, ",sf");
    bool bone = !strcmp(address, "/VMC/Ext/Bone/Pos") && !strcmp(types, ",sfffffff");
    const char *name = weight || bone ? text_at(data, size, &at) : NULL;
    if (name && weight && size - at >= 4)
        take_weight(r->face, name, get_float(data + at));
    if (name && bone && size - at >= BONE)
        take_bone(r->face, name, data + at);
}

static void take_osc(const uint8_t *data, size_t size, int depth, const struct receiver *r) {
    if (size < BUNDLE_HEADER || memcmp(data, "#bundle", 8)) {
        take_message(data, size, r);
        return;
    }
    for (size_t at = BUNDLE_HEADER, length; size - at >= 4 && depth < DEPTH_MAX; at += length) {
        length = get32(data + at);
        at += 4;
        if (length > size - at)
            return;
        take_osc(data + at, length, depth + 1, r);
    }
}

/* ---- Live Link Face: the version, the device and the subject as texts with their lengths, frame number and
 * its fraction, the rate as a fraction, the number of values, and the values, all big-endian. Without a face
 * the packet ends behind the subject ---- */

static bool skip_text(const uint8_t *data, size_t size, size_t *at) {
    if (size - *at < 4)
        return false;
    size_t length = get32(data + *at);
    *at += 4;
    if (length > size - *at)
        return false;
    *at += length;
    return true;
}

/* Returns the shape of a value: those of the packet are in Unreal's order, those of the table in the order of
 * the app's files, where left and right of the jaw and of the mouth change places. */
static int shape_of(int value) {
    static const struct {
        int value, shape;
    } swapped[] = {
        {15, ARKIT_JAW_LEFT}, {16, ARKIT_JAW_RIGHT}, {21, ARKIT_MOUTH_LEFT}, {22, ARKIT_MOUTH_RIGHT}};
    for (size_t i = 0; i < sizeof swapped / sizeof *swapped; i++)
        if (swapped[i].value == value)
            return swapped[i].shape;
    return value;
}

static double time_of(const uint8_t *at) {
    double frame = (double)(int32_t)get32(at) + get_float(at + 4);
    double rate = (double)(int32_t)get32(at + 8) / (double)(int32_t)get32(at + 12);
    return isfinite(rate) && rate >= 1 && isfinite(frame) && frame >= 0 ? frame / rate : -1;
}

static void take_link(const uint8_t *data, size_t size, const struct receiver *r) {
    size_t at = 1;
    double values[LINK_VALUES];
    if (!skip_text(data, size, &at) || !skip_text(data, size, &at) ||
        size - at < LINK_TIME + 1 + 4 * LINK_VALUES || data[at + LINK_TIME] != LINK_VALUES)
        return;
    for (int i = 0; i < LINK_VALUES; i++) {
        values[i] = get_float(data + at + LINK_TIME + 1 + 4 * (size_t)i);
        if (!isfinite(values[i]))
            return;
    }
    for (int i = 0; i < ARKIT_SHAPES; i++)
        r->face->weights[shape_of(i)] = values[i];
    /* in radians to the left, up, and to the left shoulder */
    r->face->head = (struct arkit_turns){
        .head_yaw = values[LINK_YAW], .head_pitch = -values[LINK_PITCH], .head_roll = -values[LINK_ROLL]};
    r->face->turned = true;
    r->face->time = time_of(data + at);
    r->take(r->ctx, r->face);
}

void puppet_packet(struct puppet_face *face, const uint8_t *data, size_t size, puppet_take *take, void *ctx) {
    const struct receiver r = {face, take, ctx};
    if (size && *data == LINK_VERSION) {
        take_link(data, size, &r);
    } else if (size && (isalpha(*data) || *data == '=')) {
        if (puppet_text(face, (const char *)data, size)) {
            face->time = -1;
            take(ctx, face);
        }
    } else {
        take_osc(data, size, 0, &r);
    }
}
