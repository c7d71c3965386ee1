/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/cli/cli.h"
#include "server/base/mem.h"
#include "server/base/options.h"
#include "server/base/program.h"
#include "server/base/utf8.h"
#include <ctype.h>
#include <errno.h>
#include <fcntl.h>
#include <libgen.h>
#include <math.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { MOST = 32, FIRST = 256 };

static int take_number(const struct cli_option *option, const char *text) {
    bool whole = option->kind == CLI_WHOLE;
    char *end;
    double value = strtod(text, &end);
    if (end == text || *end || !(value >= option->min && value <= option->max) ||
        (whole && value != floor(value))) {
        cli_complain("--%s: must be %s from %g to %g", option->name, whole ? "an integer" : "a number",
                     option->min, option->max);
        return EXIT_USAGE;
    }
    if (whole)
        *(int *)option->out = (int)value;
    else
        *(double *)option->out = value;
    return -1;
}

static int take(const struct cli_option *option, const char *text, void *ctx) {
    switch (option->kind) {
    case CLI_FLAG:
        *(bool *)option->out = true;
        return -1;
    case CLI_TEXT:
        *(const char **)option->out = text;
        return -1;
    case CLI_WHOLE:
    case CLI_NUMBER:
        return take_number(option, text);
    case CLI_CALL:
        break;
    }
    return option->take(ctx, option->name, text);
}

/* Does the option take the next argument as its value? */
static bool takes_next(const char *argument, const char *letters, const struct option *options) {
    const char *letter = argument[1] == '-' ? NULL : strchr(letters, argument[1]);
    if (letter)
        return letter[1] == ':' && !argument[2];
    for (; options->name; options++)
        if (argument[1] == '-' && !strcmp(options->name, argument + 2))
            return options->has_arg == required_argument;
    return false;
}

int cli_option_count(int argc, char **argv, const char *letters, const struct option *options) {
    int i = 1;
    while (i < argc && strcmp(argv[i], "--") != 0) {
        const char *argument = argv[i];
        bool dashed = argument[0] == '-' && argument[1];
        if (dashed && argument[1] != '-' && !isalpha((unsigned char)argument[1]))
            return i;
        i += dashed && takes_next(argument, letters, options) ? 2 : 1;
    }
    return argc;
}

int cli_options(int argc, char **argv, const char *usage, const struct cli_option *list, void *ctx) {
    struct option options[MOST + 2] = {{"help", no_argument, NULL, 'h'}};
    char letters[2 * MOST + 2] = "h";
    size_t count = 0, used = 1;
    for (; count < MOST && list[count].name; count++) {
        bool flag = list[count].kind == CLI_FLAG;
        options[count + 1] = (struct option){list[count].name, flag ? no_argument : required_argument, NULL,
                                             FIRST + (int)count};
        if (!list[count].letter)
            continue;
        letters[used++] = list[count].letter;
        if (!flag)
            letters[used++] = ':';
    }
    int most = cli_option_count(argc, argv, letters, options);
    for (int c; (c = options_next(most, argv, letters, options, NULL)) != -1;) {
        size_t i = c >= FIRST ? (size_t)(c - FIRST) : 0;
        while (c < FIRST && i < count && list[i].letter != c)
            i++;
        if (c == 'h' || c == '?' || i == count) {
            if (c == 'h')
                fputs(usage, stdout);
            else
                fprintf(stderr, "Try 'faccia %s --help'.\n", argv[0]);
            return c == 'h' ? EXIT_DONE : EXIT_USAGE;
        }
        int status = take(&list[i], optarg, ctx);
        if (status >= 0)
            return status;
    }
    return -1;
}

static int complain(const char *path, int error) {
    cli_complain("%s: %s", path, strerror(error));
    return -1;
}

/* Returns a hidden temporary name in the same folder. */
static char *part_name(const char *place) {
    const char *slash = strrchr(place, '/'), *name = slash ? slash + 1 : place;
    size_t size = strlen(place) + 32;
    char *part = mem_alloc(size);
    snprintf(part, size, "%.*s.%.200s.%ld.part", (int)(name - place), place, name, (long)getpid());
    return part;
}

/* An unnamed file disappears when the process is killed; not every file system supports it. */
static int open_nameless(const char *place) {
    char *copy = mem_strdup(place);
    int fd = open(dirname(copy), O_TMPFILE | O_WRONLY | O_CLOEXEC, 0666);
    free(copy);
    return fd;
}

static int open_part(struct cli_file *f, const struct stat *old) {
    int fd = open_nameless(f->place);
    if (fd < 0) {
        f->part = part_name(f->place);
        fd = open(f->part, O_CREAT | O_EXCL | O_WRONLY | O_CLOEXEC, 0666);
    }
    if (fd >= 0 && old)
        fchmod(fd, old->st_mode & 07777);
    return fd;
}

int cli_create(struct cli_file *f, const char *path) {
    struct stat status;
    *f = (struct cli_file){.path = path};
    if (!strcmp(path, "-")) {
        f->file = stdout;
        return 0;
    }
    bool is_there = !stat(path, &status);
    if (is_there && S_ISDIR(status.st_mode))
        return complain(path, EISDIR);
    int fd;
    if (is_there && !S_ISREG(status.st_mode)) {
        fd = open(path, O_WRONLY | O_CLOEXEC);
    } else {
        f->place = is_there ? realpath(path, NULL) : mem_strdup(path);
        fd = is_there && access(path, W_OK) ? -1 : f->place ? open_part(f, is_there ? &status : NULL) : -1;
    }
    f->file = fd >= 0 ? fdopen(fd, "wb") : NULL;
    if (f->file)
        return 0;
    int error = errno;
    if (fd >= 0)
        close(fd);
    free(f->place);
    free(f->part);
    *f = (struct cli_file){0};
    return complain(path, error);
}

/* Links the unnamed file to its temporary name, so that it can be renamed. */
static int give_name(struct cli_file *f) {
    char self[64];
    if (f->part)
        return 0;
    snprintf(self, sizeof self, "/proc/self/fd/%d", fileno(f->file));
    f->part = part_name(f->place);
    if (!linkat(AT_FDCWD, self, AT_FDCWD, f->part, AT_SYMLINK_FOLLOW))
        return 0;
    int error = errno;
    free(f->part);
    f->part = NULL;
    errno = error;
    return -1;
}

int cli_finish(struct cli_file *f, bool well) {
    int error = 0;
    if (!f->file)
        return 0;
    if (ferror(f->file) || fflush(f->file))
        error = errno ? errno : EIO;
    bool keep = well && !error && f->place;
    if (keep && (give_name(f) || rename(f->part, f->place)))
        error = errno;
    if (f->part && (!keep || error))
        unlink(f->part);
    if (f->file != stdout && fclose(f->file) && !error)
        error = errno;
    if (error && well)
        complain(f->path, error);
    free(f->place);
    free(f->part);
    *f = (struct cli_file){0};
    return error || !well ? -1 : 0;
}

void cli_complain(const char *format, ...) {
    char text[4096];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    utf8_mend(text); /* it quotes untrusted names and texts */
    fprintf(stderr, "faccia: %s\n", text);
}

void cli_complain_of(const struct error *e) {
    char text[400];
    cli_complain("%s (%s)", error_text(e, text, sizeof text), error_name(e->code));
}

void cli_complain_at(const char *path, bool warning, const struct error *e) {
    char text[400];
    const char *kind = warning ? "warning: " : "";
    bool known = path && strcmp(path, "-") != 0;
    if (known && e->place == PLACE_LINE)
        cli_complain("%s:%zu:%zu: %s%s", path, e->line, e->column, kind, e->message);
    else if (known && e->place == PLACE_BYTE)
        cli_complain("%s: byte %zu: %s%s", path, e->byte, kind, e->message);
    else
        cli_complain("%s%s", kind, error_text(e, text, sizeof text));
}

void cli_lexicons_add(struct cli_lexicons *l, char *path) {
    l->files = mem_grow(l->files, &l->cap, l->count + 1, sizeof *l->files);
    l->files[l->count++] = path;
}

const struct settings *cli_lexicons_with(struct cli_lexicons *l, const struct settings *settings) {
    for (char *const *file = settings->lexicons; file && *file; file++)
        cli_lexicons_add(l, *file);
    cli_lexicons_add(l, NULL);
    l->settings = *settings;
    l->settings.lexicons = l->files;
    return &l->settings;
}

void cli_lexicons_free(struct cli_lexicons *l) {
    free(l->files);
    *l = (struct cli_lexicons){0};
}

int cli_load(struct components *components, const struct settings *settings, unsigned wanted,
             uv_loop_t *loop) {
    struct error e;
    int result = components_load(components, settings, wanted, loop, &e);
    if (result)
        cli_complain_of(&e);
    return result;
}

static void on_ready(void *ctx) {
    *(bool *)ctx = true;
}

/* For a single text: no cache and one worker. */
static int start_voices(struct cli *cli, const struct settings *settings) {
    struct voice_pool_options voices = settings->voices;
    struct error e;
    bool ready = false;
    size_t count;
    voices.workers = 1;
    voices.spare_workers = 0;
    voices.cache = (struct cache_options){0};
    voices.quiet = true;
    if (components_start_voices(&cli->components, &voices, on_ready, &ready, &e)) {
        cli_complain_of(&e);
        return -1;
    }
    while (!ready && uv_run(&cli->loop, UV_RUN_ONCE))
        ;
    voice_pool_voices(cli->components.pipeline.voices, &count);
    if (!count)
        cli_complain("no voice plugin could be started");
    return count ? 0 : -1;
}

int cli_open(struct cli *cli, const struct settings *settings) {
    *cli = (struct cli){0};
    uv_loop_init(&cli->loop);
    /* faccia hear loads its network itself */
    return cli_load(&cli->components, settings, COMPONENTS_ALL & ~COMPONENTS_HEARING, &cli->loop) ||
                   start_voices(cli, settings)
               ? -1
               : 0;
}

void cli_close(struct cli *cli) {
    components_stop_voices(&cli->components);
    uv_run(&cli->loop, UV_RUN_DEFAULT);
    uv_loop_close(&cli->loop);
    components_free(&cli->components);
}

int cli_read(const char *path, struct buf *text) {
    enum { BYTES_MAX = 256 << 20 }; /* some devices never end */
    FILE *file = !strcmp(path, "-") ? stdin : fopen(path, "rb");
    int why = file ? buf_add_stream(text, file, BYTES_MAX) : errno;
    if (why)
        cli_complain("%s: %s", path, why == EFBIG ? "larger than 256 MiB" : strerror(why));
    if (file && file != stdin)
        fclose(file);
    return why ? -1 : 0;
}

int cli_text(int argc, char **argv, const char *path, struct buf *text) {
    if (!path && optind + 1 == argc && !strcmp(argv[optind], "-"))
        path = argv[optind++];
    if (!path == (optind == argc)) {
        cli_complain(path ? "unexpected '%s': the text comes from a file"
                          : "no text: give a text, a --file, or - for standard input",
                     argv[optind]);
        return EXIT_USAGE;
    }
    if (path && cli_read(path, text))
        return EXIT_FAILED;
    for (int i = optind; i < argc; i++)
        buf_printf(text, "%s%s", i > optind ? " " : "", argv[i]);
    return -1;
}

int cli_try_engine(const struct cli *cli, const struct speech_request *request, const char *engine,
                   struct error *e) {
    static const struct synthesis_callbacks none;
    struct speech_request copy;
    request_copy(&copy, request);
    free(copy.engine);
    copy.engine = mem_strdup(engine);
    struct synthesis *synthesis = synthesis_open(&cli->components.pipeline, &copy, &none, NULL, e);
    request_free(&copy);
    synthesis_free(synthesis);
    return synthesis ? 0 : -1;
}

int cli_run_tool(const struct settings *settings, const char *tool, const char *command, int count,
                 char **words) {
    char path[4096], node[] = "node";
    char **list = mem_alloc(((size_t)count + 3) * sizeof *list);
    snprintf(path, sizeof path, "%s/tools/%s.mjs", settings->models, tool);
    if (access(path, R_OK)) {
        cli_complain("%s: %s; it is built only where Node.js is installed", path, strerror(errno));
        free(list);
        return EXIT_FAILED;
    }
    list[0] = node;
    list[1] = path;
    memcpy(list + 2, words, sizeof *words * (size_t)count);
    program_give_back_signals();
    execvp(node, list);
    cli_complain("'%s' needs Node.js, 18 or later: node: %s", command, strerror(errno));
    free(list);
    return EXIT_FAILED;
}
