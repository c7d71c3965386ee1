/* SPDX-License-Identifier: GPL-3.0-or-later */
/* faccia voices, faccia models. */
#include "server/base/mem.h"
#include "server/base/options.h"
#include "server/cli/cli.h"
#include <glob.h>
#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>

/* Both lists take --json and --help; voices also takes --lang and --model. Returns an exit code, or -1 to
 * continue. */
static int parse(int argc, char **argv, const char *usage, const char **lang, const char **model,
                 bool *json) {
    static const struct option options[] = {
        {"json", 0, NULL, 'j'}, {"help", 0, NULL, 'h'}, {"lang", 1, NULL, 'l'}, {"model", 1, NULL, 'm'}, {0}};
    for (int c; (c = options_next(argc, argv, "hl:", options, NULL)) != -1;) {
        if (c == 'h') {
            fputs(usage, stdout);
            return EXIT_DONE;
        }
        if (c == '?' || (c == 'l' && !lang) || (c == 'm' && !model)) {
            fputs(usage, stderr);
            return EXIT_USAGE;
        }
        if (c == 'l')
            *lang = optarg;
        else if (c == 'm')
            *model = optarg;
        else
            *json = true;
    }
    if (optind < argc) {
        cli_complain("unexpected '%s'", argv[optind]);
        return EXIT_USAGE;
    }
    return -1;
}

static bool matches(const char *tag, const char *wanted) {
    size_t length = strlen(wanted);
    return !strncasecmp(tag, wanted, length) && (!tag[length] || tag[length] == '-');
}

static int print_json(json_t *list, const char *name) {
    json_t *object = json_pack("{so}", name, list);
    json_dumpf(object, stdout, JSON_INDENT(1));
    putchar('\n');
    json_decref(object);
    return EXIT_DONE;
}

/* Gender of the voices that suit a head: "" for any, NULL if the head is unknown. Free it. */
static char *gender_of(const char *models, const char *model) {
    char file[4096];
    json_error_t why;
    snprintf(file, sizeof file, "%s/heads/%s.json", models, model);
    json_t *head = strchr(model, '/') ? NULL : json_load_file(file, 0, &why);
    const char *gender = json_string_value(json_object_get(json_object_get(head, "voice"), "gender"));
    char *copy = head ? mem_strdup(gender ? gender : "") : NULL;
    json_decref(head);
    if (!head)
        cli_complain("unknown head model '%s'", model);
    return copy;
}

int voices_main(int argc, char **argv, const struct settings *settings) {
    static const char usage[] = "Usage: faccia voices [--lang TAG] [--model NAME] [--json]\n"
                                "Lists the voices: id, language, gender, quality, name.\n"
                                "With a model, only the voices that suit that head.\n";
    const char *lang = NULL, *model = NULL;
    bool json = false;
    int status = parse(argc, argv, usage, &lang, &model, &json);
    struct cli cli;
    if (status >= 0)
        return status;
    char *gender = model ? gender_of(settings->models, model) : NULL;
    if (model && !gender)
        return EXIT_FAILED;
    status = cli_open(&cli, settings) ? EXIT_FAILED : EXIT_DONE;
    size_t count = 0;
    const struct voice *v = status ? NULL : voice_pool_voices(cli.components.pipeline.voices, &count);
    json_t *list = json_array();
    for (size_t i = 0; i < count; i++) {
        if ((lang && !matches(v[i].lang, lang)) || (gender && *gender && strcmp(v[i].gender, gender)))
            continue;
        if (json)
            json_array_append_new(list,
                                  json_pack("{ss ss ss ss ss ss ss}", "id", v[i].id, "name", v[i].name,
                                            "lang", v[i].lang, "gender", v[i].gender, "quality", v[i].quality,
                                            "licence", v[i].licence, "plugin", v[i].plugin));
        else
            printf("%-24s %-10s %-8s %-9s %s\n", v[i].id, v[i].lang, v[i].gender, v[i].quality, v[i].name);
    }
    if (json && !status)
        print_json(list, "voices");
    else
        json_decref(list);
    cli_close(&cli);
    free(gender);
    return status;
}

int models_main(int argc, char **argv, const struct settings *settings) {
    static const char usage[] = "Usage: faccia models [--json]\nLists the head models: name, bytes, title.\n";
    bool json = false;
    int status = parse(argc, argv, usage, NULL, NULL, &json);
    if (status >= 0)
        return status;
    char pattern[4096];
    glob_t found;
    snprintf(pattern, sizeof pattern, "%s/heads/*.json", settings->models);
    json_t *list = json_array();
    if (!glob(pattern, 0, NULL, &found)) {
        for (size_t i = 0; i < found.gl_pathc; i++) {
            struct stat info;
            json_error_t why;
            json_t *head = json_load_file(found.gl_pathv[i], 0, &why);
            const char *name = json_string_value(json_object_get(head, "name"));
            const char *title = json_string_value(json_object_get(head, "title"));
            stat(found.gl_pathv[i], &info);
            if (name)
                json_array_append_new(list,
                                      json_pack("{ss ss sI}", "name", name, "title", title ? title : name,
                                                "bytes", (json_int_t)info.st_size));
            else
                cli_complain("%s: %s", found.gl_pathv[i], head ? "not a head model" : why.text);
            json_decref(head);
        }
        globfree(&found);
    }
    size_t i;
    json_t *model;
    if (json)
        return print_json(list, "models");
    json_array_foreach(list, i, model) {
        printf("%-12s %9lld  %s\n", json_string_value(json_object_get(model, "name")),
               (long long)json_integer_value(json_object_get(model, "bytes")),
               json_string_value(json_object_get(model, "title")));
    }
    json_decref(list);
    return EXIT_DONE;
}
