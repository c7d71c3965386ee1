/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/library/library_files.h"
#include "server/base/mem.h"
#include "server/library/words.h"
#include "server/library/work.h"
#include <dirent.h>
#include <errno.h>
#include <openssl/evp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

char *library_file_path(const char *folder, const char *path) {
    struct buf out = {0};
    buf_printf(&out, "%s%s%s", folder, *folder && *path ? "/" : "", path);
    buf_add(&out, "", 1);
    return (char *)out.data;
}

/* Of a recording; the first one counts where there are several. */
static const char *const sound_endings[] = {".flac", ".wav", ".ogg", ".mp3", NULL};

static bool is_sound(const char *path) {
    const char *dot = strrchr(path, '.');
    const char *const *ending = sound_endings;
    while (dot && *ending && strcmp(*ending, dot) != 0)
        ending++;
    return dot && *ending;
}

static void add(struct library_files *files, const char *path, const struct stat *info) {
    const struct library_file file = {mem_strdup(path), info->st_size,
                                      (int64_t)info->st_mtim.tv_sec * 1000000000 + info->st_mtim.tv_nsec};
    if (work_is(path)) {
        files->list = mem_grow(files->list, &files->cap, files->count + 1, sizeof *files->list);
        files->list[files->count++] = file;
    } else if (is_sound(path)) {
        files->sounds =
            mem_grow(files->sounds, &files->sound_cap, files->sound_count + 1, sizeof *files->sounds);
        files->sounds[files->sound_count++] = file;
    } else {
        free(file.path);
    }
}

/* Folders below that cannot be read are passed over: the rest of the library goes on. */
static int walk(struct library_files *files, const char *folder, const char *below, int depth,
                struct error *e) {
    char *full = library_file_path(folder, below);
    DIR *dir = opendir(full);
    if (!dir && !depth)
        error_set(e, ERROR_BAD_WORK, "%.150s: %.80s", full, strerror(errno));
    for (struct dirent *entry; dir && (entry = readdir(dir));) {
        struct stat info;
        if (entry->d_name[0] == '.')
            continue;
        char *path = library_file_path(below, entry->d_name), *whole = library_file_path(folder, path);
        if (!stat(whole, &info)) {
            if (S_ISDIR(info.st_mode) && depth < FOLDER_DEPTH_MAX)
                walk(files, folder, path, depth + 1, e);
            else if (S_ISREG(info.st_mode))
                add(files, path, &info);
        }
        free(path);
        free(whole);
    }
    free(full);
    if (dir)
        closedir(dir);
    return dir || depth ? 0 : -1;
}

static int compare(const void *a, const void *b) {
    return strcmp(((const struct library_file *)a)->path, ((const struct library_file *)b)->path);
}

int library_files_list(struct library_files *files, const char *folder, struct error *e) {
    int result = walk(files, folder, "", 0, e);
    if (files->count)
        qsort(files->list, files->count, sizeof *files->list, compare);
    if (files->sound_count)
        qsort(files->sounds, files->sound_count, sizeof *files->sounds, compare);
    return result;
}

void library_files_free(struct library_files *files) {
    for (size_t i = 0; i < files->count; i++)
        free(files->list[i].path);
    free(files->list);
    for (size_t i = 0; i < files->sound_count; i++)
        free(files->sounds[i].path);
    free(files->sounds);
    *files = (struct library_files){0};
}

bool library_files_has(const struct library_files *files, const char *path) {
    const struct library_file key = {.path = (char *)path};
    return files->count && bsearch(&key, files->list, files->count, sizeof key, compare);
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

bool library_file_hash(const char *path, char out[65]) {
    unsigned char data[65536], digest[32];
    unsigned length = 0;
    FILE *file = fopen(path, "rb");
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

bool library_file_sound(const char *path, char out[PATH_MAX]) {
    const char *dot = strrchr(path, '.');
    char file[PATH_MAX];
    for (const char *const *ending = sound_endings; dot && *ending; ending++) {
        bool fits = snprintf(file, sizeof file, "%.*s%s", (int)(dot - path), path, *ending) < PATH_MAX;
        if (fits && !access(file, R_OK) && realpath(file, out))
            return true;
    }
    return false;
}

bool library_file_has_sound(const char *path) {
    char sound[PATH_MAX];
    return library_file_sound(path, sound);
}
