/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/research/listening/results.h"
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

static void near(double got, double wanted, double relative) {
    if (fabs(got - wanted) > relative * fabs(wanted))
        fail_msg("%.15g is not %.15g", got, wanted);
}

static void tail(void **state) {
    (void)state;
    /* critical values from printed tables: F for 5 % and 1 % */
    near(anova_f_tail(161.4476, 1, 1), 0.05, 1e-5);
    near(anova_f_tail(4.9646, 1, 10), 0.05, 1e-4);
    near(anova_f_tail(3.9604, 1, 80), 0.05, 1e-4);
    near(anova_f_tail(3.0718, 2, 120), 0.05, 1e-4);
    near(anova_f_tail(4.7865, 2, 120), 0.01, 1e-4);
    /* t distribution: F(1, n) is the square of t(n); two-sided t 2.228 of 10 degrees is 5 % */
    near(anova_f_tail(2.228139 * 2.228139, 1, 10), 0.05, 1e-5);
    /* with 2 and n degrees: (1 + 2F/n)^(-n/2) */
    near(anova_f_tail(88.1, 2, 120), pow(1 + 2 * 88.1 / 120, -60), 1e-10);
    assert_true(anova_f_tail(0, 2, 10) == 1);
    assert_true(anova_f_tail(INFINITY, 2, 10) == 0);
}

/* Costa, MSc thesis, UNICAMP 2009, tables 6.1 and 6.2; 41 listeners. */
static void thesis(void **state) {
    (void)state;
    static const struct {
        double mean[3], variance[3], f[4], p[4]; /* p = 0: printed as below 0.001 */
    } rows[] = {
        {{0.3424, 0.5944, 0.6396},
         {0.0077, 0.0136, 0.0145},
         {88.3376, 122.8871, 163.6644, 2.8801},
         {0, 0, 0, 0.0936}},
        {{0.1572, 0.4860, 0.5601},
         {0.0069, 0.0191, 0.0128},
         {144.5427, 169.7029, 332.3711, 6.8227},
         {0, 0, 0, 0.0107}},
        {{0.0072, 0.2439, 0.3839},
         {0.0004, 0.0132, 0.0136},
         {163.9649, 171.4500, 413.1182, 29.5926},
         {0, 0, 0, 0}},
    };
    static const int pairs[4][2] = {{0, 0}, {0, 1}, {0, 2}, {1, 2}};
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        struct anova_group g[3];
        struct anova a;
        for (int k = 0; k < 3; k++)
            g[k] = (struct anova_group){41, rows[i].mean[k], rows[i].variance[k]};
        for (int k = 0; k < 4; k++) {
            struct anova_group pair[2] = {g[pairs[k][0]], g[pairs[k][1]]};
            assert_int_equal(anova_run(k ? pair : g, k ? 2 : 3, &a), 0);
            near(a.f, rows[i].f[k], 0.04);
            assert_true(a.df_between == (k ? 1 : 2) && a.df_within == (k ? 80 : 120));
            if (rows[i].p[k] > 0) /* the printed F's own p, exactly; ours from rounded means, nearly */
                near(anova_f_tail(rows[i].f[k], 1, 80), rows[i].p[k], 0.01);
            else
                assert_true(a.p < 0.001);
        }
    }
}

static void unequal(void **state) {
    (void)state;
    /* 1 2 3 | 2 4 | 9: means 2, 3, 9; grand mean 3.5; between 3 * 2.25 + 2 * 0.25 + 30.25 = 37.5; within 2 +
     * 2 = 4 */
    const double one[] = {1, 2, 3}, two[] = {2, 4}, three[] = {9};
    struct anova_group g[] = {anova_group(one, 3), anova_group(two, 2), anova_group(three, 1)};
    struct anova a;
    assert_int_equal(anova_run(g, 3, &a), 0);
    near(a.between, 37.5, 1e-12);
    near(a.within, 4, 1e-12);
    near(a.f, 37.5 / 2 / (4.0 / 3), 1e-12);
    assert_int_equal(anova_run(g, 1, &a), -1);
    assert_int_equal(anova_run(g + 2, 1, &a), -1);
    struct anova_group alike[] = {{5, 0.5, 0}, {5, 0.5, 0}}, apart[] = {{5, 0.5, 0}, {5, 0.6, 0}};
    assert_int_equal(anova_run(alike, 2, &a), 0);
    assert_true(isnan(a.f) && isnan(a.p));
    assert_int_equal(anova_run(apart, 2, &a), 0);
    assert_true(isinf(a.f) && a.p == 0);
}

static void answers(void **state) {
    (void)state;
    static const char first[] = "\xef\xbb\xbflistener,mode,snr,item,correct\r\n"
                                "ann,audio,-24,papa,1\r\nann,audio,-24,pipi,0\r\nann,face,-24,papa,1\r\n\r\n"
                                "ann,face,-24,pipi,\r\nann,audio,-12,papa,1\r\nann,face,-12,papa,\r\n";
    static const char second[] =
        "correct,snr,mode,listener\n0,-24,audio,\"bo, \"\"b\"\"\"\n1,-24,face,\"bo, \"\"b\"\"\"";
    struct votes votes = {0};
    struct results r = {0};
    struct error e;
    assert_int_equal(votes_read(&votes, first, sizeof first - 1, &e), 0);
    assert_int_equal(votes_read(&votes, second, sizeof second - 1, &e), 0);
    results_from_votes(&votes, &r);
    assert_int_equal(r.count, 3);
    assert_true(r.cells[0].snr == -12 && r.cells[1].snr == -24 && r.cells[2].snr == -24);
    assert_string_equal(r.cells[1].mode, "audio");
    assert_true(r.cells[1].group.n == 2 && r.cells[1].group.mean == 0.25 &&
                r.cells[1].group.variance == 0.125);
    assert_true(r.cells[2].group.mean == 1 && r.cells[2].group.variance == 0);
    votes_free(&votes);
    results_free(&r);

    static const char short_line[] = "listener,mode,snr,correct\nann,face,-24";
    assert_int_equal(votes_read(&(struct votes){0}, short_line, sizeof short_line - 1, &e), -1);
    assert_string_equal(e.message, "correct must be a number from 0 to 1, not ''");
}

static void bad_csv(void **state) {
    (void)state;
    static const struct {
        const char *text, *message;
        size_t line;
    } bad[] = {
        {"", "it is empty", 1},
        {"snr,mode,mean,variance\n", "missing column 'n'", 1},
        {"snr,mode,mean,variance,n\n1,a,0.5,0.1,20\n1,b,0.5,x,20\n",
         "variance must be a number from 0 to 1, not 'x'", 3},
        {"snr,mode,mean,variance,n\n1,a,0.5,0.1,1\n", "n must be a number from 2 to 1e+06, not '1'", 2},
        {"snr,mode,mean,variance,n\n1,,0.5,0.1,9\n", "mode must have 1 to 63 bytes", 2},
        {"snr,mode,mean,variance,n\nnan,a,0.5,0.1,9\n", "snr must be a number from -200 to 200, not 'nan'",
         2},
        {"snr,mode,mean,variance,n\n1,a,0.5,0.1,9\n1,a,0.5,0.1,9\n", "'a' at 1 dB occurs twice", 3},
        {"snr,mode,mean,variance,n\n1,\"a,0.5\n,0.1,9\n", "a quoted field is not closed", 2},
        {"snr,mode,mean,variance,n\n1,\"a\"b,0.5,0.1,9\n", "text follows a quoted field", 2},
        {"snr,mode,mean,variance,n,note\n1,a,0.5,0.1,9,\"a\nb\"\n1,c\n",
         "mean must be a number from 0 to 1, not ''", 4},
        {"snr,mode,mean,variance,n\n1,\"a\nb\",0.5,0.1,9\n", "mode contains a control character", 2},
    };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        struct results r = {0};
        struct error e;
        assert_int_equal(results_read_means(bad[i].text, strlen(bad[i].text), &r, &e), -1);
        assert_string_equal(e.message, bad[i].message);
        assert_int_equal(e.line, bad[i].line);
        results_free(&r);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(tail),    cmocka_unit_test(thesis),  cmocka_unit_test(unequal),
        cmocka_unit_test(answers), cmocka_unit_test(bad_csv),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
