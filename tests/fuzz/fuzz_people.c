/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Recorded speakers as read by faccia fit and faccia eval --recording: the first line "---" separates the
 * curves from the phones. Data that can be read is compared with another speaker: itself, shifted in time. */
#include "server/research/fit_read.h"
#include "server/research/person.h"
#include "tests/fuzz/fuzz.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char divider[] = "\n---\n";

static const uint8_t *find_divider(const uint8_t *data, size_t size) {
    for (size_t i = 0; i + sizeof divider - 1 <= size; i++)
        if (!memcmp(data + i, divider, sizeof divider - 1))
            return data + i;
    return NULL;
}

static void check(const struct measured_speech *r) {
    for (size_t i = 0; i < r->phone_count; i++) {
        const struct recorded_phone *p = &r->phones[i];
        FUZZ_CHECK(memchr(p->ipa, 0, sizeof p->ipa) && p->end > p->start && p->start >= 0 && p->stress <= 2);
        FUZZ_CHECK(!i || p->start >= r->phones[i - 1].end - 1e-3);
    }
    for (size_t i = 0; i < r->frame_count; i++)
        FUZZ_CHECK(isfinite(r->times[i]) && (!i || r->times[i] > r->times[i - 1]));
}

static void use(struct measured_speech *r) {
    struct error e;
    struct person_warp warp;
    if (measured_speech_check(r, &e) || r->phone_count > 200 || r->frame_count > 500)
        return;
    person_warp_new(&warp, r, r);
    for (warp.measure = 0; warp.measure < PERSON_MEASURES; warp.measure++) {
        if (!person_has(r, warp.measure))
            continue;
        struct curve_match_shifted m = person_match(r, warp.measure, person_warp_at, &warp, 0);
        FUZZ_CHECK(m.as_is.count <= r->frame_count);
        FUZZ_CHECK(isnan(m.as_is.correlation) || fabs(m.as_is.correlation) <= 1 + 1e-6);
        FUZZ_CHECK(fabs(m.shift) <= CURVE_SHIFT_MOST + 1e-9);
    }
    person_warp_free(&warp);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    const uint8_t *end = find_divider(data, size);
    struct measured_speech person = {0};
    struct error e = {0};
    char curves[FUZZ_PATH], phones[FUZZ_PATH];
    if (!end)
        return 0;
    fuzz_write("curves.csv", data, (size_t)(end - data), curves);
    end += sizeof divider - 1;
    fuzz_write("phones", end, (size_t)(data + size - end), phones);
    int failed = fit_read_curves(curves, &person, &e);
    FUZZ_CHECK(!failed || e.code);
    if (!failed) {
        failed = phone_times_read(phones, &person, &e);
        FUZZ_CHECK(!failed || e.code);
    }
    if (!failed) {
        check(&person);
        use(&person);
    }
    measured_speech_free(&person);
    return 0;
}
