/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/access/secrets.h"
#include "server/base/mem.h"
#include <openssl/evp.h>
#include <openssl/hmac.h>
#include <stdio.h>
#include <string.h>

void secret_mark(const char *secret, char mark[SECRET_MARK_BYTES]) {
    static const unsigned char text[] = "faccia: this secret counts no more";
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
