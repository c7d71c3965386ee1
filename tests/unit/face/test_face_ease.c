/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Easing of the face after cuts. */
#include "server/stream/stream_internal.h"
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

enum { JAW = 3, LID = 19, HEAD = 49, FRAMES = 25, NOW = 1000 };

static struct fap_frame face(int jaw, int lid, int head) {
    struct fap_frame f = {0};
    f.value[JAW] = jaw;
    f.value[LID] = lid;
    f.value[HEAD] = head;
    return f;
}

static void fill(struct fap_frame frames[FRAMES], struct fap_frame f) {
    for (int i = 0; i < FRAMES; i++)
        frames[i] = f;
}

/* Shows one face, cuts, and shows another for a second, in two pieces. */
static void change(enum ease_what what, uint64_t later, struct fap_frame out[FRAMES]) {
    struct face_ease ease = {0};
    struct fap_frame before = face(400, 900, -8000);
    face_ease_frames(&ease, EASE_FACE, NOW, FRAMES, &before, 1);
    fill(out, face(0, 0, 4000));
    face_ease_cut(&ease, NULL, NOW);
    face_ease_frames(&ease, what, NOW + later, FRAMES, out, 4);
    face_ease_frames(&ease, what, NOW + later + 160, FRAMES, out + 4, FRAMES - 4);
    assert_int_equal(ease.last.value[HEAD], 4000);
    assert_false(ease.active);
}

static int largest_step(const struct fap_frame *frames, int fap, int before) {
    int largest = 0;
    for (int i = 0; i < FRAMES; i++) {
        int step = abs(frames[i].value[fap] - (i ? frames[i - 1].value[fap] : before));
        largest = step > largest ? step : largest;
    }
    return largest;
}

static void head_goes_over_and_lips_are_right_at_once(void **state) {
    struct fap_frame out[FRAMES];
    (void)state;
    change(EASE_FACE, 0, out);
    assert_in_range(largest_step(out, HEAD, -8000), 1, 12000 * 0.18);
    for (int i = 0; i < FRAMES; i++) {
        assert_int_equal(out[i].value[JAW], 0);
        /* monotonic between the two faces */
        assert_in_range(out[i].value[HEAD] + 8000, i ? (unsigned)(out[i - 1].value[HEAD] + 8000) : 0, 12000);
        assert_in_range(out[i].value[LID], 0, 900);
        assert_true(i < EASE_UPPER * FRAMES || out[i].value[HEAD] == 4000);
    }
    assert_true(out[0].value[HEAD] > -8000); /* moving from the first frame on */
}

static void who_is_silent_closes_the_mouth_smoothly(void **state) {
    struct fap_frame out[FRAMES];
    (void)state;
    change(EASE_ALL, 0, out);
    assert_in_range(out[0].value[JAW], 200, 399);
    assert_int_equal(out[3].value[JAW], 0);
}

static void what_is_exact_stays_exact(void **state) {
    struct fap_frame out[FRAMES];
    (void)state;
    change(EASE_NOTHING, 0, out);
    assert_int_equal(largest_step(out, HEAD, 4000), 0);
}

static void what_comes_much_later_begins_where_it_begins(void **state) {
    struct fap_frame out[FRAMES];
    (void)state;
    change(EASE_FACE, EASE_SOON_MS, out);
    assert_int_equal(largest_step(out, HEAD, 4000), 0);
}

static void nothing_is_eased_that_is_not_cut(void **state) {
    struct face_ease ease = {0};
    struct fap_frame out[FRAMES];
    (void)state;
    for (int i = 0; i < 3; i++) {
        fill(out, face(i, i, 1000 * i));
        face_ease_frames(&ease, EASE_ALL, NOW, FRAMES, out, FRAMES);
        assert_int_equal(largest_step(out, HEAD, 1000 * i), 0);
    }
    /* nor is the very first frame eased, as there is none before it */
    ease = (struct face_ease){0};
    face_ease_cut(&ease, NULL, NOW);
    face_ease_frames(&ease, EASE_ALL, NOW, FRAMES, out, FRAMES);
    assert_int_equal(largest_step(out, HEAD, 2000), 0);
}

static void goes_on_from_a_face_that_is_given(void **state) {
    struct face_ease ease = {0};
    struct fap_frame out[FRAMES], given = face(0, 0, 3000);
    (void)state;
    fill(out, face(0, 0, 9000));
    face_ease_frames(&ease, EASE_FACE, NOW, FRAMES, out, FRAMES);
    fill(out, face(0, 0, 4000));
    face_ease_cut(&ease, &given, NOW);
    face_ease_frames(&ease, EASE_FACE, NOW, FRAMES, out, FRAMES);
    assert_in_range(out[0].value[HEAD], 3001, 3500);
}

static void comes_back_to_a_face(void **state) {
    struct fap_frame out[FRAMES], to = face(300, 100, -5000);
    (void)state;
    fill(out, face(0, 0, 7000));
    face_ease_towards(&to, out, 0, 0.4, 10);
    face_ease_towards(&to, out + 10, 0.4, 1, 15);
    assert_in_range(largest_step(out, HEAD, 7000), 1, 12000 * 0.07);
    assert_int_equal(out[FRAMES - 1].value[HEAD], -5000);
    assert_int_equal(out[FRAMES - 1].value[JAW], 300);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(head_goes_over_and_lips_are_right_at_once),
        cmocka_unit_test(who_is_silent_closes_the_mouth_smoothly),
        cmocka_unit_test(what_is_exact_stays_exact),
        cmocka_unit_test(what_comes_much_later_begins_where_it_begins),
        cmocka_unit_test(nothing_is_eased_that_is_not_cut),
        cmocka_unit_test(goes_on_from_a_face_that_is_given),
        cmocka_unit_test(comes_back_to_a_face),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
