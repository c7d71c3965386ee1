/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The messages that concern the living face: idle and express. */
#include "server/net/client_message.h"
#include "server/net/net_internal.h"
#include <stdio.h>
#include <string.h>

#define EASE_DEFAULT 0.3 /* s */

int live_idle(const json_t *message, const struct speech_request *defaults, uint64_t seed,
              struct idle_options *options, bool *on, struct error *e) {
    struct speech_request request;
    const json_t *wanted = json_object_get(message, "on");
    if (client_message_check("idle", message, e))
        return -1;
    request_copy(&request, defaults);
    int failed = client_message_request("idle", message, &request, e);
    *on = !wanted || json_is_true(wanted);
    *options = (struct idle_options){.life = request.life < 0 ? 1 : request.life,
                                     .seed = request.seed < 0 ? seed : (uint64_t)request.seed,
                                     .fps = request.fps,
                                     .still = request.still};
    request_free(&request);
    return failed ? -1 : 0;
}

static int take_part(const json_t *part, size_t i, struct mood_request *mix, struct error *e) {
    const json_t *intensity = json_object_get(part, "intensity");
    char field[32];
    mix->names[i] = json_string_value(json_object_get(part, "name"));
    mix->intensities[i] = intensity ? json_number_value(intensity) : 1;
    if (!mix->names[i]) {
        snprintf(field, sizeof field, "mix.%zu.name", i);
        return error_in_field(e, json_object_get(part, "name") ? ERROR_BAD_FIELD : ERROR_MISSING_FIELD, field,
                              "must be the name of an affect");
    }
    if ((intensity && !json_is_number(intensity)) || mix->intensities[i] < 0 || mix->intensities[i] > 1) {
        snprintf(field, sizeof field, "mix.%zu.intensity", i);
        return error_in_field(e, ERROR_BAD_FIELD, field, "must be a number from 0 to 1");
    }
    return 0;
}

int live_express(const json_t *message, struct mood_request *mix, struct error *e) {
    const json_t *parts = json_object_get(message, "mix"), *ease = json_object_get(message, "ease");
    *mix = (struct mood_request){.count = json_array_size(parts), .ease = EASE_DEFAULT};
    if (!json_is_array(parts) || mix->count > MOOD_MIX)
        return error_in_field(e, parts ? ERROR_BAD_FIELD : ERROR_MISSING_FIELD, "mix",
                              "must be a list of up to %d affects with their intensities", MOOD_MIX);
    if (client_message_check("express", message, e))
        return -1;
    if (ease)
        mix->ease = json_number_value(ease);
    for (size_t i = 0; i < mix->count; i++)
        if (take_part(json_array_get(parts, i), i, mix, e))
            return -1;
    return 0;
}
