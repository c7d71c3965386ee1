/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/app/settings.h"
#include "server/app/settings_internal.h"
#include "server/base/mem.h"
#include <getopt.h>
#include <stdlib.h>
#include <string.h>

void settings_free(struct settings *s) {
    for (size_t i = 0; i < settings_count; i++)
        setting_clear(s, &settings_table[i]);
    if (s->before)
        settings_free(s->before);
    free(s->before);
    s->before = NULL;
}

void settings_follow(struct settings *s, const struct settings *before) {
    s->before = mem_alloc(sizeof *before);
    *s->before = *before;
}

static void set_defaults(struct settings *s, const struct paths *paths) {
    struct error e;
    for (size_t i = 0; i < settings_count; i++)
        if (settings_table[i].value)
            setting_from_text(s, &settings_table[i], settings_table[i].value, "", &e);
    s->models = mem_strdup(paths->models);
    s->api.web = mem_strdup(paths->web);
    s->voices.plugin_dir = mem_strdup(paths->plugins);
    s->voices.worker = mem_strdup(paths->worker);
}

/* FACCIA_MAX_TEXT for --max-text. */
static const char *variable(const struct setting *setting, char out[64]) {
    snprintf(out, 64, "FACCIA_%s", setting->option);
    for (char *c = out; *c; c++)
        *c = *c == '-' ? '_' : *c >= 'a' && *c <= 'z' ? (char)(*c - 'a' + 'A') : *c;
    return out;
}

static int from_environment(struct settings *s, enum program program, struct error *e) {
    char name[64];
    const char *old = getenv("FACCIA_TOKEN_FILE");
    if (program == PROGRAM_DAEMON && old && *old)
        return setting_was_renamed("FACCIA_TOKEN_FILE", e);
    for (size_t i = 0; i < settings_count; i++) {
        if (!setting_is_of(program, &settings_table[i]))
            continue;
        const char *value = getenv(variable(&settings_table[i], name));
        if (value && *value && setting_from_text(s, &settings_table[i], value, name, e))
            return -1;
    }
    return 0;
}

/* What getopt_long returns for an option; none is a character, as 'h' and '?' (an unknown option) are. */
enum {
    OPTION_HELP = 1000,
    OPTION_VERSION,
    OPTION_PRINT,
    OPTION_SCHEMA,
    OPTION_CONFIG,
    OPTION_RENAMED,
    OPTION_SETTING /* the first of the table; the others follow */
};

static const char *name_of(enum program program) {
    static const char *const names[] = {
        [PROGRAM_DAEMON] = "facciad", [PROGRAM_COMMANDS] = "faccia", [PROGRAM_WORKER] = "faccia-worker"};
    return names[program];
}

static int read_options(struct settings *s, struct settings_request *request, enum program program, int argc,
                        char **argv, bool only_request, struct error *e) {
    struct option options[SETTINGS_MAX + 7] = {
        {"help", 0, NULL, OPTION_HELP},
        {"version", 0, NULL, OPTION_VERSION},
        {"config", 1, NULL, OPTION_CONFIG},
    };
    size_t count = 3;
    if (program == PROGRAM_DAEMON) {
        options[count++] = (struct option){"print-config", 0, NULL, OPTION_PRINT};
        options[count++] = (struct option){"print-schema", 0, NULL, OPTION_SCHEMA};
        options[count++] = (struct option){"token-file", 1, NULL, OPTION_RENAMED};
    }
    for (size_t i = 0; i < settings_count; i++) {
        const struct setting *setting = &settings_table[i];
        if (setting_is_of(program, setting))
            options[count++] = (struct option){setting->option, setting->type != SETTING_FLAG, NULL,
                                               OPTION_SETTING + (int)i};
    }
    bool listed[SETTINGS_MAX] = {false};
    char name[64];
    optind = 0; /* begin anew: one may have been at it, in another order */
    opterr = !only_request;
    for (int c;
         (c = getopt_long(argc, argv, program == PROGRAM_COMMANDS ? "+h" : "h", options, NULL)) != -1;) {
        if (c == 'h' || c == OPTION_HELP)
            request->help = true;
        else if (c == OPTION_VERSION)
            request->version = true;
        else if (c == OPTION_PRINT)
            request->print = true;
        else if (c == OPTION_SCHEMA)
            request->schema = true;
        else if (c == OPTION_CONFIG)
            request->file = optarg;
        else if (c == '?')
            return error_set(e, ERROR_BAD_OPTION, "try '%s --help'", name_of(program));
        else if (c == OPTION_RENAMED && !only_request)
            return setting_was_renamed("--token-file", e);
        else if (!only_request) {
            const int number = c - OPTION_SETTING;
            const struct setting *setting = &settings_table[number];
            snprintf(name, sizeof name, "--%s", setting->option);
            if (setting->type == SETTING_LIST && !listed[number])
                setting_clear(s, setting);
            listed[number] = true;
            if (setting_from_text(s, setting, setting->type == SETTING_FLAG ? "true" : optarg, name, e))
                return -1;
        }
    }
    request->rest = optind;
    if (optind < argc && program != PROGRAM_COMMANDS)
        return error_set(e, ERROR_BAD_OPTION, "unexpected '%s'; try '%s --help'", argv[optind],
                         name_of(program));
    return 0;
}

int settings_read(struct settings *s, struct settings_request *request, enum program program, int argc,
                  char **argv, const struct paths *paths, struct error *e) {
    *s = (struct settings){0};
    *request = (struct settings_request){.file = getenv("FACCIA_CONFIG")};
    set_defaults(s, paths);
    /* The file is read first, so its name is looked for before all else; what is wrong is told later. */
    (void)read_options(s, request, program, argc, argv, true, e);
    if (request->help || request->version)
        return 0;
    if (request->file && *request->file && settings_from_file(s, program, request->file, e))
        return -1;
    if (from_environment(s, program, e))
        return -1;
    return read_options(s, request, program, argc, argv, false, e);
}

bool settings_need_restart(const struct settings *old, const struct settings *now) {
    static const char *const groups[] = {"listen.", "speech.", "voices.", "library.", "paths.", "cluster."};
    json_t *a = json_object(), *b = json_object();
    for (size_t i = 0; i < settings_count; i++)
        for (size_t g = 0; g < sizeof groups / sizeof *groups; g++)
            if (!strncmp(settings_table[i].path, groups[g], strlen(groups[g]))) {
                setting_to_json(old, &settings_table[i], a);
                setting_to_json(now, &settings_table[i], b);
            }
    bool differ = !json_equal(a, b);
    json_decref(a);
    json_decref(b);
    return differ;
}

enum log_format settings_log_format(const struct settings *s) {
    return s->log_format ? LOG_JSON : getenv("JOURNAL_STREAM") ? LOG_JOURNAL : LOG_TEXT;
}

char *settings_cache_folder(void) {
    static const char *const names[] = {"CACHE_DIRECTORY", "XDG_CACHE_HOME"};
    const char *home = getenv("HOME");
    struct buf path = {0};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        const char *folder = getenv(names[i]);
        if (folder && *folder == '/')
            return mem_strndup(folder, strcspn(folder, ":"));
    }
    if (!home || *home != '/')
        return NULL;
    buf_printf(&path, "%s/.cache", home);
    buf_add(&path, "", 1);
    return (char *)path.data;
}

void settings_print(const struct settings *s, struct buf *out) {
    json_t *root = json_object();
    for (size_t i = 0; i < settings_count; i++)
        setting_to_json(s, &settings_table[i], root);
    char *text = json_dumps(root, JSON_INDENT(2) | JSON_REAL_PRECISION(12));
    json_t *again = json_loads(text, 0, NULL);
    if (!json_equal(root, again)) { /* a number has more digits than people write */
        free(text);
        text = json_dumps(root, JSON_INDENT(2));
    }
    json_decref(again);
    buf_printf(out, "%s\n", text);
    free(text);
    json_decref(root);
}

void settings_help(enum program program, struct buf *out) {
    char name[64], option[64];
    buf_printf(out, "      --config FILE            settings as JSON; the members stand in brackets below\n");
    if (program == PROGRAM_DAEMON)
        buf_printf(out,
                   "      --print-config           print the settings in force as such a file, and exit\n"
                   "      --print-schema           print the JSON Schema of such a file, and exit\n");
    buf_printf(out, "  -h, --help                   print this and exit\n"
                    "      --version                print the version and exit\n\n");
    for (size_t i = 0; i < settings_count; i++) {
        const struct setting *setting = &settings_table[i];
        if (!setting_is_of(program, setting))
            continue;
        snprintf(option, sizeof option, "--%s%s%s", setting->option, setting->shape ? " " : "",
                 setting->shape ? setting->shape : "");
        buf_printf(out, "      %-24s %s", option, setting->help);
        if (setting->max > 0)
            buf_printf(out, ", %.12g to %.12g", setting->min, setting->max);
        if (setting->value && *setting->value && setting->type != SETTING_FLAG)
            buf_printf(out, " (%s)", setting->value);
        buf_printf(out, " [%s]\n", setting->path);
    }
    const struct setting *example = &settings_table[1];
    while (!setting_is_of(program, example))
        example++;
    buf_printf(
        out,
        "\nEvery such option can also be given in the environment, as %s for --%s, and so on; the file "
        "is\n"
        "$FACCIA_CONFIG. Options override the environment, which overrides the file.\n",
        variable(example, name), example->option);
}
