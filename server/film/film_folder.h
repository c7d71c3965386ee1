/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Folders for the files of a film. Each is locked by its process, so that what a killed one has left behind
 * is found and removed. */
#ifndef FACCIA_FILM_FILM_FOLDER_H
#define FACCIA_FILM_FILM_FOLDER_H

struct film_folder {
    char *path; /* NULL: none */
    int lock;
};

/* Removes PREFIX-XXXXXX whose process has gone. */
void film_folder_sweep(const char *prefix);

/* Makes PREFIX-XXXXXX, after a sweep. -1 with errno. */
int film_folder_make(struct film_folder *folder, const char *prefix);

/* Removes it with all that is in it. Does nothing if there is none. */
void film_folder_remove(struct film_folder *folder);

#endif
