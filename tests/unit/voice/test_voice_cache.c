/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/voice/voice_cache.h"
#include <setjmp.h>
#include <signal.h>
#include <sqlite3.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmocka.h>

static struct buf bytes(const char *format, int n, size_t size) {
    struct buf b = {0};
    buf_printf(&b, format, n);
    while (b.size < size)
        buf_add(&b, "0123456789abcdef", size - b.size < 16 ? size - b.size : 16);
    return b;
}

static bool holds(struct voice_cache *cache, int n, size_t size) {
    struct buf key = bytes("key %d", n, 0), value = bytes("value %d ", n, size);
    const struct buf *found = cache_get(cache, &key);
    bool same = found && found->size == value.size && !memcmp(found->data, value.data, value.size);
    if (found)
        assert_true(same);
    buf_free(&key);
    buf_free(&value);
    return same;
}

static void put(struct voice_cache *cache, int n, size_t size) {
    struct buf key = bytes("key %d", n, 0), value = bytes("value %d ", n, size);
    cache_put(cache, &key, &value);
    buf_free(&key);
    buf_free(&value);
}

static void memory(void **state) {
    (void)state;
    uv_loop_t *loop = uv_default_loop();
    struct voice_cache *cache = cache_open(loop, &(struct cache_options){.bytes = 10000});
    assert_false(holds(cache, 1, 100));
    for (int n = 0; n < 9; n++)
        put(cache, n, 1000);
    for (int n = 0; n < 9; n++)
        assert_true(holds(cache, n, 1000));
    assert_true(holds(cache, 0, 1000)); /* used, so number 1 is the oldest now */
    put(cache, 9, 1000);
    assert_true(holds(cache, 0, 1000));
    assert_false(holds(cache, 1, 1000));
    put(cache, 5, 2000); /* replaces the value */
    assert_true(holds(cache, 5, 2000));
    put(cache, 20, 3000); /* above a quarter of the space */
    assert_false(holds(cache, 20, 3000));
    assert_true(holds(cache, 5, 2000));
    cache_close(cache);
    assert_null(cache_open(loop, &(struct cache_options){0}));
}

static char folder[] = "/tmp/faccia-cache-XXXXXX", file[64];

static struct voice_cache *on_disk(size_t memory, uint64_t room) {
    return cache_open(uv_default_loop(), &(struct cache_options){memory, file, room});
}

static void finish(struct voice_cache *cache) {
    cache_close(cache);
    uv_run(uv_default_loop(), UV_RUN_DEFAULT);
}

static void disk(void **state) {
    (void)state;
    struct voice_cache *cache = on_disk(0, 1 << 20);
    for (int n = 0; n < 20; n++)
        put(cache, n, 5000);
    finish(cache);
    cache = on_disk(100000, 1 << 20);
    for (int n = 0; n < 20; n++)
        assert_true(holds(cache, n, 5000));
    finish(cache);
}

static void disk_is_bounded(void **state) {
    (void)state;
    struct voice_cache *cache = on_disk(0, 30000);
    for (int n = 100; n < 160; n++) {
        put(cache, n, 5000);
        uv_run(uv_default_loop(), UV_RUN_DEFAULT);
        usleep(1500); /* order is by clock, in ms */
    }
    int kept = 0;
    for (int n = 100; n < 160; n++)
        kept += holds(cache, n, 5000);
    assert_in_range(kept, 4, 6);
    assert_true(holds(cache, 159, 5000));
    finish(cache);
}

/* Waits until the clock has advanced and all writes are done. */
static void settle(void) {
    uv_run(uv_default_loop(), UV_RUN_DEFAULT);
    usleep(1500);
}

static void what_is_asked_for_stays_on_disk(void **state) {
    (void)state;
    struct voice_cache *cache = on_disk(0, 30000);
    for (int n = 200; n < 205; n++) {
        put(cache, n, 5000);
        settle();
    }
    assert_true(holds(cache, 200, 5000));
    settle();
    for (int n = 205; n < 208; n++) {
        put(cache, n, 5000);
        settle();
    }
    assert_true(holds(cache, 200, 5000));
    assert_false(holds(cache, 201, 5000));
    finish(cache);
}

static void scribble(long at, const char *what, size_t size) {
    FILE *f = fopen(file, "r+");
    fseek(f, at, SEEK_SET);
    fwrite(what, 1, size, f);
    fclose(f);
}

static void damaged_files(void **state) {
    (void)state;
    static const char noise[8192] = "this is no database at all";
    for (int n = 0; n < 3; n++) {
        finish(on_disk(0, 1 << 20));
        if (n == 0)
            scribble(100, noise, sizeof noise); /* after the application id */
        else if (n == 1)
            scribble(4096, noise, sizeof noise); /* inside */
        else
            assert_int_equal(truncate(file, 5000), 0);
        struct voice_cache *cache = on_disk(0, 1 << 20);
        assert_non_null(cache);
        /* damage may be detected only at the first write, which is lost */
        for (int again = 0; again < 2; again++) {
            put(cache, 300 + n, 5000);
            uv_run(uv_default_loop(), UV_RUN_DEFAULT);
        }
        assert_true(holds(cache, 300 + n, 5000));
        finish(cache);
    }
}

/* With a full disk existing entries stay readable. */
static void full_disk(void **state) {
    (void)state;
    struct rlimit before, small;
    getrlimit(RLIMIT_FSIZE, &before);
    struct voice_cache *cache = on_disk(0, 1 << 30);
    put(cache, 400, 5000);
    uv_run(uv_default_loop(), UV_RUN_DEFAULT);
    signal(SIGXFSZ, SIG_IGN);
    small = before;
    small.rlim_cur = 200000;
    setrlimit(RLIMIT_FSIZE, &small);
    for (int n = 401; n < 501; n++) {
        put(cache, n, 20000);
        uv_run(uv_default_loop(), UV_RUN_DEFAULT);
    }
    assert_true(holds(cache, 400, 5000));
    assert_false(holds(cache, 500, 20000));
    setrlimit(RLIMIT_FSIZE, &before);
    finish(cache);
    cache = on_disk(0, 1 << 30);
    assert_true(holds(cache, 400, 5000));
    finish(cache);
}

/* Another process writes and is killed at a random time: all remaining entries are intact, and more can be
 * added. */
static void killed_while_writing(void **state) {
    (void)state;
    int found = 0;
    for (int round = 0; round < 8; round++) {
        int told[2];
        char byte;
        assert_int_equal(pipe(told), 0);
        pid_t writer = fork();
        assert_true(writer >= 0);
        if (!writer) {
            dup2(told[1], STDOUT_FILENO);
            execl("/proc/self/exe", "test_cache", "write", file, (char *)NULL);
            _exit(1);
        }
        assert_int_equal(read(told[0], &byte, 1), 1); /* the writer has started */
        usleep(1701 * (useconds_t)round);
        assert_int_equal(kill(writer, SIGKILL), 0);
        assert_int_equal(waitpid(writer, NULL, 0), writer);
        close(told[0]);
        close(told[1]);
        struct voice_cache *cache = on_disk(0, 1 << 24);
        assert_non_null(cache);
        for (int n = 1000; n < 1200; n++)
            found += holds(cache, n, 20000);
        put(cache, 600 + round, 5000);
        finish(cache);
        cache = on_disk(0, 1 << 24);
        for (int n = 0; n <= round; n++)
            assert_true(holds(cache, 600 + n, 5000));
        finish(cache);
    }
    assert_true(found > 0);
}

/* Runs in the other process: writes until killed. */
static int write_on(void) {
    struct voice_cache *cache = on_disk(0, 1 << 24);
    for (int n = 1000; cache; n = n < 1199 ? n + 1 : 1000) {
        put(cache, n, 20000);
        uv_run(uv_default_loop(), UV_RUN_DEFAULT);
        if (write(STDOUT_FILENO, "", 1) != 1)
            break;
    }
    return 1;
}

/* Two daemons with one file: each finds the other's entries. */
static void two_at_once(void **state) {
    (void)state;
    struct voice_cache *one = on_disk(0, 1 << 24), *two = on_disk(0, 1 << 24);
    for (int n = 700; n < 740; n++) {
        put(n % 2 ? one : two, n, 5000);
        put(n % 2 ? two : one, n, 5000); /* both need it */
        if (n % 5 == 0)
            uv_run(uv_default_loop(), UV_RUN_DEFAULT);
    }
    uv_run(uv_default_loop(), UV_RUN_DEFAULT);
    for (int n = 700; n < 740; n++) {
        assert_true(holds(one, n, 5000));
        assert_true(holds(two, n, 5000));
    }
    finish(one);
    put(two, 750, 5000);
    finish(two);
}

/* The file is damaged while two caches have it open: one recreates it, and both keep working. */
static void damaged_under_two(void **state) {
    static const char noise[8192] = "this is no database at all";
    (void)state;
    struct voice_cache *one = on_disk(0, 1 << 24);
    scribble(100, noise, sizeof noise);
    struct voice_cache *two = on_disk(0, 1 << 24);
    assert_non_null(two);
    for (int n = 800; n < 810; n++) {
        put(one, n, 5000);
        put(two, n, 5000);
        uv_run(uv_default_loop(), UV_RUN_DEFAULT);
        holds(one, n, 5000);
    }
    assert_true(holds(two, 809, 5000));
    finish(one);
    finish(two);
    two = on_disk(0, 1 << 24);
    assert_true(holds(two, 809, 5000));
    finish(two);
}

static size_t read_file(const char *path, char *out, size_t cap) {
    FILE *f = fopen(path, "rb");
    size_t size = f ? fread(out, 1, cap, f) : 0;
    if (f)
        fclose(f);
    return size;
}

/* A file that is not a cache stays unchanged, to the byte. */
static void check_untouched(const char *path) {
    static char before[65536], after[65536];
    char wal[256];
    struct stat old, now;
    struct error e;
    size_t size = read_file(path, before, sizeof before);
    snprintf(wal, sizeof wal, "%s-wal", path);
    assert_int_equal(stat(path, &old), 0);
    assert_int_equal(cache_file_check(path, &e), -1);
    assert_string_equal(error_name(e.code), "bad-cache");
    assert_string_equal(e.field, "--cache-file");
    assert_non_null(strstr(e.message, path));
    assert_null(cache_open(uv_default_loop(), &(struct cache_options){0, path, 1 << 20}));
    assert_int_equal(read_file(path, after, sizeof after), size);
    assert_memory_equal(before, after, size);
    assert_int_equal(stat(path, &now), 0);
    assert_int_equal(now.st_mode, old.st_mode);
    assert_int_equal(now.st_ino, old.st_ino);
    assert_int_equal(access(wal, F_OK), -1);
}

static void files_of_others(void **state) {
    (void)state;
    char path[128];
    sqlite3 *db;
    snprintf(path, sizeof path, "%s/other", folder);
    for (int n = 0; n < 4; n++) {
        unlink(path);
        FILE *f = n < 2 ? fopen(path, "w") : NULL;
        if (f) {
            fputs(n ? "SQLite format 3" : "A letter.\n", f);
            fclose(f);
        } else {
            assert_int_equal(sqlite3_open(path, &db), SQLITE_OK);
            assert_int_equal(sqlite3_exec(db,
                                          n == 2 ? "CREATE TABLE sentence (key); PRAGMA user_version=1"
                                                 : "CREATE TABLE a (b); PRAGMA application_id=7",
                                          NULL, NULL, NULL),
                             SQLITE_OK);
            sqlite3_close(db);
        }
        chmod(path, 0644);
        check_untouched(path);
    }
    unlink(path);
    assert_int_equal(mkdir(path, 0755), 0);
    struct error e;
    assert_int_equal(cache_file_check(path, &e), -1);
}

/* A foreign file replaces a cache in use that is then found damaged: it must not be touched. */
static void a_file_put_in_its_place(void **state) {
    (void)state;
    static const char noise[8192] = "this is no database at all";
    char kept[128], text[64] = "";
    snprintf(kept, sizeof kept, "%s/kept", folder);
    struct voice_cache *cache = on_disk(0, 1 << 20);
    for (int n = 0; n < 20; n++) {
        put(cache, 900 + n, 5000);
        uv_run(uv_default_loop(), UV_RUN_DEFAULT);
    }
    scribble(100, noise, sizeof noise);
    assert_int_equal(rename(file, kept), 0);
    FILE *f = fopen(file, "w");
    fputs("A letter.", f);
    fclose(f);
    for (int n = 0; n < 20; n++) {
        holds(cache, 900 + n, 5000);
        put(cache, 920 + n, 5000);
        uv_run(uv_default_loop(), UV_RUN_DEFAULT);
    }
    finish(cache);
    read_file(file, text, sizeof text - 1);
    assert_string_equal(text, "A letter.");
    unlink(file);
    unlink(kept);
}

/* In a shared folder with a usual umask, only the owner can read the cache. */
static void only_its_owner_reads_it(void **state) {
    (void)state;
    struct stat info;
    char path[128];
    mode_t mask = umask(022);
    unlink(file);
    struct voice_cache *cache = on_disk(0, 1 << 20);
    put(cache, 950, 5000);
    uv_run(uv_default_loop(), UV_RUN_DEFAULT);
    for (int n = 0; n < 3; n++) {
        snprintf(path, sizeof path, "%s%s", file, cache_file_ends[n]);
        assert_int_equal(stat(path, &info), 0);
        assert_int_equal(info.st_mode & 0777, 0600);
    }
    finish(cache);
    chmod(file, 0644); /* as older versions created it */
    finish(on_disk(0, 1 << 20));
    assert_int_equal(stat(file, &info), 0);
    assert_int_equal(info.st_mode & 0777, 0600);
    umask(mask);
}

static void no_such_place(void **state) {
    (void)state;
    assert_null(cache_open(uv_default_loop(), &(struct cache_options){0, "/nowhere/at/all", 1000}));
    struct voice_cache *cache =
        cache_open(uv_default_loop(), &(struct cache_options){1000, "/nowhere/at/all", 1000});
    put(cache, 1, 100);
    assert_true(holds(cache, 1, 100));
    finish(cache);
}

static int make_folder(void **state) {
    (void)state;
    if (!mkdtemp(folder))
        return -1;
    snprintf(file, sizeof file, "%s/cache", folder);
    return 0;
}

static int remove_folder(void **state) {
    (void)state;
    char command[128];
    snprintf(command, sizeof command, "rm -r '%s'", folder);
    return system(command);
}

int main(int argc, char **argv) {
    if (argc == 3 && !strcmp(argv[1], "write")) {
        snprintf(file, sizeof file, "%s", argv[2]);
        return write_on();
    }
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(memory),
        cmocka_unit_test(disk),
        cmocka_unit_test(disk_is_bounded),
        cmocka_unit_test(what_is_asked_for_stays_on_disk),
        cmocka_unit_test(damaged_files),
        cmocka_unit_test(full_disk),
        cmocka_unit_test(no_such_place),
        cmocka_unit_test(killed_while_writing),
        cmocka_unit_test(two_at_once),
        cmocka_unit_test(damaged_under_two),
        cmocka_unit_test(files_of_others),
        cmocka_unit_test(a_file_put_in_its_place),
        cmocka_unit_test(only_its_owner_reads_it),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
