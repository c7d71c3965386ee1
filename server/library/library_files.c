/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/library/library_files.h"
#include "server/base/files.h"
#include "server/base/mem.h"
#include "server/library/cast.h"
#include "server/library/words.h"
#include "server/library/work_lexicons.h"
#include "server/library/works/work.h"
#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <openssl/evp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include <unistd.h>

char *library_file_path(const char *folder, const char *path) {
    struct buf out = {0};
    buf_printf(&out, "%s%s%s", folder, *folder && *path ? "/" : "", path);
    buf_add(&out, "", 1);
    return (char *)out.data;
}

/* Endings of recordings, in order of preference. */
static const char *const sound_endings[] = {".flac", ".wav", ".ogg", ".mp3", ".m4a", ".m4b", NULL};

static bool is_sound(const char *path) {
    const char *dot = strrchr(path, '.');
    const char *const *ending = sound_endings;
    while (dot && *ending && strcmp(*ending, dot) != 0)
        ending++;
    return dot && *ending;
}

static void add_to(struct library_file **list, size_t *count, size_t *cap, struct library_file file) {
    *list = mem_grow(*list, cap, *count + 1, sizeof **list);
    (*list)[(*count)++] = file;
}

static void add(struct library_files *files, const char *path, const struct stat *info, bool outside) {
    const struct library_file file = {mem_strdup(path), info->st_size,
                                      (int64_t)info->st_mtim.tv_sec * 1000000000 + info->st_mtim.tv_nsec,
                                      outside};
    if (work_is(path) || outside)
        add_to(&files->list, &files->count, &files->cap, file);
    else if (is_sound(path))
        add_to(&files->sounds, &files->sound_count, &files->sound_cap, file);
    else if (library_lexicon_is(path))
        add_to(&files->lexicons, &files->lexicon_count, &files->lexicon_cap, file);
    else if (cast_file_is(path))
        add_to(&files->casts, &files->cast_count, &files->cast_cap, file);
    else
        free(file.path);
}

/* Adds a link to a file if it stays in the folder. Links to folders are ignored: a folder inside is
 * visited at its real path. */
static void add_link(struct library_files *files, int root, const char *path, struct stat *info) {
    struct stat target;
    int fd = open_below_at(root, path, O_RDONLY), why = errno;
    if (fd >= 0 && !fstat(fd, &target) && S_ISREG(target.st_mode))
        add(files, path, &target, false);
    else if (fd < 0 && error_is_outside(why) && !fstatat(root, path, &target, 0) &&
             (S_ISDIR(target.st_mode) || work_is(path)))
        add(files, path, info, true);
    if (fd >= 0)
        close(fd);
}

/* Takes ownership of dir. Skips folders that cannot be read. */
static void walk(struct library_files *files, int root, DIR *dir, const char *below, int depth) {
    for (struct dirent *entry; (entry = readdir(dir));) {
        struct stat info;
        if (entry->d_name[0] == '.' || fstatat(dirfd(dir), entry->d_name, &info, AT_SYMLINK_NOFOLLOW))
            continue;
        char *path = library_file_path(below, entry->d_name);
        if (S_ISDIR(info.st_mode) && depth < FOLDER_DEPTH_MAX) {
            int fd = openat(dirfd(dir), entry->d_name, O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
            DIR *next = fd >= 0 ? fdopendir(fd) : NULL;
            if (next)
                walk(files, root, next, path, depth + 1);
            else if (fd >= 0)
                close(fd);
        } else if (S_ISREG(info.st_mode)) {
            add(files, path, &info, false);
        } else if (S_ISLNK(info.st_mode)) {
            add_link(files, root, path, &info);
        }
        free(path);
    }
    closedir(dir);
}

static int compare(const void *a, const void *b) {
    return strcmp(((const struct library_file *)a)->path, ((const struct library_file *)b)->path);
}

int library_files_list(struct library_files *files, const char *folder, struct error *e) {
    int root = open(folder, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    int fd = root >= 0 ? openat(root, ".", O_RDONLY | O_DIRECTORY | O_CLOEXEC) : -1;
    DIR *dir = fd >= 0 ? fdopendir(fd) : NULL;
    int result = dir ? 0 : error_set(e, ERROR_BAD_WORK, "%.150s: %.80s", folder, strerror(errno));
    if (dir)
        walk(files, root, dir, "", 0);
    else if (fd >= 0)
        close(fd);
    if (root >= 0)
        close(root);
    if (files->count)
        qsort(files->list, files->count, sizeof *files->list, compare);
    if (files->sound_count)
        qsort(files->sounds, files->sound_count, sizeof *files->sounds, compare);
    if (files->lexicon_count)
        qsort(files->lexicons, files->lexicon_count, sizeof *files->lexicons, compare);
    if (files->cast_count)
        qsort(files->casts, files->cast_count, sizeof *files->casts, compare);
    return result;
}

void library_files_free(struct library_files *files) {
    for (size_t i = 0; i < files->count; i++)
        free(files->list[i].path);
    free(files->list);
    for (size_t i = 0; i < files->sound_count; i++)
        free(files->sounds[i].path);
    free(files->sounds);
    for (size_t i = 0; i < files->lexicon_count; i++)
        free(files->lexicons[i].path);
    free(files->lexicons);
    for (size_t i = 0; i < files->cast_count; i++)
        free(files->casts[i].path);
    free(files->casts);
    *files = (struct library_files){0};
}

bool library_files_has(const struct library_files *files, const char *path) {
    const struct library_file key = {.path = (char *)path};
    return (files->count && bsearch(&key, files->list, files->count, sizeof key, compare)) ||
           (files->cast_count && bsearch(&key, files->casts, files->cast_count, sizeof key, compare));
}

const struct library_file *library_files_sound(const struct library_files *files, const char *path) {
    const char *dot = strrchr(path, '.');
    const struct library_file *found = NULL;
    for (const char *const *ending = sound_endings; dot && files->sound_count && *ending && !found;
         ending++) {
        struct buf name = {0};
        buf_printf(&name, "%.*s%s", (int)(dot - path), path, *ending);
        buf_add(&name, "", 1);
        const struct library_file key = {.path = (char *)name.data};
        found = bsearch(&key, files->sounds, files->sound_count, sizeof key, compare);
        buf_free(&name);
    }
    return found;
}

bool library_file_hash(const char *folder, const char *path, char out[65]) {
    unsigned char data[65536], digest[32];
    unsigned length = 0;
    FILE *file = folder ? open_file_below(folder, path) : fopen(path, "rb");
    EVP_MD_CTX *context = EVP_MD_CTX_new();
    size_t got;
    EVP_DigestInit_ex(context, EVP_sha256(), NULL);
    while (file && (got = fread(data, 1, sizeof data, file)))
        EVP_DigestUpdate(context, data, got);
    bool well = file && !ferror(file) && EVP_DigestFinal_ex(context, digest, &length);
    for (unsigned i = 0; i < 32 && well; i++)
        snprintf(out + 2 * (size_t)i, 3, "%02x", digest[i]);
    EVP_MD_CTX_free(context);
    if (file)
        fclose(file);
    return well;
}

void library_file_name(const char *path, bool with_ending, char out[64]) {
    const char *slash = strrchr(path, '/'), *dot = strrchr(path, '.');
    size_t size = !with_ending && dot && (!slash || dot > slash) ? (size_t)(dot - path) : strlen(path);
    size_t length = 0;
    struct word word;
    for (size_t at = 0; words_next(path, size, false, &at, &word);) {
        if (length + 1 < 60 && length)
            out[length++] = '-';
        for (const char *c = word.folded; *c && length < 60; c++)
            if ((*c >= 'a' && *c <= 'z') || (*c >= '0' && *c <= '9'))
                out[length++] = *c;
    }
    while (length && out[length - 1] == '-')
        length--;
    out[length] = '\0';
    if (!length)
        memcpy(out, "work", 5);
}

const char *library_files_work(const struct library_files *files, const char *work) {
    char name[64];
    for (size_t i = 0; i < files->count; i++) {
        library_file_name(files->list[i].path, false, name);
        if (!strcmp(name, work) || !strcmp(files->list[i].path, work))
            return files->list[i].path;
    }
    return NULL;
}

/* Returns the canonical path of an open file. */
static bool path_of(int fd, char out[PATH_MAX]) {
    char link[32];
    snprintf(link, sizeof link, "/proc/self/fd/%d", fd);
    ssize_t length = readlink(link, out, PATH_MAX - 1);
    out[length < 0 ? 0 : length] = '\0';
    return *out == '/';
}

bool library_file_beside(const char *folder, const char *path, const char *ending, char out[PATH_MAX]) {
    const char *dot = strrchr(path, '.');
    char file[PATH_MAX];
    struct stat info;
    if (!dot || snprintf(file, sizeof file, "%.*s%s", (int)(dot - path), path, ending) >= (int)sizeof file)
        return false;
    int fd = open_below(folder, file, O_RDONLY);
    bool found = fd >= 0 && !fstat(fd, &info) && S_ISREG(info.st_mode) && path_of(fd, out);
    if (fd >= 0)
        close(fd);
    return found;
}

bool library_file_speaks(const char *folder, const char *path) {
    enum { DIRECTORY_BYTES = 256 << 10 }; /* names are at the end of an archive, uncompressed */
    static const char sign[] = ".smil";
    const char *dot = strrchr(path, '.');
    struct stat info;
    int fd = dot && !strcasecmp(dot, ".epub") ? open_below(folder, path, O_RDONLY) : -1;
    bool found = false;
    if (fd >= 0 && !fstat(fd, &info) && S_ISREG(info.st_mode)) {
        char *end = mem_alloc(DIRECTORY_BYTES);
        off_t from = info.st_size > DIRECTORY_BYTES ? info.st_size - DIRECTORY_BYTES : 0;
        ssize_t size = pread(fd, end, DIRECTORY_BYTES, from);
        found = size > 0 && memmem(end, (size_t)size, sign, sizeof sign - 1);
        free(end);
    }
    if (fd >= 0)
        close(fd);
    return found;
}

bool library_file_sound(const char *folder, const char *path, char out[PATH_MAX]) {
    for (const char *const *ending = sound_endings; *ending; ending++)
        if (library_file_beside(folder, path, *ending, out))
            return true;
    return library_file_speaks(folder, path) && library_file_beside(folder, path, strrchr(path, '.'), out);
}

bool library_file_has_sound(const char *folder, const char *path) {
    char sound[PATH_MAX];
    return library_file_sound(folder, path, sound);
}
