/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A certificate that a home makes for itself. An authority of its own, whose key is thrown away, has signed
 * it: a device that takes that authority's certificate trusts this machine's, and can be led to no other. */
#ifndef FACCIA_HTTP_CERTIFICATE_H
#define FACCIA_HTTP_CERTIFICATE_H

#include "server/base/error.h"
#include <stdbool.h>

/* "3A:5F:...", the SHA-256 of the certificate, as browsers show it. */
enum { CERTIFICATE_FINGERPRINT = 3 * 32 };

/* The files: the certificate with its authority's behind it, its key, and the authority's alone, which is
 * what devices take. */
struct certificate_files {
    const char *cert, *key, *ca;
};

/* Makes a key (P-256), which its owner alone can read, and a certificate for this machine's names and
 * addresses that is good for 825 days, longer than which Apple's devices take none. Files that are there are
 * replaced. -1 with *e ("bad-field"). */
int certificate_make(const struct certificate_files *files, struct error *e);

/* Is there one that is good for another week at least? */
bool certificate_good(const char *cert);

/* Of the first certificate of the file. -1 with *e ("bad-field"). */
int certificate_fingerprint(const char *cert, char out[CERTIFICATE_FINGERPRINT], struct error *e);

#endif
