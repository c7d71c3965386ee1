/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the source says of a work: its title, authors and date. */
#include "server/base/mem.h"
#include "server/library/works/readers.h"
#include "server/library/works/work.h"
#include <ctype.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>

enum { LETTERS_MOST = 8 }; /* beside the years of a life: "ca.", "fl.", "or" */

static const char figures[] = "0123456789";

void work_meta_free(struct work_meta *m) {
    char *const texts[] = {m->title, m->author, m->lang, m->date, m->publisher, m->licence, m->source};
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++)
        free(texts[i]);
    work_persons_free(m->persons, m->person_count);
    *m = (struct work_meta){0};
}

void work_persons_free(struct work_person *persons, size_t count) {
    for (size_t i = 0; i < count; i++) {
        free(persons[i].id);
        free(persons[i].name);
        free(persons[i].about);
    }
    free(persons);
}

void work_meta_set(char **field, const char *text) {
    if (!*field && text && *text)
        *field = mem_strdup(text);
}

/* Returns the first year of four digits; INT_MAX: none. Three are a century in Italian headers ("700"). */
static int year_of(const char *date) {
    for (const char *at = date; *at;) {
        size_t digits = strspn(at, figures);
        if (digits == 4)
            return at == date + 1 && *date == '-' ? -atoi(at) : atoi(at);
        at += digits ? digits : 1;
    }
    return INT_MAX;
}

void work_meta_earlier(char **date, const char *text) {
    if (*date && text && year_of(text) < year_of(*date)) {
        free(*date);
        *date = NULL;
    }
    work_meta_set(date, text);
}

/* True for the years of a life, in the text [from, to): "1832-1898", "ca. 1300", "1850-", "18??-19??". */
static bool is_life(const char *from, const char *to) {
    size_t letters = 0;
    bool year = false;
    for (const char *at = from; at < to;) {
        size_t digits = strspn(at, figures);
        year = year || digits == 3 || digits == 4 || (digits == 2 && at[2] == '?');
        letters += isalpha((unsigned char)*at) != 0;
        at += digits ? digits : 1;
    }
    return year && letters <= LETTERS_MOST;
}

/* Where the name at [from, to) ends without the years of its person's life. */
static const char *end_of_name(const char *from, const char *to) {
    const char *end = to > from && to[-1] == '.' ? to - 1 : to;
    const char *begin = end > from && end[-1] == ')' ? memrchr(from, '(', (size_t)(end - from))
                                                     : memrchr(from, ',', (size_t)(end - from));
    if (!begin || !is_life(begin, end))
        return to;
    while (begin > from && strchr(" ,", begin[-1]))
        begin--;
    return begin > from ? begin : to;
}

void work_meta_authors(char *authors) {
    char *out = authors;
    for (const char *at = authors, *next; at && *at; at = next) {
        const char *to = strstr(at, "; "), *end;
        next = to ? to + 2 : NULL;
        to = to ? to : at + strlen(at);
        end = end_of_name(at, to);
        memmove(out, at, (size_t)(end - at));
        out += end - at;
        if (next) {
            memmove(out, "; ", 2);
            out += 2;
        } else {
            *out = '\0';
        }
    }
}

void work_meta_title(char *title) {
    static const char *const forms[] = {"electronic edition",
                                        "electronic text",
                                        "electronic version",
                                        "electronic transcription",
                                        "electronic resource",
                                        "digital edition",
                                        "machine-readable",
                                        "machine readable",
                                        "TEI edition",
                                        "ELTeC",
                                        NULL};
    for (char *from = title; (from = title ? strrchr(title, ':') : NULL) && from > title;) {
        bool form = false;
        for (size_t i = 0; forms[i]; i++)
            form = form || strcasestr(from, forms[i]);
        if (!form)
            return;
        while (from > title && strchr(" :", from[-1]))
            from--;
        *from = '\0';
    }
}
