/* SPDX-License-Identifier: GPL-3.0-or-later */
/* faccia corpus: chooses sentences of a text that cover its sounds, for a recording session (Leone,
 * "LUCIA-WebGL", chapter 3.2). Greedy: each sentence taken is the one with the most new units for its length,
 * which comes within 1 - 1/e of the best choice of that length (Nemhauser, Wolsey and Fisher, 1978). */
#include "server/base/mem.h"
#include "server/cli/cli.h"
#include "server/synthesis/synthesis.h"
#include <getopt.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char usage[] =
    "Usage: faccia corpus [OPTION]... (TEXT | --file FILE | -)\n"
    "Chooses sentences of a text that cover its sounds, for a recording session: those with the most new "
    "sounds "
    "for their\n"
    "length first. Prints one per line; the covered share goes to standard error.\n"
    "\n"
    "  -l, --lang TAG       language of the text (it)\n"
    "  -v, --voice NAME     the voice whose sounds count\n"
    "  -f, --file FILE      the text\n"
    "  -u, --unit WORD      what is to be covered: phones, diphones or triphones, with pauses (diphones)\n"
    "  -c, --count N        at most so many sentences (10000)\n"
    "      --cover PERCENT  stop when that share of the units is covered (100)\n"
    "      --least N        leave out sentences with fewer words (3)\n"
    "      --most N         leave out sentences with more words (20)\n"
    "  -h, --help           print this and exit\n"
    "Exit status: 0 done, 1 failed, 2 wrong usage.\n";

enum { UNITS_MOST = 3, SENTENCES = 10000 };
static const char *const unit_names[UNITS_MOST] = {"phones", "diphones", "triphones"};

/* Units of all sentences, by number. */
struct sentence {
    size_t from, to; /* bytes of the text */
    size_t words;
    size_t first, count; /* its units in corpus.units, without repetitions */
    double seconds;
    size_t gain; /* new units when last counted: never more later */
    bool taken;
};

struct corpus {
    struct cli cli;
    struct speech_request request;
    const char *unit, *file;
    int size; /* phones of a unit */
    int count, least, most;
    double cover;
    struct synthesis *synthesis;
    bool finished, failed;
    struct sentence *sentences;
    size_t sentence_count, sentence_cap;
    char **names; /* of the units as they are found; later sorted and without repetitions */
    size_t name_count, name_cap, kinds;
    uint32_t *units;
};

/* ---- sentences and their units ---- */

static void add_unit(struct corpus *c, const struct phone *const *phones) {
    struct buf name = {0};
    for (int i = 0; i < c->size; i++)
        buf_printf(&name, "%s%s", i ? " " : "", phones[i] && *phones[i]->ipa ? phones[i]->ipa : "_");
    c->names = mem_grow(c->names, &c->name_cap, c->name_count + 1, sizeof *c->names);
    c->names[c->name_count++] = mem_strdup((const char *)name.data);
    buf_free(&name);
}

static void on_segment(void *ctx, struct media_segment segment) {
    struct corpus *c = ctx;
    const struct sentence_audio *u = segment.audio;
    bool fits = u->word_count >= (size_t)c->least && u->word_count <= (size_t)c->most;
    if (fits && !c->failed) {
        c->sentences = mem_grow(c->sentences, &c->sentence_cap, c->sentence_count + 1, sizeof *c->sentences);
        struct sentence *s = &c->sentences[c->sentence_count++];
        *s = (struct sentence){.from = u->from,
                               .to = u->to,
                               .words = u->word_count,
                               .first = c->name_count,
                               .seconds = (double)u->samples / u->sample_rate};
        const struct phone *window[UNITS_MOST] = {NULL}; /* a pause goes before and after the sentence */
        for (size_t i = 0; i <= u->phone_count; i++) {
            memmove(window, window + 1, (size_t)(c->size - 1) * sizeof *window);
            window[c->size - 1] = i < u->phone_count ? &u->phones[i] : NULL;
            if (i + 2 >= (size_t)c->size && (i < u->phone_count || c->size > 1))
                add_unit(c, window);
        }
        s->count = c->name_count - s->first;
    }
    media_segment_free(&segment);
    synthesis_release(c->synthesis);
}

static void on_problem(void *ctx, const struct error *e, bool warning) {
    struct corpus *c = ctx;
    cli_complain_at(c->file, warning, e);
    c->failed |= !warning;
}

static void on_finished(void *ctx, size_t spoken) {
    struct corpus *c = ctx;
    c->finished = true;
    c->failed |= !spoken;
}

static int speak(struct corpus *c) {
    static const struct synthesis_callbacks callbacks = {on_segment, on_problem, on_finished};
    struct error e;
    c->synthesis = synthesis_open(&c->cli.components.pipeline, &c->request, &callbacks, c, &e);
    if (!c->synthesis) {
        cli_complain_at(c->file, false, &e);
        return e.place == PLACE_FIELD ? EXIT_USAGE : EXIT_FAILED;
    }
    synthesis_start(c->synthesis);
    while (!c->finished && uv_run(&c->cli.loop, UV_RUN_ONCE))
        ;
    synthesis_free(c->synthesis);
    return c->failed ? EXIT_FAILED : EXIT_DONE;
}

static int by_name(const void *a, const void *b) {
    return strcmp(*(char *const *)a, *(char *const *)b);
}

static int by_number(const void *a, const void *b) {
    uint32_t p = *(const uint32_t *)a, q = *(const uint32_t *)b;
    return p < q ? -1 : p > q;
}

/* Numbers the units, and removes repetitions within a sentence. */
static void number_units(struct corpus *c) {
    char **sorted = mem_alloc((c->name_count + 1) * sizeof *sorted);
    memcpy(sorted, c->names, c->name_count * sizeof *sorted);
    qsort(sorted, c->name_count, sizeof *sorted, by_name);
    for (size_t i = 0; i < c->name_count; i++)
        if (!i || strcmp(sorted[i], sorted[c->kinds - 1]) != 0)
            sorted[c->kinds++] = sorted[i];
    c->units = mem_alloc((c->name_count + 1) * sizeof *c->units);
    for (size_t i = 0; i < c->name_count; i++)
        c->units[i] =
            (uint32_t)((char **)bsearch(&c->names[i], sorted, c->kinds, sizeof *sorted, by_name) - sorted);
    free(sorted);
    for (size_t i = 0; i < c->sentence_count; i++) {
        struct sentence *s = &c->sentences[i];
        uint32_t *units = c->units + s->first;
        size_t kept = 0;
        qsort(units, s->count, sizeof *units, by_number);
        for (size_t k = 0; k < s->count; k++)
            if (!k || units[k] != units[kept - 1])
                units[kept++] = units[k];
        s->count = s->gain = kept;
    }
}

/* ---- the choice ---- */

static size_t gain_of(const struct corpus *c, const struct sentence *s, const bool *covered) {
    size_t gain = 0;
    for (size_t k = 0; k < s->count; k++)
        gain += !covered[c->units[s->first + k]];
    return gain;
}

/* A gain only shrinks as sentences are taken, so a sentence is counted again only if its last gain could win.
 */
static struct sentence *next_of(struct corpus *c, const bool *covered) {
    struct sentence *best = NULL;
    double most = 0;
    for (size_t i = 0; i < c->sentence_count; i++) {
        struct sentence *s = &c->sentences[i];
        double length = s->seconds > 0.1 ? s->seconds : 0.1;
        if (s->taken || (double)s->gain / length <= most)
            continue;
        s->gain = gain_of(c, s, covered);
        if ((double)s->gain / length > most) {
            most = (double)s->gain / length;
            best = s;
        }
    }
    return best;
}

static void print_sentence(const struct corpus *c, const struct sentence *s) {
    bool blank = false;
    for (size_t i = s->from; i < s->to; i++) { /* on one line */
        char byte = c->request.text[i];
        bool white = strchr(" \t\r\n", byte) != NULL;
        if (!white) {
            if (blank && i > s->from)
                putchar(' ');
            putchar(byte);
        }
        blank = white;
    }
    putchar('\n');
}

static void choose(struct corpus *c) {
    bool *covered = mem_alloc((c->kinds + 1) * sizeof *covered);
    size_t known = 0;
    int taken = 0;
    double seconds = 0;
    struct sentence *s;
    while (taken < c->count && (double)known < c->cover / 100 * (double)c->kinds &&
           (s = next_of(c, covered))) {
        s->taken = true;
        taken++;
        seconds += s->seconds;
        known += s->gain;
        for (size_t k = 0; k < s->count; k++)
            covered[c->units[s->first + k]] = true;
        print_sentence(c, s);
    }
    fprintf(stderr, "%d of %zu sentences, %.0f s: %zu of the %zu %s in them (%.1f %%)\n", taken,
            c->sentence_count, seconds, known, c->kinds, c->unit,
            c->kinds ? 100 * (double)known / (double)c->kinds : 0);
    free(covered);
}

/* ---- the command ---- */

static int take_field(void *ctx, const char *name, const char *text) {
    struct corpus *c = ctx;
    struct request_value value = {REQUEST_WORD, text, strlen(text), 0};
    struct error e;
    char message[400];
    if (!request_set(&c->request, name, value, &e))
        return -1;
    cli_complain("--%s", error_text(&e, message, sizeof message));
    return EXIT_USAGE;
}

static int parse(int argc, char **argv, struct corpus *c) {
    const struct cli_option options[] = {
        {"lang", 'l', CLI_CALL, NULL, 0, 0, take_field},
        {"voice", 'v', CLI_CALL, NULL, 0, 0, take_field},
        {"file", 'f', CLI_TEXT, &c->file, 0, 0, NULL},
        {"unit", 'u', CLI_TEXT, &c->unit, 0, 0, NULL},
        {"count", 'c', CLI_WHOLE, &c->count, 1, SENTENCES, NULL},
        {"cover", 0, CLI_NUMBER, &c->cover, 1, 100, NULL},
        {"least", 0, CLI_WHOLE, &c->least, 1, 1000, NULL},
        {"most", 0, CLI_WHOLE, &c->most, 1, 1000, NULL},
        {0},
    };
    int status = cli_options(argc, argv, usage, options, c);
    if (status >= 0)
        return status;
    for (int i = 0; i < UNITS_MOST; i++)
        if (!strcmp(c->unit, unit_names[i]))
            c->size = i + 1;
    if (!c->size) {
        cli_complain("--unit: must be phones, diphones or triphones");
        return EXIT_USAGE;
    }
    return -1;
}

int corpus_main(int argc, char **argv, const struct settings *settings) {
    struct corpus *c = mem_alloc(sizeof *c);
    struct buf text = {0};
    c->unit = unit_names[1];
    c->count = SENTENCES;
    c->cover = 100;
    c->least = 3;
    c->most = 20;
    request_init(&c->request);
    int status = parse(argc, argv, c);
    if (status < 0)
        status = cli_text(argc, argv, c->file, &text);
    if (status < 0) {
        struct error e;
        request_set(&c->request, "text",
                    (struct request_value){REQUEST_STRING, text.size ? (char *)text.data : "", text.size, 0},
                    &e);
        status = cli_open(&c->cli, settings) ? EXIT_FAILED : speak(c);
        if (!status) {
            number_units(c);
            choose(c);
        }
        cli_close(&c->cli);
    }
    for (size_t i = 0; i < c->name_count; i++)
        free(c->names[i]);
    free(c->names);
    free(c->units);
    free(c->sentences);
    request_free(&c->request);
    buf_free(&text);
    free(c);
    return status;
}
