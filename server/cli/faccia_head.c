/* SPDX-License-Identifier: GPL-3.0-or-later */
/* faccia head: imports, exports and rigs heads. `export` copies the avatars that the build made with
 * models/tools/avatar/export-head.mjs; `lips` runs models/tools/lips/faccia-lips.mjs, the rest
 * models/tools/import/faccia-head.mjs, in Node.js. */
#include "server/base/program.h"
#include "server/cli/cli.h"
#include <errno.h>
#include <getopt.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

static const char usage[] =
    "Usage: faccia head export NAME [--glb FILE] [--vrm FILE]\n"
    "Writes a head that 'faccia models' lists as an avatar for other programs, in "
    "the public domain (CC0): ARKit's "
    "52 shapes and 15\n"
    "visemes as morph targets, bones, the expressions of VRM 1.0. Both options write "
    "the same: a VRM is a GLB.\n"
    "\n"
    "      --glb FILE       the avatar (standard output when nothing is named)\n"
    "      --vrm FILE       under the name that VRM's programs look for\n"
    "  -h, --help           print this and exit\n"
    "FILE - is standard output. Exit status: 0 done, 1 failed, 2 wrong usage.\n"
    "\n"
    "faccia head import FILE, calibrate HEAD.json, points HEAD.json, check HEAD.json: "
    "heads of other origin; needs Node.js\n"
    "(18 or later). 'faccia head import --help' tells more.\n"
    "faccia head lips TRACKS: how somebody's lips moved, for 'faccia fit'. 'faccia head lips --help' tells "
    "more.\n"
    "Of photographs, models/tools of the sources makes heads (portrait/make-portrait.mjs) and sets of "
    "pictures "
    "(pictures/make-set.mjs).\n";

static int copy(FILE *avatar, const char *path) {
    struct cli_file file = {0};
    char block[65536];
    bool well = true;
    if (cli_create(&file, path))
        return EXIT_FAILED;
    rewind(avatar);
    for (size_t got; well && (got = fread(block, 1, sizeof block, avatar)) > 0;)
        well = fwrite(block, 1, got, file.file) == got;
    if (!well)
        cli_complain("%s: %s", path, strerror(errno));
    return cli_finish(&file, well && !ferror(avatar)) ? EXIT_FAILED : EXIT_DONE;
}

static int write_avatar(const struct settings *settings, const char *name, const char *const paths[2]) {
    char file[4096];
    int status = EXIT_DONE;
    snprintf(file, sizeof file, "%s/heads/%s.glb", settings->models, name);
    FILE *avatar = strchr(name, '/') ? NULL : fopen(file, "rb");
    if (!avatar) {
        cli_complain("no head model '%s', or no avatar beside it (%s/heads)", name, settings->models);
        return EXIT_FAILED;
    }
    for (int i = 0; i < 2 && !status; i++)
        if (paths[i])
            status = copy(avatar, paths[i]);
    fclose(avatar);
    return status;
}

enum { WORDS = 64 };

/* Replaces this process by the Node.js tool. */
static int run_tool(int argc, char **argv, const struct settings *settings) {
    char tool[4096], node[] = "node";
    char *words[WORDS + 3] = {node, tool};
    bool lips = !strcmp(argv[1], "lips");
    snprintf(tool, sizeof tool, "%s/tools/%s.mjs", settings->models,
             lips ? "lips/faccia-lips" : "import/faccia-head");
    if (argc - 1 > WORDS) {
        cli_complain("more than %d words for 'head %s'", WORDS, argv[1]);
        return EXIT_USAGE;
    }
    if (access(tool, R_OK)) {
        cli_complain("%s: %s; it is made while building, where Node.js is", tool, strerror(errno));
        return EXIT_FAILED;
    }
    memcpy(words + 2, argv + 1 + lips, sizeof *argv * (size_t)(argc - 1 - lips));
    program_give_back_signals();
    execvp(words[0], words);
    cli_complain("'head %s' needs Node.js, 18 or later: node: %s", argv[1], strerror(errno));
    return EXIT_FAILED;
}

static bool is_of_tool(const char *word) {
    static const char *const tools[] = {"import", "calibrate", "points", "check", "lips"};
    for (size_t i = 0; i < sizeof tools / sizeof *tools; i++)
        if (!strcmp(word, tools[i]))
            return true;
    return false;
}

int head_main(int argc, char **argv, const struct settings *settings) {
    static const struct option options[] = {
        {"glb", 1, NULL, 0}, {"vrm", 1, NULL, 1}, {"help", 0, NULL, 'h'}, {0}};
    const char *paths[2] = {NULL, NULL};
    if (argc > 1 && is_of_tool(argv[1]))
        return run_tool(argc, argv, settings);
    for (int c; (c = getopt_long(argc, argv, "h", options, NULL)) != -1;) {
        if (c == 'h') {
            fputs(usage, stdout);
            return EXIT_DONE;
        }
        if (c == '?') {
            fputs("Try 'faccia head --help'.\n", stderr);
            return EXIT_USAGE;
        }
        paths[c] = optarg;
    }
    if (argc - optind != 2 || strcmp(argv[optind], "export") != 0) {
        cli_complain(
            "'export' is wanted, and the name of one head; or import, calibrate, points, check, lips: "
            "'faccia head --help' tells more");
        return EXIT_USAGE;
    }
    if (!paths[0] && !paths[1])
        paths[0] = "-";
    return write_avatar(settings, argv[optind + 1], paths);
}
