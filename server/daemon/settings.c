/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/daemon/settings.h"
#include "server/base/lang.h"
#include "server/base/mem.h"
#include "server/base/options.h"
#include "server/base/suggest.h"
#include "server/daemon/settings_internal.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

/* A worker needs the settings of voices. */
static bool is_of_worker(const char *path) {
    static const char *const others[] = {"voices.boundaries", "voices.cache_megabytes", "voices.cache_file",
                                         "voices.cache_file_megabytes"};
    static const char *const own[] = {"cluster.address", "limits.stop_seconds", "log.format", "paths.plugins",
                                      "paths.worker"};
    for (size_t i = 0; i < sizeof others / sizeof *others; i++)
        if (!strcmp(path, others[i]))
            return false;
    for (size_t i = 0; i < sizeof own / sizeof *own; i++)
        if (!strcmp(path, own[i]))
            return true;
    return !strncmp(path, "voices.", strlen("voices."));
}

/* Rejects the former name --token-file, and names the new one. -1. name: the setting as written. */
static int setting_was_renamed(const char *name, struct error *e) {
    return error_in_field(
        e, ERROR_BAD_FIELD, name,
        "--secret-file (FACCIA_SECRET_FILE, access.secret_file) names the file of secrets that sign tokens; "
        "--token-file, an option of the bridges, names a file that contains a token");
}

/* True when the setting applies to the program. */
static bool setting_is_of(enum program program, const struct setting *setting) {
    return program == PROGRAM_DAEMON ||
           (program == PROGRAM_WORKER ? is_of_worker(setting->path) : setting->program == FOR_BOTH);
}

static void *place(const struct settings *s, const struct setting *setting) {
    return (char *)s + setting->offset;
}

/* Strings and lists are stored in members of different const-ness. */
static void *pointer_of(const struct settings *s, const struct setting *setting) {
    void *pointer;
    memcpy(&pointer, place(s, setting), sizeof pointer);
    return pointer;
}

static void set_pointer(struct settings *s, const struct setting *setting, void *pointer) {
    memcpy(place(s, setting), &pointer, sizeof pointer);
}

static bool is_text(const struct setting *setting) {
    return setting->type == SETTING_STRING || setting->type == SETTING_FOLDER ||
           setting->type == SETTING_OBJECT;
}

static void setting_clear(struct settings *s, const struct setting *setting) {
    if (!is_text(setting) && setting->type != SETTING_LIST)
        return;
    char **list = setting->type == SETTING_LIST ? pointer_of(s, setting) : NULL;
    for (char **item = list; item && *item; item++)
        free(*item);
    free(pointer_of(s, setting));
    set_pointer(s, setting, NULL);
}

static void add_to_list(struct settings *s, const struct setting *setting, const char *text, size_t size) {
    char **list = pointer_of(s, setting);
    size_t count = 0;
    while (list && list[count])
        count++;
    list = mem_resize(list, (count + 2) * sizeof *list);
    list[count] = mem_strndup(text, size);
    list[count + 1] = NULL;
    set_pointer(s, setting, list);
}

static void set_text(struct settings *s, const struct setting *setting, char *text) {
    free(pointer_of(s, setting));
    set_pointer(s, setting, text);
}

bool setting_is_tag(const struct setting *setting) {
    return setting->type == SETTING_STRING && setting->shape && !strcmp(setting->shape, "TAG");
}

static int set_string(struct settings *s, const struct setting *setting, const char *text, const char *name,
                      struct error *e) {
    char tag[LANG_BYTES + 1];
    size_t bad;
    if (setting_is_tag(setting)) {
        if (!lang_read(text, strlen(text), tag, &bad))
            return error_in_field(
                e, ERROR_BAD_FIELD, name,
                "'%.100s' is not a language tag (BCP 47, such as pt-BR): byte %zu is invalid", text, bad);
        text = tag;
    }
    set_text(s, setting, mem_strdup(text));
    return 0;
}

static int set_number(struct settings *s, const struct setting *setting, double value, const char *shown,
                      const char *name, struct error *e) {
    bool whole = setting->type != SETTING_REAL;
    if (!(value >= setting->min && value <= setting->max) || (whole && value != floor(value)))
        return error_in_field(e, ERROR_BAD_FIELD, name, "'%s' is not a%s number from %.12g to %.12g", shown,
                              whole ? " whole" : "", setting->min, setting->max);
    if (setting->type == SETTING_NUMBER)
        *(unsigned *)place(s, setting) = (unsigned)value;
    else if (setting->type == SETTING_MEGABYTES)
        *(uint64_t *)place(s, setting) = (uint64_t)value << 20;
    else
        *(double *)place(s, setting) = value;
    return 0;
}

/* Index of the word in a list separated by |, or -1. */
static int choice_of(const char *words, const char *text) {
    size_t length = strlen(text);
    int index = 0;
    for (size_t n; *words; words += n + (words[n] == '|'), index++)
        if ((n = strcspn(words, "|")) == length && !strncmp(words, text, n))
            return index;
    return -1;
}

static json_t *choice_at(const char *words, unsigned index) {
    for (; index; index--)
        words += strcspn(words, "|") + 1;
    return json_stringn(words, strcspn(words, "|"));
}

static bool is_folder(const char *path) {
    struct stat status;
    return !stat(path, &status) && S_ISDIR(status.st_mode);
}

static int check_object(const json_t *object, const char *name, struct error *e) {
    const char *key;
    json_t *value;
    if (!json_is_object(object))
        return error_in_field(e, ERROR_BAD_FIELD, name, "must be an object");
    json_object_foreach((json_t *)object, key, value) {
        char member[64];
        snprintf(member, sizeof member, "%s.%s", name, key);
        if (!json_is_object(value))
            return error_in_field(e, ERROR_BAD_FIELD, member, "must be an object: the plugin's own settings");
    }
    return 0;
}

static json_t *load_object(const char *file, enum error_code code, const char *name, struct error *e) {
    json_error_t why;
    json_t *object = json_load_file(file, JSON_REJECT_DUPLICATES, &why);
    if (!object && why.line > 0)
        error_in_field(e, code, name, "%s:%d:%d: %s", file, why.line, why.column, why.text);
    else if (!object)
        error_in_field(e, code, name, "%s", why.text);
    return object;
}

int setting_from_text(struct settings *s, const struct setting *setting, const char *text, const char *name,
                      struct error *e) {
    char *end;
    double value;
    int choice;
    switch (setting->type) {
    case SETTING_CHOICE:
        choice = choice_of(setting->shape, text);
        if (choice < 0)
            return error_in_field(e, ERROR_BAD_FIELD, name, "'%s' is not one of %s", text, setting->shape);
        *(unsigned *)place(s, setting) = (unsigned)choice;
        return 0;
    case SETTING_STRING:
    case SETTING_FOLDER:
        if (setting->type == SETTING_FOLDER && !is_folder(text))
            return error_in_field(e, ERROR_BAD_FIELD, name, "'%s' is not a folder", text);
        return set_string(s, setting, text, name, e);
    case SETTING_NUMBER:
    case SETTING_REAL:
    case SETTING_MEGABYTES:
        value = strtod(text, &end);
        return set_number(s, setting, end == text || *end ? NAN : value, text, name, e);
    case SETTING_FLAG:
        if (strcmp(text, "true") && strcmp(text, "false") && strcmp(text, "1") && strcmp(text, "0"))
            return error_in_field(e, ERROR_BAD_FIELD, name, "'%s' is not true or false", text);
        *(bool *)place(s, setting) = *text == 't' || *text == '1';
        return 0;
    case SETTING_LIST:
        for (size_t n; *text; text += n + (text[n] == ','))
            if ((n = strcspn(text, ",")))
                add_to_list(s, setting, text, n);
        return 0;
    case SETTING_OBJECT:
        break;
    }
    json_t *object = load_object(text, ERROR_BAD_VOICE_CONFIG, name, e);
    if (!object || check_object(object, name, e)) {
        json_decref(object);
        return -1;
    }
    set_text(s, setting, json_dumps(object, JSON_COMPACT));
    json_decref(object);
    return 0;
}

static int set_from_json(struct settings *s, const struct setting *setting, const json_t *value,
                         struct error *e) {
    const char *name = setting->path;
    size_t i;
    json_t *item;
    switch (setting->type) {
    case SETTING_STRING:
    case SETTING_FOLDER:
    case SETTING_CHOICE:
        if (!json_is_string(value))
            return error_in_field(e, ERROR_BAD_FIELD, name, "must be a string");
        return setting_from_text(s, setting, json_string_value(value), name, e);
    case SETTING_NUMBER:
    case SETTING_REAL:
    case SETTING_MEGABYTES:
        if (!json_is_number(value))
            return error_in_field(e, ERROR_BAD_FIELD, name, "must be a number from %.12g to %.12g",
                                  setting->min, setting->max);
        char shown[32];
        snprintf(shown, sizeof shown, "%.12g", json_number_value(value));
        return set_number(s, setting, json_number_value(value), shown, name, e);
    case SETTING_FLAG:
        if (!json_is_boolean(value))
            return error_in_field(e, ERROR_BAD_FIELD, name, "must be true or false");
        *(bool *)place(s, setting) = json_is_true(value);
        return 0;
    case SETTING_LIST:
        if (!json_is_array(value))
            return error_in_field(e, ERROR_BAD_FIELD, name, "must be a list of strings");
        setting_clear(s, setting);
        json_array_foreach((json_t *)value, i, item) {
            if (!json_is_string(item))
                return error_in_field(e, ERROR_BAD_FIELD, name, "item %zu must be a string", i);
            add_to_list(s, setting, json_string_value(item), json_string_length(item));
        }
        return 0;
    case SETTING_OBJECT:
        if (check_object(value, name, e))
            return -1;
        set_text(s, setting, json_dumps(value, JSON_COMPACT));
    }
    return 0;
}

static int set_member(struct settings *s, enum program program, const char *group, const char *key,
                      const json_t *value, struct error *e) {
    char path[64];
    snprintf(path, sizeof path, "%s.%s", group, key);
    for (size_t i = 0; i < settings_count; i++)
        if (!strcmp(settings_table[i].path, path))
            return json_is_null(value) || !setting_is_of(program, &settings_table[i])
                       ? 0
                       : set_from_json(s, &settings_table[i], value, e);
    if (!strcmp(path, "access.token_file"))
        return setting_was_renamed(path, e);
    struct suggestions near = suggestions_for(path);
    char text[SUGGESTIONS_TEXT];
    for (size_t i = 0; i < settings_count; i++) {
        suggest_name(&near, settings_table[i].path, settings_table[i].path);
        suggest_name(&near, settings_table[i].option, settings_table[i].path);
    }
    return error_in_field(e, ERROR_BAD_FIELD, path, "unknown setting%s", suggestions_text(&near, text));
}

int settings_from_file(struct settings *s, enum program program, const char *file, struct error *e) {
    const char *group, *key;
    json_t *members, *value, *root = load_object(file, ERROR_BAD_SETTINGS, "--config", e);
    int result = root ? 0 : -1;
    if (root && !json_is_object(root))
        result = error_in_field(e, ERROR_BAD_FIELD, "--config", "%s: must be an object", file);
    json_object_foreach(root, group, members) {
        if (!result && !json_is_object(members))
            result =
                error_in_field(e, ERROR_BAD_FIELD, group, "must be an object, as printed by --print-config");
        json_object_foreach(members, key, value) {
            if (!result)
                result = set_member(s, program, group, key, value, e);
        }
    }
    json_decref(root);
    return result;
}

static json_t *to_json(const struct settings *s, const struct setting *setting) {
    const void *at = place(s, setting);
    const char *text = is_text(setting) ? pointer_of(s, setting) : NULL;
    char **items;
    json_t *list;
    switch (setting->type) {
    case SETTING_STRING:
    case SETTING_FOLDER:
        return text ? json_string(text) : json_null();
    case SETTING_CHOICE:
        return choice_at(setting->shape, *(const unsigned *)at);
    case SETTING_NUMBER:
        return json_integer(*(const unsigned *)at);
    case SETTING_MEGABYTES:
        return json_integer((json_int_t)(*(const uint64_t *)at >> 20));
    case SETTING_REAL:
        return json_real(*(const double *)at);
    case SETTING_FLAG:
        return json_boolean(*(const bool *)at);
    case SETTING_LIST:
        items = pointer_of(s, setting);
        list = json_array();
        for (char **item = items; item && *item; item++)
            json_array_append_new(list, json_string(*item));
        return list;
    case SETTING_OBJECT:
        break;
    }
    return text ? json_loads(text, 0, NULL) : json_object();
}

/* Sets the value at its path. */
static void setting_to_json(const struct settings *s, const struct setting *setting, json_t *root) {
    size_t length = strcspn(setting->path, ".");
    char *group = mem_strndup(setting->path, length);
    json_t *members = json_object_get(root, group);
    if (!members)
        json_object_set_new(root, group, members = json_object());
    json_object_set_new(members, setting->path + length + 1, to_json(s, setting));
    free(group);
}

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
    s->api.film_program = mem_strdup(paths->commands);
}

/* Returns FACCIA_MAX_TEXT for --max-text. */
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

/* Values of getopt_long for options; not characters, unlike 'h' and '?' (unknown option). */
enum {
    OPTION_HELP = 1000,
    OPTION_VERSION,
    OPTION_PRINT,
    OPTION_SCHEMA,
    OPTION_CONFIG,
    OPTION_RENAMED,
    OPTION_SETTING /* first row of the table; the others follow */
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
    optind = 0; /* restarts the scan, which may have run in another order */
    opterr = !only_request;
    for (int c;
         (c = options_next(argc, argv, program == PROGRAM_COMMANDS ? "+h" : "h", options, NULL)) != -1;) {
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
    /* The first scan finds the file's name only; errors are reported by the second. */
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
    if (!json_equal(root, again)) { /* the shortest form that reads back as the same number */
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
