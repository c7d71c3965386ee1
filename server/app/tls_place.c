/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/app/tls_place.h"
#include "server/base/log.h"
#include "server/base/mem.h"
#include "server/http/certificate.h"
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

static char *join(const char *folder, const char *name) {
    struct buf path = {0};
    buf_printf(&path, "%s/%s", folder, name);
    return (char *)path.data;
}

static int make_own(struct tls_place *place, const char *folder, struct error *e) {
    place->tls = (struct transport_tls){join(folder, "cert.pem"), join(folder, "key.pem")};
    if (mkdir(folder, 0700) && errno != EEXIST)
        return error_in_field(e, ERROR_BAD_FIELD, "--tls-self-signed", "'%s' cannot be made: %s", folder,
                              strerror(errno));
    char *ca = join(folder, "ca.pem"), fingerprint[CERTIFICATE_FINGERPRINT];
    const struct certificate_files files = {place->tls.cert, place->tls.key, ca};
    int failed = !certificate_good(files.cert) && certificate_make(&files, e) ? -1 : 0;
    if (!failed)
        failed = certificate_fingerprint(files.cert, fingerprint, e);
    if (!failed)
        log_info("TLS by a certificate of its own: a device trusts it that has taken %s; others ask, and its "
                 "SHA-256 fingerprint is %s",
                 ca, fingerprint);
    free(ca);
    return failed;
}

int tls_place_open(struct tls_place *place, const struct settings *s, struct error *e) {
    *place = (struct tls_place){0};
    if (!s->tls_cert != !s->tls_key)
        return error_in_field(e, ERROR_BAD_FIELD, s->tls_cert ? "--tls-cert" : "--tls-key",
                              "a certificate and its key are named together: --tls-cert FILE --tls-key FILE");
    if (s->tls_cert && s->tls_self_signed)
        return error_in_field(e, ERROR_BAD_FIELD, "--tls-self-signed",
                              "there is a certificate already: --tls-cert");
    if (!s->tls_cert && !s->tls_self_signed)
        return 0;
    place->on = true;
    if (s->tls_self_signed)
        return make_own(place, s->tls_self_signed, e);
    place->tls = (struct transport_tls){mem_strdup(s->tls_cert), mem_strdup(s->tls_key)};
    return 0;
}

void tls_place_free(struct tls_place *place) {
    free((char *)place->tls.cert);
    free((char *)place->tls.key);
    *place = (struct tls_place){0};
}
