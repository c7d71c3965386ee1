/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/fit/least_squares.h"
#include <gsl/gsl_blas.h>
#include <gsl/gsl_errno.h>
#include <gsl/gsl_multifit_nlinear.h>
#include <string.h>

static int residual(const gsl_vector *x, void *ctx, gsl_vector *f) {
    const struct least_squares *p = ctx;
    p->residual(p->ctx, x->data, f->data);
    return GSL_SUCCESS;
}

static int jacobian(const gsl_vector *x, void *ctx, gsl_matrix *j) {
    const struct least_squares *p = ctx;
    gsl_matrix_set_zero(j);
    p->jacobian(p->ctx, x->data, j->data, j->tda);
    return GSL_SUCCESS;
}

static double sum_of_squares(const gsl_multifit_nlinear_workspace *w) {
    double norm = gsl_blas_dnrm2(gsl_multifit_nlinear_residual(w));
    return norm * norm;
}

double least_squares_run(const struct least_squares *problem, double *x, int iterations) {
    /* A step that fails is an answer here, not the end of the program. */
    gsl_error_handler_t *handler = gsl_set_error_handler_off();
    gsl_multifit_nlinear_parameters how = gsl_multifit_nlinear_default_parameters();
    how.trs = gsl_multifit_nlinear_trs_subspace2D;
    /* The pulls keep the normal equations from being singular. */
    how.solver = gsl_multifit_nlinear_solver_cholesky;
    gsl_multifit_nlinear_workspace *w =
        gsl_multifit_nlinear_alloc(gsl_multifit_nlinear_trust, &how, problem->residuals, problem->unknowns);
    gsl_multifit_nlinear_fdf fdf = {.f = residual,
                                    .df = jacobian,
                                    .n = problem->residuals,
                                    .p = problem->unknowns,
                                    .params = (void *)problem};
    gsl_vector_const_view start = gsl_vector_const_view_array(x, problem->unknowns);
    gsl_multifit_nlinear_init(&start.vector, &fdf, w);
    for (int i = 1; i <= iterations; i++) {
        if (gsl_multifit_nlinear_iterate(w) != GSL_SUCCESS)
            break;
        if (problem->progress)
            problem->progress(problem->ctx, i, sum_of_squares(w));
    }
    double sum = sum_of_squares(w);
    memcpy(x, gsl_multifit_nlinear_position(w)->data, problem->unknowns * sizeof *x);
    gsl_multifit_nlinear_free(w);
    gsl_set_error_handler(handler);
    return sum;
}
