/* SPDX-License-Identifier: MIT */
/* Machine-readable descriptions of the protocol: openapi.json, asyncapi.json, and the schemas that they refer
 * to. */
#ifndef FACCIA_PROTOCOL_DOCUMENTS_H
#define FACCIA_PROTOCOL_DOCUMENTS_H

#include <stddef.h>

struct document {
    const char *name; /* "openapi.json", "schema/server.json" */
    const unsigned char *data;
    size_t size;
};

extern const struct document documents[]; /* ended by a name of NULL */

#endif
