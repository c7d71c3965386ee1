/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Where the program's own files lie: in its build tree; or below the prefix that the program itself lies in,
 * which may have been moved; or, when it lies elsewhere, below the prefix that it was built for. */
#ifndef FACCIA_BASE_PATHS_H
#define FACCIA_BASE_PATHS_H

/* Absolute paths; free with paths_free. An empty string where nothing was found. */
struct paths {
    char *models;  /* holds speech/, heads/ */
    char *web;     /* the page and its bundle */
    char *plugins; /* voice plugins */
    char *worker;  /* the faccia-voice program */
    char *aligner; /* the faccia-align program */
    char *reader;  /* the faccia-reader program */
};

void paths_find(struct paths *paths);
void paths_free(struct paths *paths);

#endif
