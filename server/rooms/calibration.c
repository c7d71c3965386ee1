/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/mem.h"
#include "server/rooms/picture_size.h"
#include "server/rooms/rooms_internal.h"
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { FIELD_BYTES = 64 };

/* ISO/IEC 14496-2, annex C: number of feature points in each group. */
static const unsigned char in_group[] = {0, 0, 14, 14, 6, 4, 4, 1, 10, 15, 10, 6};

/* Parses 1 to 99, without a leading zero. Returns the rest of the text, or NULL. */
static const char *read_number(const char *text, unsigned *number) {
    const char *at = text;
    for (*number = 0; *at >= '0' && *at <= '9' && at - text < 2; at++)
        *number = *number * 10 + (unsigned)(*at - '0');
    return at > text && *text != '0' ? at : NULL;
}

static bool is_feature_point(const char *name) {
    unsigned group, point;
    const char *at = read_number(name, &group);
    if (!at || *at++ != '.' || !(at = read_number(at, &point)) || *at)
        return false;
    return group < sizeof in_group && point <= in_group[group];
}

static bool is_place(const json_t *value, size_t width, double least, double most) {
    if (!json_is_array(value) || json_array_size(value) != width)
        return false;
    for (size_t i = 0; i < width; i++) {
        const json_t *one = json_array_get(value, i);
        double number = json_number_value(one);
        if (!json_is_number(one) || !isfinite(number) || number < least || number > most)
            return false;
    }
    return true;
}

static int take_points(const json_t *message, json_t *into, struct error *e) {
    static const char member[] = "featurePointsCoord";
    json_t *points = json_object_get(message, member), *value;
    const char *name;
    char field[FIELD_BYTES];
    if (!json_is_object(points) || !json_object_size(points))
        return error_in_field(e, points ? ERROR_BAD_FIELD : ERROR_MISSING_FIELD, member,
                              "must be an object of feature points, at least one");
    json_object_foreach(points, name, value) {
        snprintf(field, sizeof field, "%s.%.32s", member, name);
        if (!is_feature_point(name))
            return error_in_field(e, ERROR_BAD_FIELD, field,
                                  "unknown feature point: 2.1 to 11.6, as numbered by ISO/IEC 14496-2");
        if (!is_place(value, 3, -CALIBRATION_FARTHEST, CALIBRATION_FARTHEST))
            return error_in_field(e, ERROR_BAD_FIELD, field, "must be three numbers of at most %d mm",
                                  CALIBRATION_FARTHEST);
    }
    json_object_set_new(into, member, json_deep_copy(points));
    return 0;
}

static int take_places(const json_t *message, json_t *into, struct error *e) {
    static const char member[] = "textureCoord";
    json_t *places = json_object_get(message, member), *value;
    const char *name;
    char field[FIELD_BYTES];
    if (!places)
        return 0;
    if (!json_is_object(places))
        return error_in_field(e, ERROR_BAD_FIELD, member, "must be an object of positions on the texture");
    json_object_foreach(places, name, value) {
        snprintf(field, sizeof field, "%s.%.32s", member, name);
        if (!is_feature_point(name))
            return error_in_field(e, ERROR_BAD_FIELD, field, "unknown feature point");
        if (!is_place(value, 2, 0, 1))
            return error_in_field(e, ERROR_BAD_FIELD, field, "must be two numbers from 0 to 1");
    }
    if (!json_object_get(message, "texture"))
        return error_in_field(e, ERROR_MISSING_FIELD, "texture",
                              "is missing: textureCoord gives positions on it");
    json_object_set_new(into, member, json_deep_copy(places));
    return 0;
}

static bool is_base64(const char *text, size_t length) {
    size_t digits = strspn(text, "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/");
    return length && length % 4 == 0 && digits + 2 >= length && strspn(text + digits, "=") == length - digits;
}

static uint8_t digit_of(char letter) {
    if (letter >= 'a')
        return (uint8_t)(letter - 'a' + 26);
    if (letter >= 'A')
        return (uint8_t)(letter - 'A');
    return letter == '+' ? 62 : letter == '/' ? 63 : (uint8_t)(letter - '0' + 52);
}

/* Decodes base64 that is_base64 has accepted. The caller frees the bytes. */
static uint8_t *decoded(const char *text, size_t length, size_t *size) {
    uint8_t *bytes = mem_alloc(length / 4 * 3);
    uint32_t bits = 0;
    *size = 0;
    for (size_t i = 0; i < length && text[i] != '='; i++) {
        bits = bits << 6 | digit_of(text[i]);
        if (i % 4)
            bytes[(*size)++] = (uint8_t)(bits >> (6 - 2 * (i % 4)));
    }
    return bytes;
}

/* Checks type and dimensions in the picture's header, because every listener's page would decode it. */
static int check_picture(const char *data, size_t length, const char *type, struct error *e) {
    struct picture_size is = {0};
    size_t size;
    uint8_t *bytes = decoded(data, length, &size);
    bool known = picture_size_read(bytes, size, &is);
    free(bytes);
    if (!known || strcmp(is.type, type) != 0)
        return error_in_field(e, ERROR_BAD_FIELD, "texture.data", "is not a picture of the type %s", type);
    if (!is.width || !is.height || is.width > CALIBRATION_TEXTURE_SIDE ||
        is.height > CALIBRATION_TEXTURE_SIDE || is.width * is.height > CALIBRATION_TEXTURE_POINTS)
        return error_in_field(e, ERROR_BAD_FIELD, "texture.data",
                              "has %u x %u pixels: the limit is %d in total, and %d in each direction",
                              is.width, is.height, CALIBRATION_TEXTURE_POINTS, CALIBRATION_TEXTURE_SIDE);
    return 0;
}

static int take_texture(const json_t *message, json_t *into, struct error *e) {
    static const char *const types[] = {"image/png", "image/jpeg", "image/webp"};
    const json_t *texture = json_object_get(message, "texture");
    const json_t *type = json_object_get(texture, "type"), *data = json_object_get(texture, "data");
    size_t i = 0;
    if (!texture)
        return 0;
    if (!json_is_object(texture))
        return error_in_field(e, ERROR_BAD_FIELD, "texture", "must be an object");
    while (i < 3 && (!json_is_string(type) || strcmp(types[i], json_string_value(type))))
        i++;
    if (i == 3)
        return error_in_field(e, ERROR_BAD_FIELD, "texture.type",
                              "must be image/png, image/jpeg or image/webp");
    if (!json_is_string(data) || json_string_length(data) > CALIBRATION_TEXTURE_BYTES ||
        !is_base64(json_string_value(data), json_string_length(data)))
        return error_in_field(e, ERROR_BAD_FIELD, "texture.data", "must be base64 of at most %d bytes",
                              CALIBRATION_TEXTURE_BYTES);
    if (check_picture(json_string_value(data), json_string_length(data), types[i], e))
        return -1;
    json_object_set_new(into, "texture",
                        json_pack("{ss ss}", "type", types[i], "data", json_string_value(data)));
    return 0;
}

int calibration_read(const json_t *message, json_t *into, struct error *e) {
    return take_points(message, into, e) || take_places(message, into, e) || take_texture(message, into, e)
               ? -1
               : 0;
}
