/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Locations of the program's own files: in its build tree; or below the prefix that contains the program,
 * which may have been moved; or else below the configured prefix. */
#ifndef FACCIA_BASE_PATHS_H
#define FACCIA_BASE_PATHS_H

/* Absolute paths; "" if not found. Free with paths_free. */
struct paths {
    char *models;     /* holds speech/, heads/ */
    char *web;        /* the page and its bundle */
    char *plugins;    /* voice plugins */
    char *worker;     /* the faccia-voice program */
    char *aligner;    /* the faccia-align program */
    char *reader;     /* the faccia-reader program */
    char *recogniser; /* the faccia-recogniser program */
    char *commands;   /* the faccia program */
};

void paths_find(struct paths *paths);
void paths_free(struct paths *paths);

#endif
