/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/access/token.h"
#include "server/base/log.h"
#include "server/base/mem.h"
#include <errno.h>
#include <libgen.h>
#include <openssl/evp.h>
#include <openssl/hmac.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

static bool others_write(const struct stat *status) {
    return status->st_mode & (S_IWGRP | S_IWOTH);
}

/* Whoever can write or replace the file can forge tokens, so only its owner may. */
static int check_file(FILE *file, const char *path, bool secret, struct error *e) {
    struct stat status, folder;
    char *real = realpath(path, NULL), *parent = real ? dirname(real) : NULL;
    bool open_folder =
        parent && !stat(parent, &folder) && others_write(&folder) && !(folder.st_mode & S_ISVTX);
    int result = 0;
    if (fstat(fileno(file), &status))
        result = error_set(e, ERROR_BAD_SECRETS, "%s: %s", path, strerror(errno));
    else if (S_ISDIR(status.st_mode))
        result = error_set(e, ERROR_BAD_SECRETS, "%s: is a folder, not a file of secrets", path);
    else if (S_ISREG(status.st_mode) && others_write(&status))
        result = error_set(e, ERROR_BAD_SECRETS,
                           "%s: users other than its owner can write it (mode %03o); run 'chmod 600'", path,
                           (unsigned)(status.st_mode & 0777));
    else if (S_ISREG(status.st_mode) && open_folder)
        result = error_set(
            e, ERROR_BAD_SECRETS,
            "%s: users other than its owner can replace it, because they can write its folder (mode %03o)",
            path, (unsigned)(folder.st_mode & 0777));
    else if (secret && S_ISREG(status.st_mode) && status.st_mode & S_IROTH)
        log_warn("%s: every user of this machine can read the secrets; run 'chmod 600'", path);
    free(real);
    return result;
}

FILE *secrets_file_open(const char *path, bool secret, struct error *e) {
    FILE *file = fopen(path, "r");
    if (!file) {
        error_set(e, ERROR_BAD_SECRETS, "%s: %s", path, strerror(errno));
    } else if (check_file(file, path, secret, e)) {
        fclose(file);
        file = NULL;
    }
    return file;
}

void secrets_add(struct secrets *secrets, const char *secret) {
    secrets->list = mem_resize(secrets->list, (secrets->count + 1) * sizeof *secrets->list);
    secrets->list[secrets->count++] = mem_strdup(secret);
}

static int read_lines(struct secrets *secrets, FILE *file, const char *path, struct error *e) {
    char *line = NULL;
    size_t cap = 0, number = 0;
    int result = 0;
    for (ssize_t n; !result && (n = getline(&line, &cap, file)) >= 0;) {
        number++;
        n = (ssize_t)strcspn(line, "\r\n");
        if (!n)
            continue;
        line[n] = '\0';
        if (n < SECRET_BYTES_MIN) {
            result = error_at_line(e, ERROR_BAD_SECRETS, number, 1,
                                   "%s: a secret must have at least %d bytes", path, SECRET_BYTES_MIN);
            break;
        }
        secrets_add(secrets, line);
    }
    free(line);
    if (!result && !secrets->count)
        result = error_set(e, ERROR_BAD_SECRETS, "%s: contains no secret", path);
    return result;
}

int secrets_load(struct secrets *secrets, const char *path, struct error *e) {
    *secrets = (struct secrets){0};
    FILE *file = secrets_file_open(path, true, e);
    if (!file)
        return -1;
    int result = read_lines(secrets, file, path, e);
    fclose(file);
    if (result)
        secrets_free(secrets);
    return result;
}

void secrets_free(struct secrets *secrets) {
    for (size_t i = 0; i < secrets->count; i++)
        free(secrets->list[i]);
    free(secrets->list);
    *secrets = (struct secrets){0};
}

/* FNV-1a: the number stays in this process, so it need not resist attacks. */
uint64_t secret_number(const char *secret) {
    uint64_t number = 14695981039346656037u;
    for (; *secret; secret++)
        number = (number ^ (unsigned char)*secret) * 1099511628211u;
    return number;
}

bool secrets_have(const struct secrets *secrets, uint64_t number) {
    for (size_t i = 0; i < secrets->count; i++)
        if (secret_number(secrets->list[i]) == number)
            return true;
    return false;
}

void secret_mark(const char *secret, char mark[SECRET_MARK_BYTES]) {
    static const unsigned char text[] = "faccia: this secret is revoked";
    unsigned char digest[EVP_MAX_MD_SIZE];
    HMAC(EVP_sha256(), secret, (int)strlen(secret), text, sizeof text - 1, digest, NULL);
    for (size_t i = 0; i < (SECRET_MARK_BYTES - 1) / 2; i++)
        snprintf(mark + 2 * i, 3, "%02x", digest[i]);
}

static bool has(const struct secrets_revoked *revoked, const char *mark) {
    for (size_t i = 0; i < revoked->count; i++)
        if (!strcmp(revoked->marks[i], mark))
            return true;
    return false;
}

bool secrets_revoked_add(struct secrets_revoked *revoked, const char *mark) {
    if (strlen(mark) != SECRET_MARK_BYTES - 1 || has(revoked, mark))
        return false;
    revoked->marks = mem_resize(revoked->marks, (revoked->count + 1) * sizeof *revoked->marks);
    memcpy(revoked->marks[revoked->count++], mark, SECRET_MARK_BYTES);
    return true;
}

struct secrets secrets_good(const struct secrets *secrets, const struct secrets_revoked *revoked) {
    struct secrets good = {0};
    for (size_t i = 0; secrets && i < secrets->count; i++) {
        char mark[SECRET_MARK_BYTES];
        secret_mark(secrets->list[i], mark);
        if (!has(revoked, mark))
            secrets_add(&good, secrets->list[i]);
    }
    return good;
}
