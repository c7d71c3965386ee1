/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The output of a recogniser, and the events of a server of the Wyoming protocol. Words must be fit to be
 * shown, and must not depend on how the output is divided. The first byte sets the size of the pieces. */
#include "server/base/json/wyoming_event.h"
#include "server/base/utf8.h"
#include "server/live/recognition.h"
#include "tests/fuzz/fuzz.h"
#include <stdlib.h>
#include <string.h>

static void check_words(void *ctx, const struct heard_words *words) {
    size_t size = strlen(words->text);
    (void)ctx;
    FUZZ_CHECK(size <= RECOGNITION_TEXT && utf8_check(words->text, size) == size);
    FUZZ_CHECK(!size || (words->text[0] != ' ' && words->text[size - 1] != ' '));
    for (size_t i = 0; i < size; i++)
        FUZZ_CHECK((unsigned char)words->text[i] >= ' ');
    FUZZ_CHECK(words->confidence <= 1);
}

/* Gives the output piece by piece. False: a line was too long. */
static bool read_lines(struct heard_lines *lines, const uint8_t *bytes, size_t size, size_t step) {
    for (size_t at = 0; at < size; at += step)
        if (!heard_lines_take(lines, (const char *)bytes + at, size - at < step ? size - at : step,
                              check_words, NULL))
            return false;
    return true;
}

static void read_events(const uint8_t *bytes, size_t size) {
    struct buf come = {0};
    struct wyoming_event event;
    const char *why = NULL;
    int found;
    buf_add(&come, bytes, size);
    while ((found = wyoming_event_next(&come, &event, &why)) > 0) {
        FUZZ_CHECK(event.type && json_is_object(event.data));
        wyoming_event_free(&event);
    }
    FUZZ_CHECK(!found == !why);
    buf_free(&come);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    struct fuzz_input in = fuzz_input(data, size);
    size_t step = 1 + fuzz_below(&in, 64), rest;
    uint8_t *bytes = fuzz_rest(&in, &rest);
    struct heard_lines whole = {0}, pieces = {0};
    bool good = read_lines(&whole, bytes, rest, rest + 1);
    FUZZ_CHECK(read_lines(&pieces, bytes, rest, step) == good);
    if (good) {
        const struct heard_words all = heard_lines_end(&whole), same = heard_lines_end(&pieces);
        check_words(NULL, &all);
        FUZZ_CHECK(all.final && !strcmp(all.text, same.text) && all.confidence == same.confidence);
    }
    heard_lines_free(&whole);
    heard_lines_free(&pieces);
    if (rest)
        read_events(bytes, rest);
    free(bytes);
    return 0;
}
