/* SPDX-License-Identifier: GPL-3.0-or-later */
/* faccia fap: files of face animation, .fap (MPEG-4 FAPs as text) and .fapc (the same, coded). */
#include "protocol/fapc.h"
#include "server/app/cli.h"
#include "server/app/fap_file.h"
#include <getopt.h>
#include <string.h>

static const char usage[] =
    "Usage: faccia fap info FILE...\n"
    "       faccia fap convert [--fps N] [--name NAME] FILE [OUT.fap]\n"
    "       faccia fap encode [--quality N] [--fps N] FILE [OUT.fapc]\n"
    "       faccia fap decode [--name NAME] FILE.fapc [OUT.fap]\n"
    "       faccia fap plot [--fap LIST] [--from S] [--to S] FILE [OUT.svg]\n"
    "Files of face animation: .fap of versions 2.0 and 2.1 (MPEG-4 FAPs as text), with or without a header,\n"
    "and .fapc (the same at a few kilobits a second). Which of them FILE is shows in its first bytes.\n"
    "\n"
    "  info     version, name, rate, length, what each FAP does, and what it costs coded\n"
    "  convert  writes version 2.1 with a header, at another rate if wanted (1 to 1000)\n"
    "  encode   to .fapc; quality 0 keeps every value, 31 is the coarsest (5)\n"
    "  decode   to .fap\n"
    "  plot     draws FAPs over time as SVG: LIST has names or numbers with commas\n"
    "           (the eight that move most); S are seconds\n"
    "FILE - is standard input, OUT - or none standard output. Exit status: 0 done, 1 failed, 2 wrong "
    "usage.\n";

static double kilobits(const struct fapfile *face, int quality) {
    struct buf out = {0};
    double seconds = (double)face->count / face->fps;
    double rate = fap_file_code(face, quality, &out) ? -1 : (double)out.size * 8 / 1000 / seconds;
    buf_free(&out);
    return rate;
}

static void print_fap(const struct fapfile *face, int n) {
    size_t count = 0;
    int32_t least = INT32_MAX, most = INT32_MIN;
    double sum = 0;
    for (size_t k = 0; k < face->count; k++)
        if (fap_frame_has(&face->frames[k], n)) {
            int32_t value = face->frames[k].value[n];
            least = value < least ? value : least;
            most = value > most ? value : most;
            sum += value;
            count++;
        }
    if (!count)
        return;
    if (n <= 2)
        printf("%3d  %-24s %8zu\n", n, fap_table[n].name, count);
    else
        printf("%3d  %-24s %8zu %8ld %8ld %10.1f\n", n, fap_table[n].name, count, (long)least, (long)most,
               sum / (double)count);
}

static int info_of(const char *path) {
    struct fap_file file;
    if (fap_file_read(path, &file))
        return EXIT_FAILED;
    const struct fapfile *face = &file.face;
    bool text = !strcmp(file.format, "fap");
    printf("file      %s\nformat    %s\n", path, file.format);
    if (text)
        printf("version   %s\nname      %s\n", *face->version ? face->version : "(no header)",
               *face->name ? face->name : "(none)");
    printf("fps       %.10g\nframes    %zu\nduration  %.3f s\nbytes     %zu\n", face->fps, face->count,
           (double)face->count / face->fps, file.bytes);
    if (face->count) {
        printf("as it is  %.2f kbit/s\n", (double)file.bytes * 8 / 1000 / ((double)face->count / face->fps));
        static const int qualities[] = {FAPC_QUALITY, FAPC_QUALITY_LOSSLESS};
        for (int i = 0; i < 2; i++) {
            double rate = kilobits(face, qualities[i]);
            if (rate < 0)
                printf("coded     - (quality %d: too much at once)\n", qualities[i]);
            else
                printf("coded     %.2f kbit/s (quality %d%s)\n", rate, qualities[i],
                       qualities[i] ? "" : ", nothing lost");
        }
        printf("FAP  name                       frames      min      max       mean\n");
        for (int n = 1; n <= FAP_COUNT; n++)
            print_fap(face, n);
    }
    fap_file_free(&file);
    return EXIT_DONE;
}

static int info(int argc, char **argv) {
    if (argc < 2) {
        cli_complain("info: no file");
        return EXIT_USAGE;
    }
    int status = EXIT_DONE;
    for (int i = 1; i < argc; i++) {
        if (i > 1)
            putchar('\n');
        if (info_of(argv[i]))
            status = EXIT_FAILED;
    }
    return status;
}

int fap_main(int argc, char **argv, const struct settings *settings) {
    (void)settings;
    static const struct {
        const char *name;
        int (*run)(int argc, char **argv);
    } commands[] = {{"info", info},
                    {"convert", fap_convert},
                    {"encode", fap_encode},
                    {"decode", fap_decode},
                    {"plot", fap_plot}};
    const char *name = argc > 1 ? argv[1] : "";
    for (int i = 1; i < argc; i++)
        if (!strcmp(argv[i], "--help") || !strcmp(argv[i], "-h")) {
            fputs(usage, stdout);
            return EXIT_DONE;
        }
    for (size_t i = 0; i < sizeof commands / sizeof *commands; i++)
        if (!strcmp(commands[i].name, name))
            return commands[i].run(argc - 1, argv + 1);
    if (*name)
        cli_complain("fap: no command '%s'", name);
    fputs(usage, stderr);
    return EXIT_USAGE;
}
