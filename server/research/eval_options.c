/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/research/eval_options.h"
#include "server/cli/cli.h"
#include <stdlib.h>
#include <string.h>

struct eval_variant eval_variant(const char *engine, enum face_contacts contacts) {
    bool own = face_engine_contacts(engine, CONTACTS_ENGINE), on = face_engine_contacts(engine, contacts);
    struct eval_variant v = {engine, on ? CONTACTS_ON : CONTACTS_OFF, ""};
    snprintf(v.label, sizeof v.label, "%s%s", engine, on == own ? "" : on ? " +contacts" : " -contacts");
    return v;
}

static const char usage[] =
    "Usage: faccia eval [OPTION]... (TEXT | --file FILE | -)\n"
    "       faccia eval [OPTION]... --recording CURVES --phones TIMES [--other CURVES --other-phones "
    "TIMES]...\n"
    "       faccia eval --film FILM --text WORDS [OPTION]... (see 'faccia speaker --help')\n"
    "Measures the lips: how well lips that speak TEXT, a file, or standard input (-) can be read, for each "
    "engine and speech\n"
    "rate; or how close each engine comes to recorded speakers. A table goes to standard output unless "
    "--json or --svg\n"
    "is given.\n"
    "\n"
    "  -l, --lang TAG       it, pt-BR, tr, en, or any other that a voice speaks (it)\n"
    "  -v, --voice ID       a voice listed by 'faccia voices'\n"
    "  -e, --engine NAME    visible-speech engine; may be given several times (all that the language has)\n"
    "      --contacts HOW   the layer of contacts over them: on, off, engine (as each has it) or both (both, "
    "or engine where\n"
    "                       engines are named)\n"
    "      --ablation       the default engine without its shape, and without its resistance, too\n"
    "  -r, --rates LIST     words per minute, 40 to 500, with commas (80,120,160,200,240,280,320)\n"
    "      --fps N          FAP frames per second, 1 to 120 (25)\n"
    "  -f, --file FILE      the text\n"
    "      --recording FILE curves of a person in mm (as for 'faccia fit'); may be repeated, each followed "
    "by\n"
    "      --phones FILE    the times of its phones: CSV, TextGrid, .lab, HTK or JSON; IPA, X-SAMPA or "
    "ARPAbet\n"
    "      --other FILE     another speaker of the same text, aligned to the same times: how alike people "
    "are\n"
    "      --other-phones FILE\n"
    "      --shift MS       delay of all predictions, -60 to 60 (0)\n"
    "      --json FILE      all figures\n"
    "      --svg FILE       a picture: the lips' gap over some words, and the measures over the rates\n"
    "      --curve-table FILE\n"
    "                       of recordings: each frame as measured and as each engine has it (CSV, mm; empty\n"
    "                       where it was not recorded)\n"
    "  -h, --help           print this and exit\n"
    "\n"
    "lips, held: bilabials closed in a frame that is shown while they sound, throughout their middle third; "
    "teeth, held: the\n"
    "same for labiodentals. Both in the phones' own times, as the voice gave them.\n"
    "open, err: opening of vowels against their targets; round, protr: rounding of /o u/ against its "
    "targets; antic: how\n"
    "much of it is there in the consonant before; speed, jerk: the largest of the lips' gap; overlap: lips "
    "passing through\n"
    "each other; reader: visemes told by a nearest neighbour that learnt from half of the words of the same "
    "engine: it\n"
    "measures how well an engine keeps its shapes apart, not whether a person could read them (a plain table "
    "does best);\n"
    "usual: the same by always saying the commonest one. How they are taken: server/research/eval.h.\n"
    "Of recordings, for each parameter: r, the correlation; rms, the error in mm when the prediction may be "
    "moved by a\n"
    "constant; affine, when it may be scaled, too; shift, in ms within 60, the one with the highest r, and "
    "that r. reader:\n"
    "visemes told by a nearest neighbour that learnt from the people and reads the engine. seen in N %: in "
    "the other\n"
    "frames the film did not show the parameter, and it is an estimate.\n"
    "FILE - is standard input or output. Exit status: 0 measured, 1 failed, 2 wrong usage.\n";

static int compare(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

struct parse {
    struct eval_options *o;
    bool contacts; /* contacts were chosen explicitly */
};

static int read_rates(void *ctx, const char *name, const char *list) {
    struct eval_options *o = ((struct parse *)ctx)->o;
    size_t kept = 0;
    for (o->rate_count = 0;; list++) {
        char *end;
        double rate = strtod(list, &end);
        if (end == list || (*end && *end != ',') || !(rate >= 40 && rate <= 500) ||
            o->rate_count == EVAL_RATES) {
            cli_complain("--%s: must be up to %d numbers from 40 to 500, separated by commas", name,
                         EVAL_RATES);
            return EXIT_USAGE;
        }
        o->rates[o->rate_count++] = rate;
        list = end;
        if (!*list)
            break;
    }
    qsort(o->rates, o->rate_count, sizeof *o->rates, compare);
    for (size_t i = 0; i < o->rate_count; i++)
        if (!kept || o->rates[i] != o->rates[kept - 1])
            o->rates[kept++] = o->rates[i];
    o->rate_count = kept;
    return -1;
}

static int add_engine(void *ctx, const char *option, const char *name) {
    struct eval_options *o = ((struct parse *)ctx)->o;
    const char *const *lists[] = {face_engines(), face_engine_ablations()};
    const char *found = NULL;
    for (int i = 0; i < 2; i++)
        for (const char *const *engine = lists[i]; *engine; engine++)
            if (!strcmp(*engine, name))
                found = *engine;
    if (!found) {
        cli_complain("%s: unknown engine '%s'", option, name);
        return EXIT_USAGE;
    }
    for (size_t i = 0; i < o->engine_count; i++)
        if (o->engines[i] == found)
            return -1;
    if (o->engine_count == STRETCH_ENGINES / 2) {
        cli_complain("--%s: the limit is %d", option, STRETCH_ENGINES / 2);
        return EXIT_USAGE;
    }
    o->engines[o->engine_count++] = found;
    return -1;
}

static int read_contacts(void *ctx, const char *option, const char *word) {
    struct parse *parse = ctx;
    struct eval_options *o = parse->o;
    static const char *const words[] = {
        [CONTACTS_ENGINE] = "engine", [CONTACTS_ON] = "on", [CONTACTS_OFF] = "off"};
    parse->contacts = true;
    o->both = !strcmp(word, "both");
    for (int i = 0; !o->both && i < 3; i++)
        if (!strcmp(word, words[i])) {
            o->contacts = (enum face_contacts)i;
            return -1;
        }
    if (o->both)
        return -1;
    cli_complain("--%s: must be one of engine, on, off, both", option);
    return EXIT_USAGE;
}

static int add_recording(void *ctx, const char *name, const char *path) {
    struct eval_options *o = ((struct parse *)ctx)->o;
    if (o->people == EVAL_PEOPLE) {
        cli_complain("--%s: the limit is %d", name, EVAL_PEOPLE);
        return EXIT_USAGE;
    }
    o->curves[o->people++] = path;
    return -1;
}

/* Adds a file to the latest --recording. */
static int add_person_file(void *ctx, const char *name, const char *path) {
    struct eval_options *o = ((struct parse *)ctx)->o;
    if (!o->people) {
        cli_complain("--recording comes before its --phones, --other and --other-phones");
        return EXIT_USAGE;
    }
    size_t last = o->people - 1;
    if (!strcmp(name, "phones"))
        o->phones[last] = path;
    else if (!strcmp(name, "other"))
        o->other_curves[last] = path;
    else
        o->other_phones[last] = path;
    return -1;
}

static int check(const struct eval_options *o) {
    for (size_t i = 0; i < o->people; i++)
        if (!o->phones[i] || !o->other_curves[i] != !o->other_phones[i]) {
            cli_complain("%s: needs %s", o->curves[i],
                         !o->phones[i] ? "--phones" : "both --other and --other-phones");
            return EXIT_USAGE;
        }
    if (o->people && o->svg_path) {
        cli_complain("--svg: recordings have no chart");
        return EXIT_USAGE;
    }
    if (!o->people && o->curves_path) {
        cli_complain("--curve-table: needs --recording");
        return EXIT_USAGE;
    }
    if (o->json_path && o->curves_path && !strcmp(o->json_path, "-") && !strcmp(o->curves_path, "-")) {
        cli_complain("only one of --json and --curve-table can go to standard output");
        return EXIT_USAGE;
    }
    if (o->json_path && o->svg_path && !strcmp(o->json_path, "-") && !strcmp(o->svg_path, "-")) {
        cli_complain("only one of --json and --svg can go to standard output");
        return EXIT_USAGE;
    }
    return -1;
}

bool eval_options_name(const struct eval_options *o, const char *engine) {
    for (size_t i = 0; i < o->engine_count; i++)
        if (o->engines[i] == engine)
            return true;
    return !o->engine_count;
}

void eval_options_variants(const struct eval_options *o, const char *engine, struct eval_variant *list,
                           size_t *count) {
    bool own = face_engine_contacts(engine, CONTACTS_ENGINE);
    list[(*count)++] = eval_variant(engine, o->both ? CONTACTS_ENGINE : o->contacts);
    if (o->both)
        list[(*count)++] = eval_variant(engine, own ? CONTACTS_OFF : CONTACTS_ON);
}

static int set_field(void *ctx, const char *field, const char *word) {
    struct eval_options *o = ((struct parse *)ctx)->o;
    struct request_value value = {REQUEST_WORD, word, strlen(word), 0};
    struct error e;
    char message[400];
    if (!request_set(&o->request, field, value, &e))
        return -1;
    cli_complain("--%s", error_text(&e, message, sizeof message));
    return EXIT_USAGE;
}

int eval_options_parse(int argc, char **argv, struct eval_options *o, struct buf *text) {
    const char *path = NULL;
    double shift = 0;
    struct parse parse = {o, false};
    const struct cli_option options[] = {
        {"lang", 'l', CLI_CALL, NULL, 0, 0, set_field},
        {"voice", 'v', CLI_CALL, NULL, 0, 0, set_field},
        {"fps", 0, CLI_CALL, NULL, 0, 0, set_field},
        {"engine", 'e', CLI_CALL, NULL, 0, 0, add_engine},
        {"contacts", 0, CLI_CALL, NULL, 0, 0, read_contacts},
        {"ablation", 0, CLI_FLAG, &o->ablation, 0, 0, NULL},
        {"rates", 'r', CLI_CALL, NULL, 0, 0, read_rates},
        {"file", 'f', CLI_TEXT, &path, 0, 0, NULL},
        {"recording", 0, CLI_CALL, NULL, 0, 0, add_recording},
        {"phones", 0, CLI_CALL, NULL, 0, 0, add_person_file},
        {"other", 0, CLI_CALL, NULL, 0, 0, add_person_file},
        {"other-phones", 0, CLI_CALL, NULL, 0, 0, add_person_file},
        {"shift", 0, CLI_NUMBER, &shift, -60, 60, NULL},
        {"json", 0, CLI_TEXT, &o->json_path, 0, 0, NULL},
        {"svg", 0, CLI_TEXT, &o->svg_path, 0, 0, NULL},
        {"curve-table", 0, CLI_TEXT, &o->curves_path, 0, 0, NULL},
        {0},
    };
    int status = read_rates(&parse, "rates", "80,120,160,200,240,280,320");
    if (status < 0)
        status = cli_options(argc, argv, usage, options, &parse);
    if (status < 0)
        status = check(o);
    o->shift = shift / 1000;
    if (!parse.contacts)
        o->both = !o->engine_count;
    if (status >= 0 || o->people)
        return status;
    status = cli_text(argc, argv, path, text);
    struct error e;
    if (status < 0)
        request_set(
            &o->request, "text",
            (struct request_value){REQUEST_STRING, text->size ? (char *)text->data : "", text->size, 0}, &e);
    return status;
}
