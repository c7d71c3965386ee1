/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Who may write a file of secrets; a token's header and dates; host names that are accepted. */
#include "server/access/origin.h"
#include "server/access/token.h"
#include <fcntl.h>
#include <jwt.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmocka.h>

static char secret[] = "0123456789abcdef0123456789abcdef", other[] = "fedcba9876543210fedcba9876543210";

static void only_the_owner_may_write(void **state) {
    (void)state;
    char folder[] = "/tmp/faccia-secrets-XXXXXX", path[64];
    struct secrets secrets;
    struct error e;
    assert_non_null(mkdtemp(folder));
    snprintf(path, sizeof path, "%s/file", folder);
    int fd = open(path, O_CREAT | O_WRONLY, 0600);
    assert_int_equal(dprintf(fd, "%s\n", secret), 33);
    close(fd);
    static const struct {
        mode_t file, folder;
        bool good;
    } cases[] = {
        {0600, 0700, true},  {0640, 0755, true},  {0644, 0755, true},   {0620, 0700, false},
        {0602, 0700, false}, {0666, 0700, false}, {0600, 0770, false},  {0600, 0702, false},
        {0600, 0777, false}, {0600, 01777, true}, {0602, 01777, false},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        assert_int_equal(chmod(path, cases[i].file), 0);
        assert_int_equal(chmod(folder, cases[i].folder), 0);
        assert_int_equal(secrets_load(&secrets, path, &e), cases[i].good ? 0 : -1);
        if (!cases[i].good)
            assert_non_null(strstr(e.message, "users other than its owner"));
        secrets_free(&secrets);
    }
    assert_int_equal(secrets_load(&secrets, folder, &e), -1);
    assert_non_null(strstr(e.message, "is a folder"));
    unlink(path);
    rmdir(folder);
}

/* Signs a token like another program. */
static char *sign(jwt_alg_t alg, const char *claims, const char *header) {
    jwt_t *jwt = NULL;
    assert_int_equal(jwt_new(&jwt), 0);
    assert_int_equal(jwt_set_alg(jwt, alg, (unsigned char *)secret, (int)strlen(secret)), 0);
    assert_int_equal(jwt_add_grants_json(jwt, claims), 0);
    if (header)
        assert_int_equal(jwt_add_headers_json(jwt, header), 0);
    char *text = jwt_encode_str(jwt);
    jwt_free(jwt);
    return text;
}

#define WHO "\"sub\":\"anna\",\"rights\":\"speak\""

static void dates_and_headers(void **state) {
    (void)state;
    static const struct {
        jwt_alg_t alg;
        const char *claims, *header, *code; /* code NULL: valid */
    } cases[] = {
        {JWT_ALG_HS256, "{" WHO ",\"exp\":2000}", NULL, NULL},
        {JWT_ALG_HS256, "{" WHO ",\"exp\":2000.5,\"nbf\":900,\"iat\":999.9}", NULL, NULL},
        {JWT_ALG_HS256, "{" WHO ",\"exp\":1000}", NULL, "expired-token"},
        {JWT_ALG_HS256, "{" WHO "}", NULL, "bad-token"},
        {JWT_ALG_HS256, "{" WHO ",\"exp\":\"2000\"}", NULL, "bad-token"},
        {JWT_ALG_HS256, "{" WHO ",\"exp\":-1}", NULL, "bad-token"},
        {JWT_ALG_HS256, "{" WHO ",\"exp\":1e300}", NULL, "bad-token"},
        {JWT_ALG_HS256, "{" WHO ",\"exp\":2000,\"nbf\":1020}", NULL,
         NULL}, /* tolerates small clock differences */
        {JWT_ALG_HS256, "{" WHO ",\"exp\":2000,\"nbf\":1100}", NULL, "early-token"},
        {JWT_ALG_HS256, "{" WHO ",\"exp\":2000,\"nbf\":\"soon\"}", NULL, "bad-token"},
        {JWT_ALG_HS256, "{" WHO ",\"exp\":2000,\"iat\":1100}", NULL, "early-token"},
        {JWT_ALG_HS256, "{" WHO ",\"exp\":2000,\"room\":7}", NULL, "bad-token"},
        {JWT_ALG_HS256, "{" WHO ",\"exp\":2000}", "{\"crit\":[\"exp\"]}", "bad-token"},
        {JWT_ALG_HS256, "{" WHO ",\"exp\":2000}", "{\"crit\":[]}", "bad-token"},
        {JWT_ALG_HS256, "{" WHO ",\"exp\":2000}", "{\"kid\":\"1\"}", NULL},
        {JWT_ALG_HS384, "{" WHO ",\"exp\":2000}", NULL, "bad-token"},
        {JWT_ALG_HS512, "{" WHO ",\"exp\":2000}", NULL, "bad-token"},
    };
    const struct secrets secrets = {(char *[]){other, secret}, 2};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct token token;
        struct error e;
        char *text = sign(cases[i].alg, cases[i].claims, cases[i].header);
        int result = token_check(&secrets, text, 1000, &token, &e);
        if (result != (cases[i].code ? -1 : 0) ||
            (cases[i].code && strcmp(error_name(e.code), cases[i].code)))
            fail_msg("%s %s: %d %s", cases[i].claims, cases[i].header ? cases[i].header : "", result,
                     result ? error_name(e.code) : "");
        free(text);
    }
}

/* Tokens remember their secret, so removing it revokes them. */
static void secrets_that_are_gone(void **state) {
    (void)state;
    const struct secrets both = {(char *[]){other, secret}, 2}, first = {(char *[]){other}, 1},
                         second = {(char *[]){secret}, 1};
    const struct token sample = {.subject = "anna", .rights = RIGHT_SPEAK, .expires = 2000};
    struct token token;
    struct error e;
    char *text = token_make(&second, &sample, &e);
    assert_int_equal(token_check(&both, text, 1000, &token, &e), 0);
    assert_true(secrets_have(&both, token.secret));
    assert_true(secrets_have(&second, token.secret));
    assert_false(secrets_have(&first, token.secret));
    free(text);
}

static void hosts(void **state) {
    (void)state;
    static const struct {
        const char *host;
        bool good, listed, local; /* without names; with --host-name; when listening only on loopback */
    } cases[] = {
        {NULL, true, true, true},
        {"", true, true, true},
        {"localhost", true, true, true},
        {"LOCALHOST:8080", true, true, true},
        {"localhost.:8080", true, true, true},
        {"app.localhost:1", true, true, true},
        {"127.0.0.1:8080", true, true, true},
        {"127.9.9.9", true, true, true},
        {"[0:0:0:0:0:0:0:1]", true, true, true},
        {"0.0.0.0:8080", true, true, false},
        {"[::]:8080", true, true, false},
        {"[::ffff:7f00:1]:8080", true, true, false},
        {"[::ffff:127.0.0.1]", true, true, false},
        {"128.0.0.1", true, true, false},
        {"192.0.2.7:80", true, true, false},
        {"[::1]:8080", true, true, true},
        {"[2001:db8::7]", true, true, false},
        {"kiosk", true, true, false},
        {"Kiosk:8080", true, true, false},
        {"hall.example", false, true, false},
        {"HALL.example.:443", false, true, false},
        {"evil.example", false, false, false},
        {"evil.example:8080", false, false, false},
        {"localhost.evil.example", false, false, false},
        {"127.0.0.1.evil.example", false, false, false},
        {"evil.localhost.example", false, false, false},
        {".localhost", false, false, false},
        {"[::1].evil.example", false, false, false},
        {"[::1", false, false, false},
        {"localhost:80.evil.example", false, false, false},
        {"kiosk.evil.example", false, false, false},
        {"0x7f.1", false, false, false},
        {"*", false, false, false},
        {".", false, false, false},
        {":8080", false, false, false},
    };
    char *const list[] = {"hall.example:8080", NULL}, *const all[] = {"*", NULL};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        if (host_allowed(cases[i].host, "kiosk", NULL, false) != cases[i].good ||
            host_allowed(cases[i].host, "kiosk", list, false) != cases[i].listed ||
            host_allowed(cases[i].host, "kiosk", NULL, true) != cases[i].local ||
            !host_allowed(cases[i].host, "kiosk", all, true))
            fail_msg("%s", cases[i].host);
    }
    assert_false(host_allowed("kiosk", NULL, NULL, false));
    assert_true(host_allowed("hall.example", NULL, list, true));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(only_the_owner_may_write),
        cmocka_unit_test(dates_and_headers),
        cmocka_unit_test(secrets_that_are_gone),
        cmocka_unit_test(hosts),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
