/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A folder of documents by name, that clients fetch, save and remove: one file each. A file is replaced as a
 * whole or not at all, also when the machine stops meanwhile; who saves says which content he has seen, so
 * that nobody loses what another has saved. Several threads and processes may use one folder: who changes it
 * locks it. All of it may block. */
#ifndef FACCIA_BASE_SHELF_H
#define FACCIA_BASE_SHELF_H

#include "server/base/buf.h"
#include "server/base/error.h"
#include "server/base/etag.h"
#include <stdbool.h>
#include <time.h>

enum { DOCUMENT_NAME_BYTES = 65 }; /* with the NUL */

struct document_store {
    const char *folder;      /* NULL: there is none; every call says "nothing-kept" */
    const char *suffix;      /* of its files, as in ".json"; other files are not looked at */
    enum error_code unknown; /* no document has that name */
    size_t most_bytes;       /* of one document */
    size_t most;             /* documents */
};

/* What is called when a document was saved or removed. */
struct document_store_listener {
    void (*changed)(void *ctx); /* NULL: nobody wants to know */
    void *ctx;
};

/* What a change rests on; one of them has to be said where the document is there: "condition-needed". */
struct document_condition {
    const char *match; /* list of tags (If-Match), of which it must have one, or "*"; NULL: not said */
    bool absent;       /* it must not be there yet (If-None-Match: *) */
};

struct document_entry {
    char name[DOCUMENT_NAME_BYTES];
    size_t bytes;
    time_t saved;
};

/* 1 to 64 ASCII letters, digits, "-", "_", ".", not beginning with a full stop. -1 with *e: "bad-field" in
 * "name". */
int document_check_name(const char *name, struct error *e);

/* What follows returns 0, or -1 with *e: "nothing-kept", "bad-field", the shelf's unknown, "changed" (the
 * condition does not hold), "condition-needed", "document-too-long", "shelf-full", "cannot-keep" (the disk
 * does not do it). */

/* Appends the document to *out. */
int document_store_read(const struct document_store *shelf, const char *name, struct buf *out, char tag[ETAG_BYTES],
               struct error *e);
/* *created: it was not there before. */
int document_store_save(const struct document_store *shelf, const char *name, const void *data, size_t size,
               struct document_condition condition, char tag[ETAG_BYTES], bool *created, struct error *e);
int document_store_remove(const struct document_store *shelf, const char *name, struct document_condition condition,
                 struct error *e);

/* All of them, by name; free *entries with free. */
int document_store_list(const struct document_store *shelf, struct document_entry **entries, size_t *count, struct error *e);

#endif
