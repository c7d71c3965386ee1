/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A plugin (tests/plugins/escape.c) tries to escape from its worker; this process acts as the daemon. */
#include "tests/unit/pool_fixture.h"
#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmocka.h>

static char folder[] = "/tmp/faccia-test-escape-XXXXXX", secret[64], file[64];

static int make_files(void **state) {
    (void)state;
    if (!mkdtemp(folder))
        return -1;
    snprintf(secret, sizeof secret, "%s/secret", folder);
    snprintf(file, sizeof file, "%s/file", folder);
    FILE *files[] = {fopen(secret, "w"), fopen(file, "w")};
    for (size_t i = 0; i < 2; i++) {
        if (!files[i])
            return -1;
        fputs("text", files[i]);
        fclose(files[i]);
    }
    chmod(file, 0640);
    setenv("FACCIA_TEST_SECRET", secret, 1);
    setenv("FACCIA_TEST_FOLDER", folder, 1);
    return 0;
}

static int remove_files(void **state) {
    (void)state;
    unlink(secret);
    unlink(file);
    return rmdir(folder); /* fails unless the folder is empty */
}

/* Attempts that only Landlock prevents. */
static bool of_landlock(const char *name) {
    static const char *const names[] = {
        "secret", "home", "create", "write", "create in tmp", "name", "out of memory score"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        if (!strcmp(names[i], name))
            return true;
    return false;
}

static bool is_one_of(const char *const *names, const char *name) {
    while (*names && strcmp(*names, name) != 0)
        names++;
    return *names;
}

static const char *const attempts[] = {
    "memory",
    "read memory",
    "environment",
    "trace",
    "peek",
    "poke",
    "signal",
    "signal group",
    "signal all",
    "signal thread",
    "queue signal",
    "open process",
    "own descriptor",
    "priority",
    "priority of user",
    "disk priority",
    "processors",
    "limits",
    "out of memory score",
    "datagram",
    "datagram of a pair",
    "send with address",
    "connect",
    "old call",
    "program",
    "fork",
    "namespace",
    "mount",
    "secret",
    "home",
    "write",
    "empty",
    "truncate",
    "create",
    "create in tmp",
    "remove",
    "folder",
    "mode",
    "name",
    "system",
    "nowhere",
    "thread",
};
enum { ATTEMPTS = sizeof attempts / sizeof *attempts };

/* Tells whether the kernel supports 32-bit system calls ("old call"). */
static bool has_old_calls(void) {
    int status = -1;
#ifdef __x86_64__
    pid_t child = fork();
    if (!child) {
        long result;
        signal(SIGSEGV, SIG_DFL);
        __asm__ volatile("int $0x80" : "=a"(result) : "a"(20) : "memory", "r8", "r9", "r10", "r11");
        _exit(result < 0);
    }
    waitpid(child, &status, 0);
#endif
    return status == 0;
}

/* Checks the result of an attempt, in an initialiser and while speaking. */
static bool is_as_wanted(const char *name, const struct result *r, bool allowed) {
    if (syscall(444, NULL, 0, 1) < 1 && of_landlock(name)) {
        print_message("this kernel has no Landlock: not checked: %s\n", name);
        return true;
    }
    if (allowed && !strcmp(name, "old call") && !has_old_calls()) {
        print_message("this kernel has no calls of 32 bits: not checked: %s\n", name);
        return true;
    }
    const char *outcome = !r->failed && r->u->warning_count == 1 ? r->u->warnings[0] : "no report";
    bool right = !strcmp(outcome, allowed ? "done, done" : "refused, refused");
    if (!right)
        print_error("%s: %s\n", name, outcome);
    return right;
}

static void try_to_escape(const char *plugin, const char *config, const char *const *allowed) {
#ifndef HAVE_SECCOMP
    skip();
#endif
    struct stat info;
    int priority = getpriority(PRIO_PROCESS, 0);
    struct pool_test *s = OPEN(WITH(.config = config), plugin);
    for (size_t i = 0; i < ATTEMPTS; i++)
        pool_test_speak(s, "plain", attempts[i]);
    pool_test_run(s);
    unsigned right = 0;
    for (size_t i = 0; i < ATTEMPTS; i++)
        right += is_as_wanted(attempts[i], &s->results[i], is_one_of(allowed, attempts[i]));
    assert_int_equal(right, ATTEMPTS);
    assert_int_equal(getpriority(PRIO_PROCESS, 0), priority);
    assert_int_equal(stat(file, &info), 0);
    assert_int_equal(info.st_mode & 07777, 0640);
    assert_int_equal(info.st_size, 4);
    pool_test_shut(s);
}

static void a_plugin_without_capabilities(void **state) {
    static const char *const allowed[] = {"system", "nowhere", "thread", NULL};
    (void)state;
    try_to_escape("escape", NULL, allowed);
}

static void a_plugin_that_starts_programs(void **state) {
    static const char *const allowed[] = {"system", "nowhere", "thread", "program", "fork", "old call", NULL};
    (void)state;
    try_to_escape("escape_programs", NULL, allowed);
}

/* Paths listed by the operator can be read but not written, because the plugin does not declare FILES. */
static void what_the_operator_allows(void **state) {
    static const char *const allowed[] = {"secret", "system", "nowhere", "thread", NULL};
    char config[200];
    (void)state;
    snprintf(config, sizeof config, "{\"escape\":{\"may_read\":[\"%s\"],\"may_write\":[\"%s\"]}}", folder,
             folder);
    try_to_escape("escape", config, allowed);
}

/* A file named in the configuration can be read, but nothing else in a shared folder such as /tmp. */
static void what_its_configuration_names(void **state) {
    static const char *const allowed[] = {"secret", "system", "nowhere", "thread", NULL};
    char config[200];
    (void)state;
    snprintf(config, sizeof config, "{\"escape\":{\"voices\":[{\"argv\":[\"x\",\"%s\"]}]}}", secret);
    try_to_escape("escape", config, allowed);
}

static void a_table_that_changes_is_refused(void **state) {
    (void)state;
    size_t count;
    struct pool_test *s = OPEN(WITH(0), "liar", "puppet");
    voice_pool_voices(s->pool, &count);
    assert_int_equal(count, 2);
    pool_test_shut(s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_plugin_without_capabilities),   cmocka_unit_test(a_plugin_that_starts_programs),
        cmocka_unit_test(what_the_operator_allows),        cmocka_unit_test(what_its_configuration_names),
        cmocka_unit_test(a_table_that_changes_is_refused),
    };
    return cmocka_run_group_tests(tests, make_files, remove_files);
}
