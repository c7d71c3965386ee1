/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/access/origin.h"
#include "server/access/quota.h"
#include "server/access/token.h"
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

static char first[] = "0123456789abcdef0123456789abcdef", second[] = "fedcba9876543210fedcba9876543210";

static struct secrets both(void) {
    static char *list[] = {first, second};
    return (struct secrets){list, 2};
}

static const struct token sample = {
    .subject = "anna", .room = "hall", .rights = RIGHT_LISTEN | RIGHT_SPEAK, .expires = 2000};

static void there_and_back(void **state) {
    (void)state;
    struct secrets secrets = both();
    struct token token;
    struct error e;
    char *text = token_make(&secrets, &sample, &e);
    assert_non_null(text);
    assert_int_equal(token_check(&secrets, text, 1999, &token, &e), 0);
    assert_string_equal(token.subject, "anna");
    assert_string_equal(token.room, "hall");
    assert_int_equal(token.rights, RIGHT_LISTEN | RIGHT_SPEAK);
    assert_int_equal(token_check(&secrets, text, 2000, &token, &e), -1);
    assert_string_equal(error_name(e.code), "expired-token");
    free(text);
}

static void old_secret_still_counts(void **state) {
    (void)state;
    struct secrets old = {(char *[]){second}, 1}, now = both();
    struct token token;
    struct error e;
    char *text = token_make(&old, &sample, &e);
    assert_int_equal(token_check(&now, text, 0, &token, &e), 0);
    free(text);
}

/* A changed character, another secret or a missing signature invalidates the token. */
static void forgeries(void **state) {
    (void)state;
    struct secrets mine = {(char *[]){first}, 1}, other = {(char *[]){second}, 1};
    struct token token;
    struct error e;
    char *text = token_make(&mine, &sample, &e);
    assert_int_equal(token_check(&other, text, 0, &token, &e), -1);
    assert_string_equal(error_name(e.code), "bad-token");
    for (size_t i = 0; text[i + 1]; i++) {
        char was = text[i];
        text[i] = was == 'A' ? 'B' : 'A';
        assert_int_equal(token_check(&mine, text, 0, &token, &e), -1);
        text[i] = was;
    }
    /* {"alg":"none"}, {"sub":"anna","rights":"speak","exp":9999999999} */
    static const char unsigned_token[] =
        "eyJhbGciOiJub25lIn0.eyJzdWIiOiJhbm5hIiwicmlnaHRzIjoic3BlYWsiLCJleHAiOjk5OTk5OTk5OTl9.";
    assert_int_equal(token_check(&mine, unsigned_token, 0, &token, &e), -1);
    assert_int_equal(token_check(&mine, "", 0, &token, &e), -1);
    assert_int_equal(token_check(&mine, "...", 0, &token, &e), -1);
    char *huge = malloc(100001);
    memset(huge, 'e', 100000);
    huge[100000] = '\0';
    assert_int_equal(token_check(&mine, huge, 0, &token, &e), -1);
    free(huge);
    free(text);
}

static void secret_files(void **state) {
    (void)state;
    char path[] = "/tmp/faccia-secret-XXXXXX";
    struct secrets secrets;
    struct error e;
    int fd = mkstemp(path);
    assert_int_equal(dprintf(fd, "%s\n\n%s\r\n", first, second), 68);
    assert_int_equal(secrets_load(&secrets, path, &e), 0);
    assert_int_equal(secrets.count, 2);
    assert_string_equal(secrets.list[1], second);
    secrets_free(&secrets);
    assert_int_equal(dprintf(fd, "short\n"), 6);
    assert_int_equal(secrets_load(&secrets, path, &e), -1);
    assert_int_equal(e.line, 4);
    assert_int_equal(ftruncate(fd, 0), 0);
    assert_int_equal(secrets_load(&secrets, path, &e), -1);
    close(fd);
    unlink(path);
    assert_int_equal(secrets_load(&secrets, path, &e), -1);
}

static void rights(void **state) {
    (void)state;
    unsigned found;
    struct error e;
    assert_int_equal(rights_parse("speak,operate", &found, &e), 0);
    assert_int_equal(found, RIGHT_SPEAK | RIGHT_OPERATE);
    assert_int_equal(rights_parse("", &found, &e), -1);
    assert_int_equal(rights_parse("speak,dance", &found, &e), -1);
    assert_string_equal(e.field, "rights");
}

static void origins(void **state) {
    (void)state;
    char *const list[] = {"https://a.org", "https://*.b.org", NULL}, *const all[] = {"*", NULL};
    static const struct {
        const char *origin, *host;
        bool listed, unlisted;
    } cases[] = {
        {NULL, NULL, true, true},
        {"", NULL, true, true},
        {"https://a.org", NULL, true, false},
        {"https://a.org:444", NULL, false, false},
        {"http://a.org", NULL, false, false},
        {"https://x.b.org", NULL, true, false},
        {"https://x.b.org:1", NULL, false, false},
        {"https://b.org", NULL, false, false},
        {"https://evil.org/.b.org", "y", false, false},
        {"https://evilb.org", NULL, false, false},
        {"null", NULL, false, false},
        {"http://localhost:3000", NULL, true, true},
        {"http://127.0.0.1", NULL, true, true},
        {"http://localhost.evil.org", NULL, false, false},
        {"http://kiosk:8080", "kiosk:8080", true, true},
        {"http://kiosk:8080", "other:8080", false, false},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        assert_int_equal(origin_allowed(cases[i].origin, cases[i].host, list), cases[i].listed);
        assert_int_equal(origin_allowed(cases[i].origin, cases[i].host, NULL), cases[i].unlisted);
        assert_true(origin_allowed(cases[i].origin, cases[i].host, all));
    }
}

/* The last report about a key. */
struct told {
    char key[8];
    struct quota_use use;
};

static void on_told(void *ctx, const char *key, const struct quota_use *use) {
    struct told *told = ctx;
    snprintf(told->key, sizeof told->key, "%s", key);
    told->use = *use;
}

static void tallies_of_others(void **state) {
    (void)state;
    struct told told = {0};
    struct quota quota = {.changed = on_told, .ctx = &told};
    quota_seen(&quota, "one", "a", &(struct quota_use){2, 3, 7});
    quota_seen(&quota, "two", "a", &(struct quota_use){1, 1, 7});
    assert_string_equal(told.key, ""); /* not reported for this one */
    assert_int_equal(quota_open(&quota, "a"), 3);
    assert_false(quota_enter(&quota, "a", 3));
    assert_true(quota_enter(&quota, "a", 4));
    assert_string_equal(told.key, "a");
    assert_int_equal(told.use.open, 1);
    assert_true(quota_ask(&quota, "a", 5, 7 * 60000));
    assert_false(quota_ask(&quota, "a", 5, 7 * 60000));
    assert_true(quota_ask(&quota, "a", 5, 8 * 60000)); /* their requests were in another minute */
    assert_int_equal(told.use.asked, 1);
    assert_int_equal(told.use.minute, 8);
    quota_seen(&quota, "one", "a", &(struct quota_use){0, 0, 0});
    assert_int_equal(quota_open(&quota, "a"), 2);
    quota_gone(&quota, "two");
    assert_int_equal(quota_open(&quota, "a"), 1);
    assert_int_equal(quota.others, 0);
    quota_leave(&quota, "a");
    quota_sweep(&quota, 9 * 60000);
    assert_int_equal(told.use.open + told.use.asked, 0);
    assert_null(quota.entries);
    /* a key with nothing open here is kept while other daemons count it */
    for (int i = 0; i < TALLY_OTHERS_MOST + 5; i++) {
        char key[24];
        snprintf(key, sizeof key, "x%d", i);
        quota_seen(&quota, "one", key, &(struct quota_use){1, 0, 0});
    }
    assert_int_equal(quota.others, TALLY_OTHERS_MOST);
    assert_int_equal(quota.closed, 0);
    quota_gone(&quota, NULL);
    assert_null(quota.entries);
    quota_free(&quota);
}

static void revoked_secrets(void **state) {
    (void)state;
    struct secrets all = both();
    struct secrets_revoked revoked = {0};
    char mark[SECRET_MARK_BYTES], other[SECRET_MARK_BYTES];
    secret_mark(first, mark);
    secret_mark(second, other);
    assert_int_equal(strlen(mark), SECRET_MARK_BYTES - 1);
    assert_string_not_equal(mark, other);
    assert_false(secrets_revoked_add(&revoked, "no mark"));
    assert_true(secrets_revoked_add(&revoked, mark));
    assert_false(secrets_revoked_add(&revoked, mark));
    struct secrets good = secrets_good(&all, &revoked);
    assert_int_equal(good.count, 1);
    assert_string_equal(good.list[0], second);
    secrets_free(&good);
    free(revoked.marks);
}

static void tallies(void **state) {
    (void)state;
    struct quota quota = {0};
    assert_true(quota_enter(&quota, "a", 2));
    assert_true(quota_enter(&quota, "a", 2));
    assert_false(quota_enter(&quota, "a", 2));
    assert_true(quota_enter(&quota, "b", 2));
    quota_leave(&quota, "a");
    assert_true(quota_enter(&quota, "a", 2));
    for (int i = 0; i < 3; i++)
        assert_true(quota_ask(&quota, "a", 3, 59000));
    assert_false(quota_ask(&quota, "a", 3, 59999));
    assert_true(quota_ask(&quota, "b", 3, 59999));
    assert_true(quota_ask(&quota, "a", 3, 60000));
    quota_leave(&quota, "nobody");
    quota_leave(&quota, "a");
    quota_leave(&quota, "a");
    assert_int_equal(quota_open(&quota, "a"), 0);
    assert_false(quota_ask(&quota, "a", 1, 60000)); /* requests still count */
    assert_true(quota_ask(&quota, "a", 2, 60000));
    assert_true(quota_ask(&quota, "c", 1, 60000)); /* a key with nothing open */
    assert_false(quota_ask(&quota, "c", 1, 61000));
    assert_true(quota_ask(&quota, "c", 1, 120000));
    assert_int_equal(quota.closed, 1); /* a is forgotten after its minute; b has something open */
    for (int i = 0; i < 3 * TALLY_CLOSED_MOST; i++) {
        char key[24];
        snprintf(key, sizeof key, "x%d", i);
        assert_true(quota_ask(&quota, key, 1, 120000));
        assert_true(quota.closed <= TALLY_CLOSED_MOST + 1);
    }
    assert_int_equal(quota_open(&quota, "b"), 1);
    quota_free(&quota);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(there_and_back),  cmocka_unit_test(old_secret_still_counts),
        cmocka_unit_test(forgeries),       cmocka_unit_test(secret_files),
        cmocka_unit_test(rights),          cmocka_unit_test(origins),
        cmocka_unit_test(tallies),         cmocka_unit_test(tallies_of_others),
        cmocka_unit_test(revoked_secrets),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
