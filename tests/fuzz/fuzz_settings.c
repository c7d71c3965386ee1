/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The daemon's settings. Byte 0 selects: a file, edits of a file with the defaults (json_edit.c), or one
 * setting's number and text. Accepted settings are printed and read again. */
#include "server/base/utf8.h"
#include "server/daemon/settings_internal.h"
#include "tests/fuzz/fuzz.h"
#include <stdlib.h>
#include <string.h>

static void defaults(struct settings *s) {
    char *argv[] = {"facciad", NULL};
    struct paths paths = {.models = "/", .web = "/", .plugins = "/", .worker = "w", .commands = "c"};
    struct settings_request request;
    struct error e;
    FUZZ_CHECK(!settings_read(s, &request, PROGRAM_DAEMON, 1, argv, &paths, &e));
}

static const json_t *printed(void) {
    static json_t *json;
    if (!json) {
        struct settings s;
        struct buf out = {0};
        defaults(&s);
        settings_print(&s, &out);
        json = json_loadb((char *)out.data, out.size, 0, NULL);
        FUZZ_CHECK(json);
        buf_free(&out);
        settings_free(&s);
    }
    return json;
}

/* Printed settings read back unchanged. */
static void check_again(const struct settings *s) {
    struct settings again;
    struct buf out = {0}, more = {0};
    struct error e = {0};
    char path[FUZZ_PATH];
    settings_print(s, &out);
    fuzz_write("again.json", out.data, out.size, path);
    defaults(&again);
    FUZZ_CHECK(!settings_from_file(&again, PROGRAM_DAEMON, path, &e));
    settings_print(&again, &more);
    FUZZ_CHECK(out.size == more.size && !memcmp(out.data, more.data, out.size));
    FUZZ_CHECK(!settings_need_restart(s, &again));
    settings_free(&again);
    buf_free(&out);
    buf_free(&more);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    struct fuzz_input in = fuzz_input(data, size);
    struct settings s;
    struct error e = {0};
    char path[FUZZ_PATH];
    int failed = 0;
    defaults(&s);
    uint8_t kind = fuzz_u8(&in) % 3;
    if (kind == 2) {
        const struct setting *setting = &settings_table[fuzz_below(&in, settings_count)];
        char *text = fuzz_rest_text(&in);
        if (setting->type != SETTING_OBJECT &&
            utf8_check(text, strlen(text)) == strlen(text)) /* JSON is UTF-8 */
            failed = setting_from_text(&s, setting, text, "--x", &e);
        free(text);
    } else {
        if (kind == 1) {
            json_t *edited = fuzz_edit_json(printed(), &in);
            fuzz_write_json("settings.json", edited, path);
            json_decref(edited);
        } else {
            fuzz_write("settings.json", in.at, fuzz_left(&in), path);
        }
        failed = settings_from_file(&s, PROGRAM_DAEMON, path, &e);
    }
    FUZZ_CHECK(!failed || e.code);
    if (!failed)
        check_again(&s);
    settings_free(&s);
    return 0;
}
