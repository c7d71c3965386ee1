/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/cli/fap_fit.h"
#include "protocol/fba/fapfit.h"
#include "protocol/fba/fba.h"
#include "server/base/buf.h"
#include "server/base/mem.h"
#include "server/cli/cli.h"
#include "server/cli/fap_file.h"
#include <stdlib.h>

int fap_fit_use(const char *path, struct fapfile *face, bool remove, int quant,
                uint8_t left[FAP_MASK_BYTES]) {
    struct buf text = {0};
    struct fapfit_error e;
    struct fapfit *fit = mem_alloc(sizeof *fit);
    int status = cli_read(path, &text);
    if (!status && fapfit_read(text.size ? (char *)text.data : "", text.size, fit, &e)) {
        cli_complain("%s:%zu:%zu: %s", path, e.line, e.column, e.message);
        status = -1;
    }
    if (!status) {
        if (remove)
            fapfit_leave(fit, face->frames, face->count, quant, left);
        else
            for (size_t k = 0; k < face->count; k++)
                fapfit_apply(fit, &face->frames[k]);
        fapfit_free(fit);
    }
    free(fit);
    buf_free(&text);
    return status;
}

/* Writes a table as VRML and BIFS text have it. */
static void print_table(const struct fapfit *fit, struct buf *out) {
    buf_printf(out, "FIT {\n");
    for (int i = 0; i < FAPFIT_FIELDS; i++) {
        const struct fapfit_list *list = &fit->field[i];
        if (!list->count)
            continue;
        buf_printf(out, "  %s [", fapfit_names[i]);
        for (size_t k = 0; k < list->count; k++)
            buf_printf(out, k ? " %.7g" : "%.7g", list->at[k]);
        buf_printf(out, "]\n");
    }
    buf_printf(out, "}\n");
}

static int find(const char *in, const char *path, int quant) {
    struct fap_file file;
    struct buf out = {0};
    if (fap_file_read(in, &file))
        return EXIT_FAILED;
    struct fapfit *fit = mem_alloc(sizeof *fit);
    int status = EXIT_FAILED;
    if (fapfit_find(file.face.frames, file.face.count, quant, fit))
        cli_complain("%s: there is not enough memory", in);
    else if (!fit->sets)
        cli_complain("%s: no FAP is a multiple of another", in);
    else {
        print_table(fit, &out);
        status = fap_file_write(path, &out);
    }
    fapfit_free(fit);
    free(fit);
    buf_free(&out);
    fap_file_free(&file);
    return status;
}

int fap_fit_main(int argc, char **argv) {
    int quant = FBA_QUANT;
    const struct cli_option options[] = {{"quant", 0, CLI_WHOLE, &quant, 0, FBA_QUANT_MAX, NULL}, {0}};
    char command[] = "fap"; /* which has the help */
    argv[0] = command;
    int status = cli_options(argc, argv, "Try 'faccia fap --help'.\n", options, NULL);
    if (status >= 0)
        return status;
    if (argc - optind < 1 || argc - optind > 2) {
        cli_complain("fit: expected one input file, and at most one output file");
        return EXIT_USAGE;
    }
    return find(argv[optind], argc - optind > 1 ? argv[optind + 1] : "-", quant);
}
