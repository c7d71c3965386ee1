/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/doors/wyoming/wyoming_info.h"

json_t *wyoming_info(const json_t *known) {
    json_t *voices = json_array(), *one;
    size_t i;
    json_array_foreach(known, i, one) {
        const json_t *id = json_object_get(one, "id");
        json_array_append_new(voices, json_pack("{sO sO ss sb s{ss ss} s[O]}", "name", id, "description",
                                                json_object_get(one, "name"), "version", FACCIA_VERSION,
                                                "installed", 1, "attribution", "name",
                                                json_string_value(json_object_get(one, "plugin")), "url", "",
                                                "languages", json_object_get(one, "lang")));
    }
    return json_pack("{s[{ss ss sb ss s{ss ss} so sb}]}", "tts", "name", "faccia", "description",
                     "A face that speaks", "installed", 1, "version", FACCIA_VERSION, "attribution", "name",
                     "faccia", "url", "", "voices", voices, "supports_synthesize_streaming", 1);
}
