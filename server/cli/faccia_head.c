/* SPDX-License-Identifier: GPL-3.0-or-later */
/* faccia head: imports, exports and rigs heads. `export` copies the avatars that the build made with
 * models/tools/avatar/export-head.mjs; `lips` runs models/tools/lips/faccia-lips.mjs, the rest
 * models/tools/import/faccia-head.mjs, in Node.js. */
#include "server/base/options.h"
#include "server/cli/cli.h"
#include <errno.h>
#include <stdio.h>
#include <string.h>

static const char usage[] = "Usage: faccia head export NAME [--glb FILE] [--vrm FILE]\n"
                            "Writes a head listed by 'faccia models' as an avatar for other programs, in the "
                            "public domain (CC0): ARKit's 52 shapes and 15\n"
                            "visemes as morph targets, bones, and the expressions of VRM 1.0. Both options "
                            "write the same data: a VRM is a GLB.\n"
                            "\n"
                            "      --glb FILE       the avatar (standard output if no option is given)\n"
                            "      --vrm FILE       the avatar with the file name that VRM programs expect\n"
                            "  -h, --help           print this and exit\n"
                            "FILE - is standard output. Exit status: 0 done, 1 failed, 2 wrong usage.\n"
                            "\n"
                            "faccia head import FILE, calibrate HEAD.json, points HEAD.json, fdp HEAD.json, "
                            "check HEAD.json: imports and checks heads, and writes\n"
                            "them as MPEG-4's FDP node with an animation table; needs Node.js (18 or later). "
                            "See 'faccia head import --help'.\n"
                            "faccia head lips TRACKS: measures a speaker's lips in a video, for 'faccia "
                            "fit'. See 'faccia head lips --help'.\n"
                            "To make heads (portrait/make-portrait.mjs) and picture sets "
                            "(pictures/make-set.mjs) from photographs, see models/tools in the sources.\n";

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
        cli_complain("unknown head model '%s', or no avatar beside it (%s/heads)", name, settings->models);
        return EXIT_FAILED;
    }
    for (int i = 0; i < 2 && !status; i++)
        if (paths[i])
            status = copy(avatar, paths[i]);
    fclose(avatar);
    return status;
}

static bool is_of_tool(const char *word) {
    static const char *const tools[] = {"import", "calibrate", "points", "fdp", "check", "lips"};
    for (size_t i = 0; i < sizeof tools / sizeof *tools; i++)
        if (!strcmp(word, tools[i]))
            return true;
    return false;
}

int head_main(int argc, char **argv, const struct settings *settings) {
    static const struct option options[] = {
        {"glb", 1, NULL, 0}, {"vrm", 1, NULL, 1}, {"help", 0, NULL, 'h'}, {0}};
    const char *paths[2] = {NULL, NULL};
    if (argc > 1 && is_of_tool(argv[1])) {
        bool lips = !strcmp(argv[1], "lips");
        return cli_run_tool(settings, lips ? "lips/faccia-lips" : "import/faccia-head", "head",
                            argc - 1 - lips, argv + 1 + lips);
    }
    for (int c; (c = options_next(argc, argv, "h", options, NULL)) != -1;) {
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
            "expected 'export' and the name of one head; or import, calibrate, points, fdp, check, lips: "
            "see 'faccia head --help'");
        return EXIT_USAGE;
    }
    if (!paths[0] && !paths[1])
        paths[0] = "-";
    return write_avatar(settings, argv[optind + 1], paths);
}
