/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Processes that end with their parent. */
#include "server/base/program.h"
#include <fcntl.h>
#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmocka.h>

enum { WENT_ON = 7 };

static int status_of(pid_t child) {
    int status;
    assert_int_equal(waitpid(child, &status, 0), child);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
}

/* The exit status of a child that asks whether its parent holds the other end of its output. */
static int outcome(bool held) {
    int ends[2];
    assert_int_equal(pipe2(ends, O_CLOEXEC), 0);
    if (!held)
        close(ends[0]);
    pid_t child = fork();
    if (child == 0) {
        if (held)
            close(ends[0]);
        program_end_with_parent(ends[1], SIGKILL);
        _exit(WENT_ON);
    }
    int status = status_of(child);
    close(ends[1]);
    if (held)
        close(ends[0]);
    return status;
}

static void ends_at_once_if_the_parent_is_gone(void **state) {
    (void)state;
    assert_int_equal(outcome(true), WENT_ON);
    assert_int_equal(outcome(false), EXIT_FAILURE);
    pid_t child = fork();
    if (child == 0) {
        program_end_with(getppid() + 1);
        _exit(WENT_ON);
    }
    assert_int_equal(status_of(child), EXIT_FAILURE);
}

/* Runs in the grandchild: writes a byte when it is tied, and holds the pipe as long as it lives. */
_Noreturn static void live(int end, bool piped, const int peer[2], pid_t parent) {
    if (piped) {
        close(peer[0]);
        program_end_with_parent(peer[1], SIGTERM);
    } else {
        program_end_with(parent);
    }
    if (write(end, "", 1) == 1)
        for (;;)
            pause();
    _exit(EXIT_FAILURE);
}

static void ends_with_a_killed_parent(void **state) {
    (void)state;
    for (int piped = 0; piped < 2; piped++) {
        int life[2];
        char byte;
        assert_int_equal(pipe2(life, O_CLOEXEC), 0);
        pid_t middle = fork();
        if (middle == 0) {
            int peer[2];
            const pid_t parent = getpid();
            if (pipe2(peer, O_CLOEXEC))
                _exit(EXIT_FAILURE);
            if (fork() == 0)
                live(life[1], piped, peer, parent);
            for (;;)
                pause();
        }
        close(life[1]);
        assert_int_equal(read(life[0], &byte, 1), 1);
        kill(middle, SIGKILL);
        assert_int_equal(status_of(middle), -SIGKILL);
        assert_int_equal(read(life[0], &byte, 1), 0); /* nobody holds it any more */
        close(life[0]);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(ends_at_once_if_the_parent_is_gone),
        cmocka_unit_test(ends_with_a_killed_parent),
    };
    alarm(120);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
