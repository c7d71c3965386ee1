/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which pages may use the daemon: the Origin header (RFC 6454, 7) against a list. */
#ifndef FACCIA_ACCESS_ORIGIN_H
#define FACCIA_ACCESS_ORIGIN_H

#include <stdbool.h>

/* origin: what the browser sent; NULL = nothing was sent, as by programs that are no browsers: allowed. host:
 * the request's Host header, whose own pages are allowed too; NULL where that must not count (a name that an
 * attacker lets point to this machine makes page and host agree: DNS rebinding). list: NULL-terminated or
 * NULL; "*" stands for all; a star in a host name for anything there; "null" for pages that are files. Pages
 * from this machine's own servers are always allowed. */
bool origin_allowed(const char *origin, const char *host, char *const *list);

/* For a request without an Origin, by what the browser says of it (Fetch Metadata Request Headers; NULL:
 * nothing): false when a page of another site has had it made, by an image, a sound, a frame, and nobody has
 * followed a link. A frame is none, though its page may have been clicked on. */
bool origin_unsaid_allowed(const char *site, const char *mode, const char *user, const char *dest);

#endif
