/* SPDX-License-Identifier: MIT */
#include "protocol/fba/fapfit.h"
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

const char *const fapfit_names[FAPFIT_FIELDS] = {"FAPs",
                                                 "Graph",
                                                 "numeratorExp",
                                                 "denominatorExp",
                                                 "numeratorImpulse",
                                                 "numeratorTerms",
                                                 "denominatorTerms",
                                                 "numeratorCoefs",
                                                 "denominatorCoefs"};

/* ---- text ---- */

enum { WORD_MAX = 40 };

struct scanner {
    const char *at, *end, *text;
    struct fapfit *fit;
    struct fapfit_error *error;
};

static int fail(struct scanner *s, const char *message) {
    const char *line = s->text;
    s->error->line = 1;
    for (const char *c = s->text; c < s->at; c++)
        if (*c == '\n') {
            s->error->line++;
            line = c + 1;
        }
    s->error->column = (size_t)(s->at - line) + 1;
    s->error->message = message;
    return -1;
}

static bool is_space(char c) {
    return c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == ',';
}

static bool is_letter(char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
}

static bool is_digit(char c) {
    return c >= '0' && c <= '9';
}

/* Passes over white space and comments; false at the end of the text. */
static bool skip(struct scanner *s) {
    while (s->at < s->end) {
        if (*s->at == '#')
            while (s->at < s->end && *s->at != '\n')
                s->at++;
        else if (is_space(*s->at))
            s->at++;
        else
            return true;
    }
    return false;
}

static void skip_string(struct scanner *s) {
    for (s->at++; s->at < s->end && *s->at != '"'; s->at++)
        if (*s->at == '\\' && s->at + 1 < s->end)
            s->at++;
    s->at += s->at < s->end;
}

/* Reads a name. Returns false if there is none. Names longer than any known one are truncated. */
static bool take_word(struct scanner *s, char word[WORD_MAX]) {
    size_t size = 0;
    if (s->at >= s->end || !is_letter(*s->at))
        return false;
    for (; s->at < s->end && (is_letter(*s->at) || is_digit(*s->at)); s->at++)
        if (size + 1 < WORD_MAX)
            word[size++] = *s->at;
    word[size] = '\0';
    return true;
}

static int take_number(struct scanner *s, enum fapfit_field field) {
    char word[WORD_MAX], *end;
    size_t size = 0;
    while (s->at + size < s->end && size + 1 < WORD_MAX && s->at[size] &&
           strchr("+-.0123456789eE", s->at[size]))
        size++;
    memcpy(word, s->at, size);
    word[size] = '\0';
    double number = strtod(word, &end);
    if (!size || *end || !isfinite(number))
        return fail(s, "a number is expected");
    if (fapfit_add(s->fit, field, number))
        return fail(s, "the table has more numbers than fit");
    s->at += size;
    return 0;
}

/* Numbers up to the closing character. */
static int take_list(struct scanner *s, enum fapfit_field field, char close) {
    if (s->fit->field[field].count)
        return fail(s, "a field stands twice");
    for (s->at++;;) {
        if (!skip(s))
            return fail(s, "the text ends within a list");
        if (*s->at == close) {
            s->at++;
            return 0;
        }
        if (take_number(s, field))
            return -1;
    }
}

/* The field of that name; -1: none. BIFS text writes Graph, the standard graph. */
static int field_of(const char *name) {
    for (int i = 0; i < FAPFIT_FIELDS; i++)
        if (!strcmp(name, fapfit_names[i]) || (i == FAPFIT_GRAPH && !strcmp(name, "graph")))
            return i;
    return -1;
}

/* The fields of a node in braces. */
static int take_node(struct scanner *s) {
    char word[WORD_MAX];
    for (s->at++;;) {
        if (!skip(s))
            return fail(s, "the text ends within the FIT");
        if (*s->at == '}')
            return 0;
        const char *begin = s->at;
        int field = take_word(s, word) ? field_of(word) : -1;
        if (field < 0) {
            s->at = begin;
            return fail(s, "this is no field of a FIT");
        }
        if (!skip(s))
            return fail(s, "the text ends within the FIT");
        if (*s->at == '[' ? take_list(s, (enum fapfit_field)field, ']')
                          : take_number(s, (enum fapfit_field)field))
            return -1;
    }
}

/* The attributes of an element. */
static int take_element(struct scanner *s) {
    char word[WORD_MAX];
    for (;;) {
        if (!skip(s))
            return fail(s, "the text ends within the FIT");
        if (*s->at == '>' || *s->at == '/')
            return 0;
        const char *begin = s->at;
        bool named = take_word(s, word) && skip(s) && *s->at == '=';
        s->at += named;
        char quote = named && skip(s) ? *s->at : '\0';
        if (quote != '"' && quote != '\'') {
            s->at = begin;
            return fail(s, "an attribute and its value are expected");
        }
        int field = field_of(word);
        if (field >= 0 && take_list(s, (enum fapfit_field)field, quote))
            return -1;
        if (field < 0) { /* DEF, binaryID */
            const char *close = memchr(s->at + 1, quote, (size_t)(s->end - s->at - 1));
            s->at = close ? close + 1 : s->end;
        }
    }
}

/* Moves `at` past the name of the first FIT node. Returns -1 if there is none. */
static int find_node(struct scanner *s, bool *xml) {
    char word[WORD_MAX];
    bool element = false;
    while (skip(s)) {
        if (*s->at == '"') {
            skip_string(s);
        } else if (take_word(s, word)) {
            const char *after = s->at;
            bool more = skip(s);
            *xml = element;
            if (!strcmp(word, "FIT") && more && (element || *s->at == '{'))
                return 0;
            s->at = after;
            element = false;
        } else {
            element = *s->at++ == '<';
        }
    }
    s->at = s->text;
    return fail(s, "there is no FIT in it");
}

int fapfit_read(const char *text, size_t size, struct fapfit *out, struct fapfit_error *error) {
    struct scanner s = {text, text + size, text, out, error};
    const char *message;
    bool xml;
    memset(out, 0, sizeof *out);
    if (find_node(&s, &xml))
        return -1;
    const char *begin = s.at;
    int status = xml ? take_element(&s) : take_node(&s);
    if (!status && fapfit_settle(out, &message)) {
        s.at = begin;
        status = fail(&s, message);
    }
    if (status)
        fapfit_free(out);
    return status;
}

/* ---- the fields together ---- */

void fapfit_free(struct fapfit *fit) {
    for (int i = 0; i < FAPFIT_FIELDS; i++)
        free(fit->field[i].at);
    memset(fit, 0, sizeof *fit);
}

int fapfit_add(struct fapfit *fit, enum fapfit_field field, double number) {
    struct fapfit_list *list = &fit->field[field];
    size_t total = 0;
    for (int i = 0; i < FAPFIT_FIELDS; i++)
        total += fit->field[i].count;
    if (total >= FAPFIT_NUMBERS_MAX)
        return -1;
    if (list->count == list->cap) {
        size_t cap = list->cap ? 2 * list->cap : 16;
        double *at = realloc(list->at, cap * sizeof *at);
        if (!at)
            return -1;
        list->at = at;
        list->cap = cap;
    }
    list->at[list->count++] = number;
    return 0;
}

static bool are_whole(const struct fapfit_list *list, double least, double most) {
    for (size_t i = 0; i < list->count; i++)
        if (!(list->at[i] >= least && list->at[i] <= most) || list->at[i] != floor(list->at[i]))
            return false;
    return true;
}

static const char *settle_sets(struct fapfit *fit) {
    const struct fapfit_list *faps = &fit->field[FAPFIT_FAPS];
    struct fapfit_set *set = NULL;
    if (!are_whole(faps, -1, FAPFIT_INDEX_MAX))
        return "FAPs must be whole numbers from 3 to 75, each set closed by -1";
    for (size_t i = 0; i < faps->count; i++) {
        int index = (int)faps->at[i];
        if (index == -1) {
            set = NULL;
            continue;
        }
        if (index < 3)
            return "FAP 1 and 2 stand in a set by their fields, 69 to 75";
        if (!set) {
            if (fit->sets == FAPFIT_SETS_MAX)
                return "more sets than there are FAPs";
            set = &fit->set[fit->sets++];
        }
        if (memchr(set->index, index, set->count))
            return "a FAP stands twice in a set";
        set->index[set->count++] = (uint8_t)index;
    }
    return set ? "the last set of FAPs is not closed by -1" : NULL;
}

static bool has_high(const struct fapfit_set *set) {
    for (int i = 0; i < set->count; i++)
        if (set->index[i] >= FAPFIT_HIGH)
            return true;
    return false;
}

static const char *settle_links(struct fapfit *fit) {
    const struct fapfit_list *graph = &fit->field[FAPFIT_GRAPH];
    if (!are_whole(graph, 1, (double)fit->sets) || graph->count % 2)
        return "Graph must have pairs of numbers of sets, from 1";
    if (graph->count / 2 > FAPFIT_LINKS_MAX)
        return "the Graph has too many links";
    for (size_t i = 0; i < graph->count / 2; i++) {
        fit->link[i].parent = (uint8_t)(graph->at[2 * i] - 1);
        fit->link[i].child = (uint8_t)(graph->at[2 * i + 1] - 1);
        if (has_high(&fit->set[fit->link[i].child]))
            return "fields of FAP 1 and 2 are in a child set: they do not follow from others";
    }
    fit->links = graph->count / 2;
    return NULL;
}

/* Computes where the functions of each link begin in the fields. */
static const char *settle_functions(struct fapfit *fit) {
    const struct fapfit_list *field = fit->field;
    size_t terms = 0, above = 0, below = 0, above_exp = 0, below_exp = 0, impulse = 0;
    if (!are_whole(&field[FAPFIT_NUMERATOR_TERMS], 0, FAPFIT_NUMBERS_MAX) ||
        !are_whole(&field[FAPFIT_DENOMINATOR_TERMS], 0, FAPFIT_NUMBERS_MAX))
        return "numeratorTerms and denominatorTerms must be whole numbers";
    if (field[FAPFIT_NUMERATOR_TERMS].count != field[FAPFIT_DENOMINATOR_TERMS].count)
        return "numeratorTerms and denominatorTerms must have as many numbers";
    for (size_t i = 0; i < fit->links; i++) {
        struct fapfit_link *link = &fit->link[i];
        const struct fapfit_set *parent = &fit->set[link->parent];
        *link = (struct fapfit_link){link->parent,        link->child,      (uint32_t)terms,
                                     (uint32_t)above,     (uint32_t)below,  (uint32_t)above_exp,
                                     (uint32_t)below_exp, (uint32_t)impulse};
        for (int k = 0; k < fit->set[link->child].count; k++, terms++) {
            if (terms >= field[FAPFIT_NUMERATOR_TERMS].count)
                return "numeratorTerms must have a number for each FAP of each link's child set";
            size_t up = (size_t)field[FAPFIT_NUMERATOR_TERMS].at[terms];
            size_t down = (size_t)field[FAPFIT_DENOMINATOR_TERMS].at[terms];
            above += up;
            below += down;
            above_exp += up * parent->count;
            below_exp += down * parent->count;
            impulse += has_high(parent) ? 2 * up : 0;
            if (above > FAPFIT_NUMBERS_MAX || below > FAPFIT_NUMBERS_MAX)
                return "there are more terms than numbers";
        }
    }
    if (terms != field[FAPFIT_NUMERATOR_TERMS].count)
        return "numeratorTerms must have a number for each FAP of each link's child set";
    if (above != field[FAPFIT_NUMERATOR_COEFS].count || below != field[FAPFIT_DENOMINATOR_COEFS].count)
        return "numeratorCoefs and denominatorCoefs must have a number for each term";
    if (above_exp != field[FAPFIT_NUMERATOR_EXP].count || below_exp != field[FAPFIT_DENOMINATOR_EXP].count)
        return "numeratorExp and denominatorExp must have a number for each term and FAP of the parent set";
    if (impulse != field[FAPFIT_NUMERATOR_IMPULSE].count)
        return "numeratorImpulse must have a pair for each term that depends on FAP 1 or 2";
    return NULL;
}

int fapfit_settle(struct fapfit *fit, const char **message) {
    fit->sets = fit->links = 0;
    *message = settle_sets(fit);
    if (!*message)
        *message = settle_links(fit);
    if (!*message && (!are_whole(&fit->field[FAPFIT_NUMERATOR_EXP], 0, FAPFIT_EXPONENT_MAX) ||
                      !are_whole(&fit->field[FAPFIT_DENOMINATOR_EXP], 0, FAPFIT_EXPONENT_MAX)))
        *message = "exponents must be whole numbers from 0 to 15";
    if (!*message && !are_whole(&fit->field[FAPFIT_NUMERATOR_IMPULSE], 0, FAPFIT_INDEX_MAX))
        *message = "numeratorImpulse must have pairs of a field (69 to 75) and its value";
    for (size_t i = 0; !*message && i < fit->field[FAPFIT_NUMERATOR_IMPULSE].count; i += 2)
        if (fit->field[FAPFIT_NUMERATOR_IMPULSE].at[i] < FAPFIT_HIGH)
            *message = "numeratorImpulse must have pairs of a field (69 to 75) and its value";
    if (!*message)
        *message = settle_functions(fit);
    return *message ? -1 : 0;
}
