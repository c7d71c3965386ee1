/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/http/certificate.h"
#include "server/base/buf.h"
#include <arpa/inet.h>
#include <errno.h>
#include <fcntl.h>
#include <ifaddrs.h>
#include <net/if.h>
#include <openssl/err.h>
#include <openssl/pem.h>
#include <openssl/rand.h>
#include <openssl/x509v3.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

enum { DAYS = 825, WEEK = 7 * 24 * 3600 };

/* Only letters, digits, "-" and "." may enter the list of names, whose syntax uses commas. */
static bool is_name(const char *name) {
    return *name && !name[strspn(name, "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-.")];
}

static void add_addresses(struct buf *names) {
    struct ifaddrs *list = NULL;
    char text[INET6_ADDRSTRLEN];
    if (getifaddrs(&list))
        return;
    for (const struct ifaddrs *a = list; a; a = a->ifa_next) {
        const void *at = NULL;
        if (!a->ifa_addr || a->ifa_flags & IFF_LOOPBACK)
            continue;
        if (a->ifa_addr->sa_family == AF_INET)
            at = &((const struct sockaddr_in *)a->ifa_addr)->sin_addr;
        else if (a->ifa_addr->sa_family == AF_INET6)
            at = &((const struct sockaddr_in6 *)a->ifa_addr)->sin6_addr;
        if (at && inet_ntop(a->ifa_addr->sa_family, at, text, sizeof text))
            buf_printf(names, ",IP:%s", text);
    }
    freeifaddrs(list);
}

/* Lists the names of this machine: its host name, its name on the local network (mDNS) and its addresses. */
static void names_of_machine(struct buf *names, char host[256]) {
    buf_printf(names, "DNS:localhost,IP:127.0.0.1,IP:::1");
    if (gethostname(host, 255) || !is_name(host))
        strcpy(host, "localhost");
    else
        buf_printf(names, ",DNS:%s%s%s%s", host,
                   strchr(host, '.') ? "" : ",DNS:", strchr(host, '.') ? "" : host,
                   strchr(host, '.') ? "" : ".local");
    add_addresses(names);
}

static bool extend(X509 *x, X509 *issuer, int kind, const char *value) {
    X509V3_CTX about;
    X509V3_set_ctx_nodb(&about);
    X509V3_set_ctx(&about, issuer, x, NULL, NULL, 0);
    X509_EXTENSION *extension = X509V3_EXT_conf_nid(NULL, &about, kind, value);
    bool added = extension && X509_add_ext(x, extension, -1);
    X509_EXTENSION_free(extension);
    return added;
}

static bool set_name(X509_NAME *name, const char *common) {
    return X509_NAME_add_entry_by_txt(name, "O", MBSTRING_ASC, (const unsigned char *)"faccia", -1, -1, 0) &&
           X509_NAME_add_entry_by_txt(name, "CN", MBSTRING_ASC, (const unsigned char *)common, -1, -1, 0);
}

/* Sets serial number, validity, key and subject. Returns NULL if OpenSSL fails. */
static X509 *begin(EVP_PKEY *key, const char *common) {
    unsigned char number[16];
    X509 *x = X509_new();
    bool made = x && RAND_bytes(number, sizeof number) == 1;
    number[0] &= 0x7F; /* serial numbers are positive */
    BIGNUM *serial = made ? BN_bin2bn(number, sizeof number, NULL) : NULL;
    made = serial && BN_to_ASN1_INTEGER(serial, X509_get_serialNumber(x)) && X509_set_version(x, 2) &&
           X509_gmtime_adj(X509_getm_notBefore(x), -3600) &&
           X509_gmtime_adj(X509_getm_notAfter(x), (long)DAYS * 24 * 3600) && X509_set_pubkey(x, key) &&
           set_name(X509_get_subject_name(x), common);
    BN_free(serial);
    if (made)
        return x;
    X509_free(x);
    return NULL;
}

/* Makes an authority that signs one certificate. It can sign no other once its key is discarded. */
static X509 *make_authority(EVP_PKEY *key, const char *host) {
    char common[300];
    snprintf(common, sizeof common, "faccia on %.40s", host);
    X509 *x = begin(key, common);
    if (x && X509_set_issuer_name(x, X509_get_subject_name(x)) &&
        extend(x, x, NID_basic_constraints, "critical,CA:TRUE,pathlen:0") &&
        extend(x, x, NID_key_usage, "critical,keyCertSign") &&
        extend(x, x, NID_subject_key_identifier, "hash") && X509_sign(x, key, EVP_sha256()))
        return x;
    X509_free(x);
    return NULL;
}

static X509 *certify(EVP_PKEY *key, X509 *ca, EVP_PKEY *ca_key, const char *names, const char *host) {
    char common[65];
    snprintf(common, sizeof common, "%s", host);
    X509 *x = begin(key, common);
    if (x && X509_set_issuer_name(x, X509_get_subject_name(ca)) &&
        extend(x, ca, NID_subject_alt_name, names) &&
        extend(x, ca, NID_basic_constraints, "critical,CA:FALSE") &&
        extend(x, ca, NID_key_usage, "critical,digitalSignature") &&
        extend(x, ca, NID_ext_key_usage, "serverAuth") &&
        extend(x, ca, NID_authority_key_identifier, "keyid:always") && X509_sign(x, ca_key, EVP_sha256()))
        return x;
    X509_free(x);
    return NULL;
}

/* Creates the file with its final mode, so that a key is never readable by others. */
static FILE *create(const char *path, mode_t mode) {
    unlink(path);
    int fd = open(path, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC | O_NOFOLLOW, mode);
    FILE *file = fd < 0 ? NULL : fdopen(fd, "w");
    if (fd >= 0 && !file)
        close(fd);
    return file;
}

/* Writes the key and the certificates that are not NULL. */
static bool write_file(const char *path, mode_t mode, EVP_PKEY *key, X509 *first, X509 *second) {
    FILE *file = create(path, mode);
    bool written = file && (!key || PEM_write_PrivateKey(file, key, NULL, NULL, 0, NULL, NULL) == 1) &&
                   (!first || PEM_write_X509(file, first) == 1) &&
                   (!second || PEM_write_X509(file, second) == 1);
    return file && !fclose(file) && written;
}

int certificate_make(const struct certificate_files *files, struct error *e) {
    struct buf names = {0};
    char host[256] = "";
    names_of_machine(&names, host);
    EVP_PKEY *key = EVP_EC_gen("P-256"), *ca_key = EVP_EC_gen("P-256");
    X509 *ca = key && ca_key ? make_authority(ca_key, host) : NULL;
    X509 *x = ca ? certify(key, ca, ca_key, (const char *)names.data, host) : NULL;
    bool written = x && write_file(files->key, 0600, key, NULL, NULL) &&
                   write_file(files->ca, 0644, NULL, ca, NULL) && write_file(files->cert, 0644, NULL, x, ca);
    int why = errno;
    if (!written)
        error_in_field(e, ERROR_BAD_FIELD, "--tls-self-signed", "'%s' cannot be made: %s", files->cert,
                       x ? strerror(why) : "OpenSSL cannot sign");
    X509_free(x);
    X509_free(ca);
    EVP_PKEY_free(ca_key);
    EVP_PKEY_free(key);
    ERR_clear_error();
    buf_free(&names);
    return written ? 0 : -1;
}

static X509 *read_first(const char *cert) {
    FILE *file = fopen(cert, "re");
    X509 *x = file ? PEM_read_X509(file, NULL, NULL, NULL) : NULL;
    if (file)
        fclose(file);
    ERR_clear_error();
    return x;
}

bool certificate_good(const char *cert) {
    X509 *x = read_first(cert);
    time_t soon = time(NULL) + WEEK;
    bool good = x && X509_cmp_time(X509_get0_notAfter(x), &soon) > 0;
    X509_free(x);
    return good;
}

int certificate_fingerprint(const char *cert, char out[CERTIFICATE_FINGERPRINT], struct error *e) {
    X509 *x = read_first(cert);
    unsigned char digest[EVP_MAX_MD_SIZE];
    unsigned size = 0;
    bool made = x && X509_digest(x, EVP_sha256(), digest, &size) == 1;
    X509_free(x);
    if (!made)
        return error_in_field(e, ERROR_BAD_FIELD, "--tls-cert", "'%s' holds no certificate", cert);
    for (unsigned i = 0; i < size; i++)
        snprintf(out + 3 * i, 4, "%02X%s", digest[i], i + 1 < size ? ":" : "");
    return 0;
}
