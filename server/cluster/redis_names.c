/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/cluster/redis_names.h"
#include <openssl/evp.h>
#include <openssl/rand.h>
#include <stdio.h>

static void write_hex(const unsigned char *bytes, size_t count, char *out) {
    for (size_t i = 0; i < count; i++)
        snprintf(out + 2 * i, 3, "%02x", bytes[i]);
}

void redis_names_of(const struct buf *key, struct redis_names *names) {
    unsigned char digest[EVP_MAX_MD_SIZE];
    unsigned count = 0;
    char hex[2 * EVP_MAX_MD_SIZE + 1] = "";
    EVP_Digest(key->data, key->size, digest, &count, EVP_sha256(), NULL);
    write_hex(digest, count, hex);
    snprintf(names->value, sizeof names->value, "faccia:{%.64s}:speech", hex);
    snprintf(names->claim, sizeof names->claim, "faccia:{%.64s}:making", hex);
}

void redis_id_make(char id[REDIS_ID_BYTES]) {
    unsigned char bytes[(REDIS_ID_BYTES - 1) / 2];
    RAND_bytes(bytes, sizeof bytes);
    write_hex(bytes, sizeof bytes, id);
}
