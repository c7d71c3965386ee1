/* SPDX-License-Identifier: GPL-3.0-or-later */
/* faccia coach: compares a learner's recording of a text with a voice that speaks it. */
#include "server/base/mem.h"
#include "server/base/utf8.h"
#include "server/cli/cli.h"
#include "server/coach/coach.h"
#include "server/live/lip_network.h"
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { SECONDS_MOST = 60, STATE_WIDTH = 10, WORD_WIDTH = 16 };

static const char usage[] =
    "Usage: faccia coach [OPTION]... RECORDING TEXT\n"
    "Compares a RECORDING of somebody who says TEXT (WAV, FLAC, Ogg, MP3; at most a minute) with a voice "
    "that "
    "says it,\n"
    "word by word and sound by sound: good, different, or unsure. It hears what can be seen on the lips, and "
    "does not tell /p b m/ apart.\n"
    "\n"
    "  -l, --lang TAG       it, pt-BR, tr, en, or any other that a voice speaks (it)\n"
    "  -v, --voice ID       a voice that 'faccia voices' lists\n"
    "      --markup WORD    of the text, as for 'faccia say': SSML can say how a word is pronounced\n"
    "      --lexicon FILE   pronunciation lexicon (W3C PLS); may be repeated\n"
    "      --json FILE      the comparison as JSON\n"
    "  -h, --help           print this and exit\n"
    "FILE - is standard output. Exit status: 0 compared, 1 failed, 2 wrong usage.\n";

struct coach {
    struct speech_request request;
    struct cli_lexicons lexicons;
    const char *json, *recording;
    bool spoken, failed;
};

static void on_spoken(void *ctx, const struct error *failed) {
    struct coach *c = ctx;
    c->spoken = true;
    c->failed = failed;
    if (failed)
        cli_complain_of(failed);
}

/* ---- output ---- */

static const char *text_of(const json_t *object, const char *name) {
    const char *text = json_string_value(json_object_get(object, name));
    return text ? text : "";
}

static double number_of(const json_t *object, const char *name) {
    return json_number_value(json_object_get(object, name));
}

/* A phone that is not good shows what is heard instead. */
static void print_phone(const json_t *phone) {
    static const char *const marks[] = {"?", "", "!"};
    const char *state = text_of(phone, "state");
    int mark = !strcmp(state, "good") ? 1 : !strcmp(state, "different") ? 2 : 0;
    printf(" %s%s", text_of(phone, "ipa"), marks[mark]);
    if (mark == 2)
        printf("(%s)", text_of(phone, "heard"));
}

static void print_table(const json_t *answer) {
    const json_t *phones = json_object_get(answer, "phones"), *word, *phone;
    size_t i, k;
    if (json_is_true(json_object_get(answer, "other")))
        puts("This does not sound like the text.");
    json_array_foreach(json_object_get(answer, "words"), i, word) {
        const char *text = text_of(word, "text");
        struct utf16_counter counter = {0};
        int pad = WORD_WIDTH - (int)utf16_offset(&counter, text, strlen(text));
        printf("%6.2f  %s%*s%-*s", number_of(word, "start"), text, pad > 1 ? pad : 1, "", STATE_WIDTH,
               text_of(word, "state"));
        json_array_foreach(phones, k, phone) {
            if ((size_t)json_integer_value(json_object_get(phone, "word")) == i)
                print_phone(phone);
        }
        putchar('\n');
    }
}

static int write_json(const struct coach *c, const json_t *answer) {
    struct cli_file file = {0};
    if (cli_create(&file, c->json))
        return -1;
    json_dumpf(answer, file.file, JSON_INDENT(1) | JSON_REAL_PRECISION(12));
    fputc('\n', file.file);
    return cli_finish(&file, true);
}

/* ---- the comparison ---- */

static json_t *compare(const struct coach *c, const struct coach_model *model,
                       const struct settings *settings, struct error *e) {
    char path[PATH_MAX];
    snprintf(path, sizeof path, "%s/hear/network.bin", settings->models);
    struct lip_network *network = lip_network_load(path, e);
    const struct coach_options options = {.network = network, .seconds = SECONDS_MOST};
    int fd = network ? open(c->recording, O_RDONLY | O_CLOEXEC) : -1;
    json_t *answer = NULL;
    if (fd >= 0)
        answer = coach_compare(model, fd, &options, e);
    else if (network)
        error_set(e, ERROR_BAD_SOUND, "%s", strerror(errno));
    lip_network_free(network);
    return answer;
}

static int run(struct coach *c, const struct settings *settings) {
    struct cli cli;
    struct error e;
    char text[400];
    json_t *answer = NULL;
    struct coach_model *model = NULL;
    int status = EXIT_FAILED;
    if (!cli_open(&cli, cli_lexicons_with(&c->lexicons, settings))) {
        model = coach_model_new(&cli.components.pipeline, &c->request, SECONDS_MOST, on_spoken, c, &e);
        if (!model) {
            cli_complain_of(&e);
            status = e.place == PLACE_FIELD ? EXIT_USAGE : EXIT_FAILED;
        }
    }
    while (model && !c->spoken && uv_run(&cli.loop, UV_RUN_ONCE))
        ;
    if (model && c->spoken && !c->failed) {
        answer = compare(c, model, settings, &e);
        if (!answer)
            cli_complain("%s: %s", c->recording, error_text(&e, text, sizeof text));
        else if (!c->json)
            print_table(answer);
        if (answer && (!c->json || !write_json(c, answer)))
            status = EXIT_DONE;
    }
    json_decref(answer);
    coach_model_free(model);
    cli_close(&cli);
    return status;
}

/* ---- options ---- */

static int take_field(void *ctx, const char *name, const char *text) {
    struct coach *c = ctx;
    struct error e;
    char message[400];
    const struct request_value value = {REQUEST_WORD, text, strlen(text), 0};
    if (!request_set(&c->request, name, value, &e))
        return -1;
    cli_complain("--%s", error_text(&e, message, sizeof message));
    return EXIT_USAGE;
}

static int take_lexicon(void *ctx, const char *name, const char *text) {
    struct coach *c = ctx;
    (void)name;
    cli_lexicons_add(&c->lexicons, (char *)text);
    return -1;
}

int coach_main(int argc, char **argv, const struct settings *settings) {
    struct coach c = {.json = NULL};
    const struct cli_option options[] = {
        {.name = "lang", .letter = 'l', .kind = CLI_CALL, .take = take_field},
        {.name = "voice", .letter = 'v', .kind = CLI_CALL, .take = take_field},
        {.name = "markup", .kind = CLI_CALL, .take = take_field},
        {.name = "lexicon", .kind = CLI_CALL, .take = take_lexicon},
        {.name = "json", .kind = CLI_TEXT, .out = &c.json},
        {.name = NULL}};
    struct error e;
    request_init(&c.request);
    int status = cli_options(argc, argv, usage, options, &c);
    if (status < 0 && optind + 2 != argc) {
        cli_complain("a recording and a text are needed");
        status = EXIT_USAGE;
    }
    if (status < 0) {
        const struct request_value text = {REQUEST_STRING, argv[optind + 1], strlen(argv[optind + 1]), 0};
        c.recording = argv[optind];
        if (request_set(&c.request, "text", text, &e)) {
            cli_complain_of(&e);
            status = EXIT_USAGE;
        } else {
            status = run(&c, settings);
        }
    }
    request_free(&c.request);
    cli_lexicons_free(&c.lexicons);
    return status;
}
