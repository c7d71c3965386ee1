/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sound decoded in a separate process: the same samples as in this process, and any failure of the process is
 * reported with its reason. */
#include "server/voice/sound_reader.h"
#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <setjmp.h>
#include <sndfile.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmocka.h>

enum { SAMPLES = 200000, RATE = 16000 };

static const struct reader apart = {.program = BUILD_ROOT "/server/daemon/faccia-reader"};
static char folder[] = "/tmp/faccia-sound-XXXXXX";
static char path[64], program[64], noise[64];

static int write_sounds(void **state) {
    (void)state;
    SF_INFO info = {.samplerate = RATE, .channels = 2, .format = SF_FORMAT_FLAC | SF_FORMAT_PCM_16};
    static short frames[SAMPLES * 2];
    for (int i = 0; i < SAMPLES; i++) {
        frames[2 * i] = (short)(8000 * sin(i / 10.0));
        frames[2 * i + 1] = (short)(i % 100);
    }
    assert_non_null(mkdtemp(folder));
    snprintf(path, sizeof path, "%s/sound.flac", folder);
    snprintf(program, sizeof program, "%s/reader", folder);
    snprintf(noise, sizeof noise, "%s/noise", folder);
    FILE *other = fopen(noise, "w");
    fputs("this is no sound", other);
    fclose(other);
    SNDFILE *file = sf_open(path, SFM_WRITE, &info);
    sf_writef_short(file, frames, SAMPLES);
    return sf_close(file);
}

static int remove_sounds(void **state) {
    (void)state;
    unlink(path);
    unlink(program);
    unlink(noise);
    return rmdir(folder);
}

static struct sound_reader *open_sound(const struct reader *reader, const char *name, char *message) {
    return sound_reader_open(reader, open(name, O_RDONLY), name, 8, NULL, message);
}

static void reads_the_same(void **state) {
    (void)state;
    static float here[SAMPLES + 10], there[SAMPLES + 10];
    char message[SOUND_MESSAGE_BYTES];
    struct sound_reader *a = open_sound(NULL, path, message), *b = open_sound(&apart, path, message);
    assert_non_null(a);
    assert_non_null(b);
    assert_int_equal(sound_reader_rate(a), RATE);
    assert_int_equal(sound_reader_rate(b), RATE);
    assert_int_equal(sound_reader_read(a, here, SAMPLES + 10), SAMPLES);
    size_t done = 0;
    for (size_t want = 1, got = 1; got; want = want * 3 % 10007 + 1)
        done += got =
            sound_reader_read(b, there + done, want < SAMPLES + 10 - done ? want : SAMPLES + 10 - done);
    assert_int_equal(done, SAMPLES);
    assert_memory_equal(here, there, SAMPLES * sizeof *here);
    assert_null(sound_reader_wrong(a));
    assert_null(sound_reader_wrong(b));
    sound_reader_close(a);
    sound_reader_close(b);
}

static void says_what_is_wrong(void **state) {
    (void)state;
    char here[SOUND_MESSAGE_BYTES] = "", there[SOUND_MESSAGE_BYTES] = "";
    assert_null(open_sound(NULL, noise, here));
    assert_null(open_sound(&apart, noise, there));
    assert_true(*here);
    assert_string_equal(here, there);
    assert_null(sound_reader_open(&apart, open(path, O_RDONLY), path, 1, NULL, there));
    assert_string_equal(there, "it may have 1 channels, not 2");
    const struct reader missing = {.program = "/nonexistent"};
    assert_null(open_sound(&missing, path, there));
    assert_non_null(strstr(there, "cannot be started"));
}

/* Closing it early leaves no child process. */
static void may_be_closed_early(void **state) {
    (void)state;
    char message[SOUND_MESSAGE_BYTES];
    float few[10];
    struct sound_reader *s = open_sound(&apart, path, message);
    assert_int_equal(sound_reader_read(s, few, 10), 10);
    sound_reader_close(s);
    sound_reader_close(NULL);
    assert_int_equal(waitpid(-1, NULL, WNOHANG), -1);
    assert_int_equal(errno, ECHILD);
    atomic_bool given_up = true;
    assert_null(sound_reader_open(&apart, open(path, O_RDONLY), path, 8, &given_up, message));
    assert_non_null(strstr(message, "no longer needed"));
}

static void write_program(const char *script) {
    FILE *file = fopen(program, "w");
    fprintf(file, "#!/bin/sh\n%s\n", script);
    fchmod(fileno(file), 0755);
    fclose(file);
}

/* A process that sends false data, or ends like one with an exploited codec. */
static void whatever_the_process_does(void **state) {
    (void)state;
    /* 16000 Hz, and 200 bytes of message */
#define HELLO "printf '\\200\\076\\000\\000'; head -c 200 /dev/zero; "
    static const struct {
        const char *script, *why;
        bool opens;
        size_t samples;
    } cases[] = {
        {"exit 0", "invalid data", false, 0},
        {"exit 3", "with status 3", false, 0},
        {"kill -SEGV $$", "by signal 11", false, 0},
        {"exec >&-; exec sleep 600", "went on", false, 0}, /* does not wait for its exit */
        {"kill -XCPU $$", "processor time", false, 0},
        {"head -c 204 /dev/zero | tr '\\0' x", "invalid data", false, 0},
        {"head -c 4 /dev/zero; head -c 200 /dev/zero | tr '\\0' x", "invalid data", false, 0},
        {"printf '\\377\\377\\377\\177'; head -c 200 /dev/zero", "invalid data", false, 0},
        {HELLO "exit 0", "invalid data", true, 0},
        {HELLO "printf '\\377\\377\\377\\377'; sleep 60", "invalid data", true, 0},
        {HELLO "printf '\\002\\000\\000\\000abcdabcd\\002\\000\\000\\000'; kill -SEGV $$", "by signal 11",
         true, 2},
        /* NaN and infinity */
        {HELLO "printf '\\002\\000\\000\\000\\377\\377\\377\\377\\000\\000\\200\\177\\000\\000\\000\\000'",
         NULL, true, 2},
    };
    const struct reader liar = {.program = program};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char message[SOUND_MESSAGE_BYTES] = "";
        float samples[100];
        write_program(cases[i].script);
        struct sound_reader *s = open_sound(&liar, path, message);
        assert_int_equal(s != NULL, cases[i].opens);
        if (!s) {
            if (!strstr(message, cases[i].why))
                fail_msg("%s: %s", cases[i].script, message);
            continue;
        }
        assert_int_equal(sound_reader_read(s, samples, 100), cases[i].samples);
        for (size_t k = 0; k < cases[i].samples; k++)
            assert_true(isfinite(samples[k]));
        const char *wrong = sound_reader_wrong(s);
        if (cases[i].why ? !wrong || !strstr(wrong, cases[i].why) : wrong != NULL)
            fail_msg("%s: %s", cases[i].script, wrong ? wrong : "nothing");
        sound_reader_close(s);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(reads_the_same),
        cmocka_unit_test(says_what_is_wrong),
        cmocka_unit_test(may_be_closed_early),
        cmocka_unit_test(whatever_the_process_does),
    };
    return cmocka_run_group_tests(tests, write_sounds, remove_sounds);
}
