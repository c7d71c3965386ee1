/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A folder of named documents that clients read, save and remove, one file each. Files are replaced
 * atomically, even if the machine crashes. A client that saves a document states which version it has
 * seen, so that no change is lost. Threads and processes may share a folder: changes lock it. All
 * functions may block. */
#ifndef FACCIA_API_DOCUMENTS_DOCUMENT_STORE_H
#define FACCIA_API_DOCUMENTS_DOCUMENT_STORE_H

#include "server/base/buf.h"
#include "server/base/error.h"
#include "server/base/etag.h"
#include <stdbool.h>
#include <time.h>

enum { DOCUMENT_NAME_BYTES = 65 }; /* including the NUL */

struct document_store {
    const char *folder;      /* NULL: disabled; every call fails with "nothing-kept" */
    const char *suffix;      /* of its files, such as ".json"; other files are ignored */
    enum error_code unknown; /* error for an unknown name */
    size_t most_bytes;       /* maximum size of a document */
    size_t most;             /* maximum number of documents */
};

/* Notified after a document was saved or removed. */
struct document_store_listener {
    void (*changed)(void *ctx); /* may be NULL */
    void *ctx;
};

/* Precondition of a change. Changing an existing document requires one of the members, or fails with
 * "condition-needed". */
struct document_condition {
    const char *match; /* If-Match: entity tags, or "*"; NULL: absent */
    bool absent;       /* the document must not exist yet (If-None-Match: *) */
};

struct document_entry {
    char name[DOCUMENT_NAME_BYTES];
    size_t bytes;
    time_t saved;
};

/* Checks that the name is 1 to 64 ASCII letters, digits, "-", "_", ".", and does not start with ".".
 * Returns -1 with *e: "bad-field" in "name". */
int document_check_name(const char *name, struct error *e);

/* The functions below return 0, or -1 with *e: "nothing-kept", "bad-field", the store's `unknown`,
 * "changed" (the precondition fails), "condition-needed", "document-too-long", "store-full", "cannot-keep"
 * (a disk error). */

/* Appends the document to *out. */
int document_store_read(const struct document_store *store, const char *name, struct buf *out,
                        char tag[ETAG_BYTES], struct error *e);
/* *created: true if the document is new. */
int document_store_save(const struct document_store *store, const char *name, const void *data, size_t size,
                        struct document_condition condition, char tag[ETAG_BYTES], bool *created,
                        struct error *e);
int document_store_remove(const struct document_store *store, const char *name,
                          struct document_condition condition, struct error *e);

/* Lists the documents by name; the caller frees *entries. */
int document_store_list(const struct document_store *store, struct document_entry **entries, size_t *count,
                        struct error *e);

#endif
