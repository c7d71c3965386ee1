/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A home-made certificate. A private authority signs it, and the authority's key is discarded. A device
 * that trusts the authority therefore trusts this machine and no other. */
#ifndef FACCIA_HTTP_CERTIFICATE_H
#define FACCIA_HTTP_CERTIFICATE_H

#include "server/base/error.h"
#include <stdbool.h>

/* "3A:5F:...": SHA-256 of the certificate, as browsers show it. */
enum { CERTIFICATE_FINGERPRINT = 3 * 32 };

/* PEM files: the certificate followed by its authority's, its key, and the authority's certificate alone,
 * to be installed on devices. */
struct certificate_files {
    const char *cert, *key, *ca;
};

/* Makes a P-256 key, which only its owner can read, and a certificate for the names and addresses of this
 * machine. It is valid for 825 days, the longest that Apple devices accept. Existing files are replaced.
 * -1 with *e ("bad-field"). */
int certificate_make(const struct certificate_files *files, struct error *e);

/* Returns whether the file holds a certificate that is valid for at least another week. */
bool certificate_good(const char *cert);

/* Writes the fingerprint of the first certificate in the file. -1 with *e ("bad-field"). */
int certificate_fingerprint(const char *cert, char out[CERTIFICATE_FINGERPRINT], struct error *e);

#endif
