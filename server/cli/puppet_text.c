/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/cli/puppet_text.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

enum { TOKEN_MAX = 256, TURNS = 3 };

/* Names end in _L and _R where ARKit's end in Left and Right; both are understood, in any case. */
static int shape_named(const char *name, size_t length) {
    char whole[TOKEN_MAX];
    const char *side = "";
    if (length > 2 && name[length - 2] == '_') {
        side = strchr("Ll", name[length - 1]) ? "Left" : strchr("Rr", name[length - 1]) ? "Right" : "";
        length -= *side ? 2 : 0;
    }
    snprintf(whole, sizeof whole, "%.*s%s", (int)length, name, side);
    for (int i = 0; i < ARKIT_SHAPES; i++)
        if (!strcasecmp(whole, arkit_table[i].name))
            return i;
    return -1;
}

/* Reads a number that ends at `end` or with the text. */
static bool read_number(const char **at, char end, double *out) {
    char *stop;
    *out = strtod(*at, &stop);
    if (stop == *at || !isfinite(*out) || (*stop && *stop != end))
        return false;
    *at = stop + (*stop != '\0');
    return true;
}

/* In degrees, down, to the head's left and towards its right shoulder: as ARKit's axes, seen from the face.
 */
static bool take_head(struct puppet_face *face, const char *at) {
    const double radian = acos(-1) / 180;
    double turns[TURNS];
    for (int i = 0; i < TURNS; i++)
        if (!read_number(&at, ',', &turns[i]) || fabs(turns[i]) > 360)
            return false;
    face->head = (struct arkit_turns){.head_pitch = remainder(turns[0], 360) * radian,
                                      .head_yaw = remainder(turns[1], 360) * radian,
                                      .head_roll = remainder(turns[2], 360) * radian};
    face->turned = true;
    return true;
}

/* Reads one piece between bars. */
static bool take_piece(struct puppet_face *face, const char *piece) {
    static const char head[] = "head#";
    piece += *piece == '=';
    if (!strncmp(piece, head, strlen(head)))
        return take_head(face, piece + strlen(head));
    size_t length = strcspn(piece, strchr(piece, '&') ? "&" : "-");
    int shape = piece[length] ? shape_named(piece, length) : -1;
    const char *at = piece + length + 1;
    double weight;
    if (shape < 0 || !read_number(&at, '\0', &weight))
        return false;
    face->weights[shape] = weight / 100;
    return true;
}

bool puppet_text(struct puppet_face *face, const char *text, size_t size) {
    char piece[TOKEN_MAX];
    bool told = false;
    for (size_t at = 0; at < size;) {
        const char *bar = memchr(text + at, '|', size - at);
        size_t length = bar ? (size_t)(bar - text) - at : size - at;
        if (length < sizeof piece) {
            memcpy(piece, text + at, length);
            piece[length] = '\0';
            told |= take_piece(face, piece);
        }
        at += length + 1;
    }
    return told;
}
