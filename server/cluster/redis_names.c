/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/cluster/redis_names.h"
#include <openssl/evp.h>
#include <openssl/rand.h>
#include <stdio.h>

static void write_hex(const unsigned char *bytes, size_t count, char *out) {
    for (size_t i = 0; i < count; i++)
        snprintf(out + 2 * i, 3, "%02x", bytes[i]);
}

void redis_hash_of(const struct buf *key, char hex[REDIS_HASH_BYTES]) {
    unsigned char digest[EVP_MAX_MD_SIZE];
    EVP_Digest(key->data, key->size, digest, NULL, EVP_sha256(), NULL);
    write_hex(digest, (REDIS_HASH_BYTES - 1) / 2, hex);
}

void redis_names_of(const struct buf *key, struct redis_names *names) {
    char hex[REDIS_HASH_BYTES];
    redis_hash_of(key, hex);
    snprintf(names->value, sizeof names->value, "faccia:{%s}:speech", hex);
    snprintf(names->claim, sizeof names->claim, "faccia:{%s}:making", hex);
}

void redis_id_make(char id[REDIS_ID_BYTES]) {
    unsigned char bytes[(REDIS_ID_BYTES - 1) / 2];
    RAND_bytes(bytes, sizeof bytes);
    write_hex(bytes, sizeof bytes, id);
}
