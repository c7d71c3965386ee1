/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A head model, split by the daemon for the socket. Byte 0 selects: a file, or edits (json_edit.c) of the
 * small head in tests/fuzz/head.json. */
#include "server/api/api_internal.h"
#include "server/base/mem.h"
#include "tests/fuzz/fuzz.h"
#include <stdlib.h>
#include <string.h>

static const json_t *head(void) {
    static json_t *loaded;
    if (!loaded)
        loaded = fuzz_load_json("tests/fuzz/head.json");
    return loaded;
}

static void check_part(const struct model_part *part) {
    json_t *json = part->json ? json_loads(part->json, JSON_DECODE_ANY, NULL) : NULL;
    FUZZ_CHECK(part->kind && part->name && json);
    json_decref(json);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    struct fuzz_input in = fuzz_input(data, size);
    struct model model = {0};
    size_t length;
    uint8_t *text;
    struct error e = {0};
    if (fuzz_u8(&in) & 1) {
        json_t *edited = fuzz_edit_json(head(), &in);
        text = (uint8_t *)json_dumps(edited, JSON_COMPACT | JSON_ENCODE_ANY);
        length = strlen((char *)text);
        json_decref(edited);
    } else {
        text = fuzz_rest(&in, &length);
    }
    if (!model_split(&model, "tiny", text, length, "tiny.json", &e)) {
        FUZZ_CHECK(model.name && model.title && model.part_count && !strcmp(model.parts[0].kind, "head"));
        for (size_t i = 0; i < model.part_count; i++)
            check_part(&model.parts[i]);
    } else {
        FUZZ_CHECK(e.code);
    }
    model_free(&model);
    free(text);
    return 0;
}
