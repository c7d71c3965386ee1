/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A program that a film needs (a browser, ffmpeg): started in a process group of its own, so that nothing of
 * it outlives the film. */
#ifndef FACCIA_FILM_FILM_PROCESS_H
#define FACCIA_FILM_FILM_PROCESS_H

#include "server/base/error.h"
#include <stdbool.h>
#include <stddef.h>
#include <uv.h>

struct film_process;

struct film_process_options {
    char *const *args; /* NULL-terminated; args[0] is looked for in PATH */
    int input;     /* descriptor of the child that film_process_write feeds; closing it ends the program */
    int given, as; /* a descriptor of ours, inherited as that number; given < 0: none */
    const char *folder;                  /* HOME of the program, and its working folder */
    const char *const *environment;      /* further variables, NULL-terminated; NULL: none */
    void (*ended)(void *ctx, bool well); /* the program has ended; never called after film_process_close */
    void *ctx;
};

/* Returns whether a program of that name is in PATH. */
bool film_process_found(const char *name);

/* NULL with *e ("film-failed"), which names the program. */
struct film_process *film_process_start(uv_loop_t *loop, const struct film_process_options *options,
                                        struct error *e);

/* Writes to its input; `done` is called when the program has taken the bytes, which must live until then.
 * status: negative if it cannot take them. */
void film_process_write(struct film_process *process, const void *bytes, size_t size,
                        void (*done)(void *ctx, int status), void *ctx);
void film_process_end_input(struct film_process *process);

/* The end of what it has printed on standard error, on one line; "" if nothing. */
const char *film_process_said(const struct film_process *process);

/* Asks the program to end (SIGTERM); `ended` follows. */
void film_process_interrupt(struct film_process *process);

/* Kills the whole group if it runs, and frees the process once the loop has run. NULL is allowed. */
void film_process_close(struct film_process *process);

#endif
