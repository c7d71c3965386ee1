/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A folder of documents: saving never overwrites another client's change, and no name refers outside the
 * folder. */
#include "server/api/documents/document_store.h"
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmocka.h>

static char folder[64];
static struct document_store shelf = {folder, ".json", ERROR_UNKNOWN_WORK, 64, 3};
static const struct document_condition unsaid = {0}, any = {.match = "*"}, absent = {.absent = true};

static int begin(void **state) {
    (void)state;
    snprintf(folder, sizeof folder, "/tmp/faccia-shelf-XXXXXX");
    return mkdtemp(folder) ? 0 : -1;
}

static int end(void **state) {
    (void)state;
    char command[128];
    snprintf(command, sizeof command, "rm -r %s", folder);
    return system(command);
}

static void lay(const char *name, const char *text) {
    char path[256];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fputs(text, file);
    fclose(file);
}

static enum error_code save(const char *name, const char *text, struct document_condition condition,
                            char tag[ETAG_BYTES]) {
    struct error e;
    bool created;
    return document_store_save(&shelf, name, text, strlen(text), condition, tag, &created, &e) ? e.code
                                                                                               : ERROR_NONE;
}

static void assert_holds(const char *name, const char *text) {
    struct buf out = {0};
    char tag[ETAG_BYTES];
    struct error e;
    assert_int_equal(document_store_read(&shelf, name, &out, tag, &e), 0);
    assert_int_equal(out.size, strlen(text));
    assert_memory_equal(out.data, text, out.size);
    buf_free(&out);
}

static void what_was_saved_is_read(void **state) {
    (void)state;
    char tag[ETAG_BYTES], again[ETAG_BYTES], read[ETAG_BYTES];
    struct buf out = {0};
    struct error e;
    assert_int_equal(save("lunch", "one", unsaid, tag), ERROR_NONE);
    assert_int_equal(document_store_read(&shelf, "lunch", &out, read, &e), 0);
    assert_string_equal(tag, read);
    buf_free(&out);
    assert_int_equal(save("lunch", "two", (struct document_condition){.match = tag}, again), ERROR_NONE);
    assert_string_not_equal(tag, again);
    assert_holds("lunch", "two");
    assert_int_equal(document_store_remove(&shelf, "lunch", (struct document_condition){.match = tag}, &e),
                     -1);
    assert_int_equal(e.code, ERROR_CHANGED);
    assert_int_equal(document_store_remove(&shelf, "lunch", any, &e), 0);
    assert_int_equal(document_store_read(&shelf, "lunch", &out, read, &e), -1);
    assert_int_equal(e.code, ERROR_UNKNOWN_WORK);
    assert_int_equal(document_store_remove(&shelf, "lunch", unsaid, &e), -1);
    assert_int_equal(e.code, ERROR_UNKNOWN_WORK);
}

static void who_has_not_seen_it_does_not_replace_it(void **state) {
    (void)state;
    char first[ETAG_BYTES], tag[ETAG_BYTES];
    assert_int_equal(save("a", "1", absent, first), ERROR_NONE);
    assert_int_equal(save("a", "2", absent, tag), ERROR_CHANGED);
    assert_int_equal(save("a", "2", unsaid, tag), ERROR_CONDITION_NEEDED);
    assert_int_equal(save("a", "2", (struct document_condition){.match = "\"0\""}, tag), ERROR_CHANGED);
    assert_int_equal(save("b", "2", any, tag), ERROR_CHANGED);
    assert_holds("a", "1");
    assert_int_equal(save("a", "2", (struct document_condition){.match = first}, tag), ERROR_NONE);
    assert_int_equal(save("a", "3", (struct document_condition){.match = first}, tag), ERROR_CHANGED);
    assert_holds("a", "2");
}

/* Eight processes create the same document; one succeeds. */
static void one_of_many_is_the_first(void **state) {
    (void)state;
    pid_t children[8];
    char tag[ETAG_BYTES];
    for (int i = 0; i < 8; i++)
        if (!(children[i] = fork()))
            _exit(save("race", (char[]){(char)('0' + i), '\0'}, absent, tag) == ERROR_NONE ? 1 : 0);
    int won = 0, status;
    for (int i = 0; i < 8; i++) {
        assert_int_equal(waitpid(children[i], &status, 0), children[i]);
        won += WEXITSTATUS(status);
    }
    assert_int_equal(won, 1);
}

static void names_stay_inside(void **state) {
    (void)state;
    static const char *const bad[] = {"",
                                      ".",
                                      "..",
                                      "../a",
                                      "a/b",
                                      ".hidden",
                                      "caff\xc3\xa8",
                                      "a b",
                                      "a\n",
                                      "01234567890123456789012345678901234567890123456789012345678901234"};
    char tag[ETAG_BYTES];
    struct buf out = {0};
    struct error e;
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        assert_int_equal(save(bad[i], "x", unsaid, tag), ERROR_BAD_FIELD);
        assert_int_equal(document_store_read(&shelf, bad[i], &out, tag, &e), -1);
        assert_string_equal(e.field, "name");
    }
    assert_int_equal(
        save("0123456789012345678901234567890123456789012345678901234567890123", "x", unsaid, tag),
        ERROR_NONE);
}

static void other_files_are_not_looked_at(void **state) {
    (void)state;
    struct document_entry *entries;
    struct buf out = {0};
    size_t count;
    char path[128], tag[ETAG_BYTES];
    struct error e;
    lay("notes.txt", "not one");
    lay(".part", "of somebody who was stopped");
    lay("caffè.json", "a name that nobody can ask for");
    lay("mine.json", "{}");
    snprintf(path, sizeof path, "%s/link.json", folder);
    assert_int_equal(symlink("/etc/hostname", path), 0);
    snprintf(path, sizeof path, "%s/folder.json", folder);
    assert_int_equal(mkdir(path, 0700), 0);
    snprintf(path, sizeof path, "%s/pipe.json", folder);
    assert_int_equal(mkfifo(path, 0600), 0);
    assert_int_equal(document_store_list(&shelf, &entries, &count, &e), 0);
    assert_int_equal(count, 1);
    assert_string_equal(entries[0].name, "mine");
    assert_int_equal(entries[0].bytes, 2);
    free(entries);
    for (size_t i = 0; i < 3; i++) {
        assert_int_equal(
            document_store_read(&shelf, (const char *[]){"link", "folder", "pipe"}[i], &out, tag, &e), -1);
        assert_int_equal(e.code, ERROR_UNKNOWN_WORK);
    }
    assert_int_equal(save("mine", "{ }", any, tag), ERROR_NONE);
    assert_holds("mine", "{ }");
}

static void bounds(void **state) {
    (void)state;
    char tag[ETAG_BYTES], text[66];
    memset(text, 'x', 65);
    text[65] = '\0';
    assert_int_equal(save("long", text, unsaid, tag), ERROR_DOCUMENT_TOO_LONG);
    text[64] = '\0';
    assert_int_equal(save("long", text, unsaid, tag), ERROR_NONE);
    assert_int_equal(save("two", "2", unsaid, tag), ERROR_NONE);
    assert_int_equal(save("three", "3", unsaid, tag), ERROR_NONE);
    assert_int_equal(save("four", "4", unsaid, tag), ERROR_STORE_FULL);
    assert_int_equal(save("three", "33", any, tag), ERROR_NONE);
    lay("long.json", "what somebody has laid there is longer than what may be kept, and is not read");
    struct buf out = {0};
    struct error e;
    assert_int_equal(document_store_read(&shelf, "long", &out, tag, &e), -1);
    assert_int_equal(e.code, ERROR_DOCUMENT_TOO_LONG);
    buf_free(&out);
}

static void without_a_folder(void **state) {
    (void)state;
    struct document_store none = shelf, gone = shelf;
    struct document_entry *entries;
    struct error e;
    size_t count;
    bool created;
    char tag[ETAG_BYTES];
    none.folder = NULL;
    gone.folder = "/nowhere/at/all";
    assert_int_equal(document_store_list(&none, &entries, &count, &e), -1);
    assert_int_equal(e.code, ERROR_NOTHING_KEPT);
    assert_int_equal(document_store_save(&gone, "a", "1", 1, unsaid, tag, &created, &e), -1);
    assert_int_equal(e.code, ERROR_CANNOT_KEEP);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(what_was_saved_is_read, begin, end),
        cmocka_unit_test_setup_teardown(who_has_not_seen_it_does_not_replace_it, begin, end),
        cmocka_unit_test_setup_teardown(one_of_many_is_the_first, begin, end),
        cmocka_unit_test_setup_teardown(names_stay_inside, begin, end),
        cmocka_unit_test_setup_teardown(other_files_are_not_looked_at, begin, end),
        cmocka_unit_test_setup_teardown(bounds, begin, end),
        cmocka_unit_test_setup_teardown(without_a_folder, begin, end),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
