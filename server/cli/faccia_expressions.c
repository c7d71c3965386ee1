/* SPDX-License-Identifier: GPL-3.0-or-later */
/* faccia expressions: lists the expressions and shows their FAPs. */
#include "protocol/fapfile.h"
#include "server/base/options.h"
#include "server/cli/cli.h"
#include "server/expression/expressions.h"
#include "server/face/expression/expression_layer.h"
#include <errno.h>
#include <jansson.h>
#include <stdlib.h>
#include <string.h>

static const char usage[] =
    "Usage: faccia expressions [--kind KIND] [--json]\n"
    "       faccia expressions --fap [KIND:]NAME[=INTENSITY]...\n"
    "Lists the expressions: kind, name, and for affects the position on the emotion disc (activation,\n"
    "evaluation, -1 to 1).\n"
    "\n"
    "  -k, --kind KIND   only expressions of this kind: affect, performative, certainty...\n"
    "      --json        as JSON\n"
    "      --fap WHAT    write expressions as MPEG-4 FAPs (text, version 2.1), one frame for each\n"
    "                    expression, held at INTENSITY 0 to 1 (1); the default KIND is 'affect'\n";

enum { FPS = 25 };

struct asked {
    const char *kind;
    bool json;
    char **wishes;
    int wish_count;
};

static int list(const struct expressions *all, const struct asked *asked) {
    json_t *out = json_array();
    size_t found = 0;
    for (size_t i = 0; i < expressions_count(all); i++) {
        struct expression_info x = expressions_info(all, i);
        if (asked->kind && strcmp(asked->kind, x.kind) != 0)
            continue;
        found++;
        json_array_append_new(out, json_pack("{ss ss sf sf sb}", "kind", x.kind, "name", x.name, "activation",
                                             x.activation, "evaluation", x.evaluation, "basic", x.basic));
        if (asked->json)
            continue;
        if (strcmp(x.kind, "affect") != 0)
            printf("%-16s %s\n", x.kind, x.name);
        else
            printf("%-16s %-16s %5.2f %5.2f%s\n", x.kind, x.name, x.activation, x.evaluation,
                   x.basic ? "  basic" : "");
    }
    json_t *object = json_pack("{so}", "expressions", out);
    if (asked->json) {
        json_dumpf(object, stdout, JSON_INDENT(1) | JSON_REAL_PRECISION(6));
        putchar('\n');
    }
    json_decref(object);
    if (found)
        return EXIT_DONE;
    cli_complain("no expressions of kind '%s'", asked->kind);
    return EXIT_USAGE;
}

int cli_pose(const struct expressions *all, const char *option, const char *wish, struct fap_frame *frame) {
    char kind[64] = "affect", name[128];
    double intensity = 1;
    const char *colon = strchr(wish, ':'), *equals = strrchr(wish, '=');
    const char *begin = colon && (!equals || colon < equals) ? colon + 1 : wish;
    if (begin != wish)
        snprintf(kind, sizeof kind, "%.*s", (int)(colon - wish), wish);
    snprintf(name, sizeof name, "%.*s", (int)(equals ? (size_t)(equals - begin) : strlen(begin)), begin);
    if (equals) {
        char *end;
        intensity = strtod(equals + 1, &end);
        if (end == equals + 1 || *end || !(intensity >= 0 && intensity <= 1)) {
            cli_complain("%s %s: the intensity must be a number from 0 to 1", option, wish);
            return -1;
        }
    }
    int found = expressions_find(all, kind, name);
    if (found < 0) {
        cli_complain("%s %s: unknown %s '%s'", option, wish, kind, name);
        return -1;
    }
    still_expression(all, (size_t)found, intensity, frame);
    return 0;
}

static int write_poses(const struct expressions *all, const struct asked *asked) {
    struct fap_frame *frames = calloc((size_t)asked->wish_count, sizeof *frames);
    char text[4096];
    int result = EXIT_DONE;
    for (int i = 0; i < asked->wish_count && result == EXIT_DONE; i++)
        if (!frames || cli_pose(all, "--fap", asked->wishes[i], &frames[i]))
            result = EXIT_USAGE;
    if (result == EXIT_DONE) {
        fapfile_write_header("faccia", FPS, (size_t)asked->wish_count, text, sizeof text);
        fputs(text, stdout);
        for (int i = 0; i < asked->wish_count; i++) {
            fapfile_write_frame(&frames[i], (size_t)i, text, sizeof text);
            fputs(text, stdout);
        }
    }
    free(frames);
    if (fflush(stdout)) {
        cli_complain("standard output: %s", strerror(errno));
        return EXIT_FAILED;
    }
    return result;
}

/* Returns an exit code, or -1 to continue. */
static int parse(int argc, char **argv, struct asked *asked) {
    static const struct option options[] = {
        {"kind", 1, NULL, 'k'}, {"json", 0, NULL, 'j'}, {"fap", 1, NULL, 'f'}, {"help", 0, NULL, 'h'}, {0}};
    for (int c; (c = options_next(argc, argv, "k:h", options, NULL)) != -1;) {
        switch (c) {
        case 'k':
            asked->kind = optarg;
            break;
        case 'j':
            asked->json = true;
            break;
        case 'f':
            asked->wishes[asked->wish_count++] = optarg;
            break;
        case 'h':
            fputs(usage, stdout);
            return EXIT_DONE;
        default:
            fputs(usage, stderr);
            return EXIT_USAGE;
        }
    }
    /* "--fap joy fear anger": the option takes all words up to the next option. */
    for (; optind < argc && asked->wish_count; optind++)
        asked->wishes[asked->wish_count++] = argv[optind];
    if (optind < argc) {
        cli_complain("unexpected '%s'", argv[optind]);
        return EXIT_USAGE;
    }
    return -1;
}

int expressions_main(int argc, char **argv, const struct settings *settings) {
    struct asked asked = {.wishes = calloc((size_t)argc + 1, sizeof *asked.wishes)};
    int result = asked.wishes ? parse(argc, argv, &asked) : EXIT_FAILED;
    if (result < 0) {
        struct components components;
        result = cli_load(&components, settings, COMPONENTS_EXPRESSIONS, NULL) ? EXIT_FAILED
                 : asked.wish_count ? write_poses(components.pipeline.expressions, &asked)
                                    : list(components.pipeline.expressions, &asked);
        components_free(&components);
    }
    free(asked.wishes);
    return result;
}
