/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/api/documents/document_store.h"
#include "server/base/files.h"
#include "server/base/mem.h"
#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

/* File being written; no document's name begins with ".". */
static const char part[] = ".part";

static int cannot(struct error *e, const char *what) {
    return error_set(e, ERROR_CANNOT_KEEP, "%s: %s", what, strerror(errno));
}

int document_check_name(const char *name, struct error *e) {
    size_t size = strspn(name, "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_.");
    if (!size || name[size] || size >= DOCUMENT_NAME_BYTES || *name == '.')
        return error_in_field(e, ERROR_BAD_FIELD, "name",
                              "a name must have 1 to 64 ASCII letters, digits, '-', '_' or '.', and must not "
                              "begin with a full stop");
    return 0;
}

/* Opens the folder; -1 with *e. */
static int open_folder(const struct document_store *store, bool locked, struct error *e) {
    if (!store->folder)
        return error_plain(e, ERROR_NOTHING_KEPT);
    int folder = open(store->folder, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (folder < 0)
        return cannot(e, store->folder);
    int refused = 0;
    while (locked && (refused = flock(folder, LOCK_EX)) && errno == EINTR)
        ;
    if (!refused)
        return folder;
    cannot(e, store->folder);
    close(folder);
    return -1;
}

static void file_of(const struct document_store *store, const char *name,
                    char file[DOCUMENT_NAME_BYTES + 16]) {
    snprintf(file, DOCUMENT_NAME_BYTES + 16, "%s%s", name, store->suffix);
}

static int read_all(int fd, size_t most, struct buf *out, struct error *e) {
    size_t before = out->size;
    for (;;) {
        ssize_t got = read(fd, buf_reserve(out, 65536), 65536);
        if (got < 0 && errno == EINTR)
            continue;
        if (got < 0)
            return cannot(e, "reading");
        out->size += (size_t)got;
        if (out->size - before > most)
            return error_set(e, ERROR_DOCUMENT_TOO_LONG, "a document may have at most %zu bytes", most);
        if (!got)
            return 0;
    }
}

/* 1: read; 0: no such document; -1 with *e. Does not follow links, so that documents cannot point
 * elsewhere. */
static int read_file(const struct document_store *store, int folder, const char *name, struct buf *out,
                     struct error *e) {
    char file[DOCUMENT_NAME_BYTES + 16];
    struct stat about;
    file_of(store, name, file);
    int fd = openat(folder, file, O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
    if (fd < 0)
        return errno == ENOENT || errno == ELOOP ? 0 : cannot(e, file);
    int result = fstat(fd, &about) || !S_ISREG(about.st_mode) ? 0 : 1;
    if (result && read_all(fd, store->most_bytes, out, e))
        result = -1;
    close(fd);
    return result;
}

/* Opens and locks the folder and checks the condition. Returns its descriptor, or -1. *there: the document
 * exists. */
static int open_for_change(const struct document_store *store, const char *name,
                           struct document_condition condition, bool *there, struct error *e) {
    struct buf now = {0};
    char tag[ETAG_BYTES];
    if (document_check_name(name, e))
        return -1;
    int folder = open_folder(store, true, e);
    int found = folder < 0 ? -1 : read_file(store, folder, name, &now, e);
    int refused = found < 0 ? -1 : 0;
    etag_of(now.data, now.size, tag);
    buf_free(&now);
    if (found > 0 && condition.absent)
        refused = error_set(e, ERROR_CHANGED, "the document already exists: %s", tag);
    else if (found > 0 && !condition.match)
        refused = error_plain(e, ERROR_CONDITION_NEEDED);
    else if (found > 0 && !etag_listed(condition.match, tag))
        refused = error_set(e, ERROR_CHANGED, "the document has changed since: it is now %s", tag);
    else if (!found && condition.match)
        refused = error_set(e, ERROR_CHANGED, "it does not exist, or no longer exists");
    *there = found > 0;
    if (refused && folder >= 0)
        close(folder);
    return refused ? -1 : folder;
}

static int is_document(const struct document_store *store, const char *file) {
    size_t size = strlen(file), suffix = strlen(store->suffix);
    return *file != '.' && size > suffix && size - suffix < DOCUMENT_NAME_BYTES &&
           !strcmp(file + size - suffix, store->suffix);
}

int document_store_list(const struct document_store *store, struct document_entry **entries, size_t *count,
                        struct error *e) {
    struct dirent **files;
    struct error unused;
    struct stat about;
    *entries = NULL;
    *count = 0;
    int folder = open_folder(store, false, e);
    if (folder < 0)
        return -1;
    int found = scandirat(folder, ".", &files, NULL, alphasort);
    for (int i = 0; i < found; i++) {
        const char *file = files[i]->d_name;
        struct document_entry entry = {.bytes = 0};
        if (*count < store->most && is_document(store, file) &&
            !fstatat(folder, file, &about, AT_SYMLINK_NOFOLLOW) && S_ISREG(about.st_mode)) {
            snprintf(entry.name, sizeof entry.name, "%.*s", (int)(strlen(file) - strlen(store->suffix)),
                     file);
            entry.bytes = (size_t)about.st_size;
            entry.saved = about.st_mtime;
            if (!document_check_name(entry.name, &unused)) {
                *entries = mem_resize(*entries, (*count + 1) * sizeof entry);
                (*entries)[(*count)++] = entry;
            }
        }
        free(files[i]);
    }
    if (found >= 0)
        free(files);
    close(folder);
    return found < 0 ? cannot(e, store->folder) : 0;
}

int document_store_read(const struct document_store *store, const char *name, struct buf *out,
                        char tag[ETAG_BYTES], struct error *e) {
    size_t before = out->size;
    if (document_check_name(name, e))
        return -1;
    int folder = open_folder(store, false, e);
    int found = folder < 0 ? -1 : read_file(store, folder, name, out, e);
    if (folder >= 0)
        close(folder);
    if (!found)
        return error_plain_in_field(e, store->unknown, "name");
    etag_of(out->data ? out->data + before : NULL, out->size - before, tag);
    return found < 0 ? -1 : 0;
}

/* Syncs the new file to disk before it replaces the old one. */
static int replace(int folder, const char *file, const void *data, size_t size, struct error *e) {
    unlinkat(folder, part, 0); /* left by a process that was killed */
    int fd = openat(folder, part, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0644);
    bool well = fd >= 0 && write_all(fd, data, size) && !fsync(fd);
    if (fd >= 0)
        well = !close(fd) && well;
    well = well && !renameat(folder, part, folder, file) && !fsync(folder);
    if (well)
        return 0;
    cannot(e, file);
    unlinkat(folder, part, 0);
    return -1;
}

int document_store_save(const struct document_store *store, const char *name, const void *data, size_t size,
                        struct document_condition condition, char tag[ETAG_BYTES], bool *created,
                        struct error *e) {
    char file[DOCUMENT_NAME_BYTES + 16];
    struct document_entry *entries = NULL;
    size_t count = 0;
    bool there;
    if (size > store->most_bytes)
        return error_set(e, ERROR_DOCUMENT_TOO_LONG, "a document may have at most %zu bytes",
                         store->most_bytes);
    int folder = open_for_change(store, name, condition, &there, e);
    if (folder < 0)
        return -1;
    int failed = there ? 0 : document_store_list(store, &entries, &count, e);
    free(entries);
    if (!failed && !there && count >= store->most)
        failed = error_set(e, ERROR_STORE_FULL, "the limit of %zu documents is reached", count);
    file_of(store, name, file);
    if (!failed)
        failed = replace(folder, file, data, size, e);
    close(folder);
    etag_of(data, size, tag);
    *created = !there;
    return failed;
}

int document_store_remove(const struct document_store *store, const char *name,
                          struct document_condition condition, struct error *e) {
    char file[DOCUMENT_NAME_BYTES + 16];
    bool there;
    int folder = open_for_change(store, name, condition, &there, e);
    if (folder < 0)
        return -1;
    file_of(store, name, file);
    int failed = !there                      ? error_plain_in_field(e, store->unknown, "name")
                 : unlinkat(folder, file, 0) ? cannot(e, file)
                                             : 0;
    close(folder);
    return failed;
}
