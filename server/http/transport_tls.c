/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Certificates, and the TLS details that libwebsockets leaves to OpenSSL. */
#include "server/http/transport_internal.h"
#include <errno.h>
#include <openssl/err.h>
#include <openssl/ssl.h>
#include <string.h>
#include <sys/stat.h>

long transport_tls_options(void) {
    return (long)(SSL_OP_NO_SSLv3 | SSL_OP_NO_TLSv1 | SSL_OP_NO_TLSv1_1 | SSL_OP_NO_COMPRESSION |
                  SSL_OP_NO_RENEGOTIATION | SSL_OP_CIPHER_SERVER_PREFERENCE);
}

void transport_end_tls(struct lws *wsi) {
    SSL *ssl = (SSL *)lws_get_ssl(wsi);
    if (ssl)
        SSL_shutdown(ssl);
    ERR_clear_error();
}

/* Reports OpenSSL's reason without its error codes. */
static int refuse(const char *field, const char *file, struct error *e) {
    const char *why = ERR_reason_error_string(ERR_peek_last_error());
    ERR_clear_error();
    return error_in_field(e, ERROR_BAD_FIELD, field, "'%s': %s", file, why ? why : "cannot be read");
}

int transport_check_tls(const struct transport_tls *tls, struct error *e) {
    struct stat key;
    if (stat(tls->key, &key))
        return error_in_field(e, ERROR_BAD_FIELD, "--tls-key", "'%s': %s", tls->key, strerror(errno));
    if (key.st_mode & S_IRWXO)
        return error_in_field(e, ERROR_BAD_FIELD, "--tls-key",
                              "'%s' can be read by everybody: chmod 640 (or 600) it", tls->key);
    SSL_CTX *trial = SSL_CTX_new(TLS_server_method());
    int failed = 0;
    if (!trial || SSL_CTX_use_certificate_chain_file(trial, tls->cert) != 1)
        failed = refuse("--tls-cert", tls->cert, e);
    else if (SSL_CTX_use_PrivateKey_file(trial, tls->key, SSL_FILETYPE_PEM) != 1 ||
             SSL_CTX_check_private_key(trial) != 1)
        failed = refuse("--tls-key", tls->key, e);
    SSL_CTX_free(trial);
    return failed;
}

int transport_renew_tls(struct transport *all, const struct transport_tls *tls, struct error *e) {
    if (transport_check_tls(tls, e))
        return -1;
    lws_tls_cert_updated(all->context, tls->cert, tls->key, NULL, 0, NULL, 0);
    return 0;
}
