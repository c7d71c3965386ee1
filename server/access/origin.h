/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Checks the Origin header (RFC 6454, 7) against a list of pages that may use the daemon. */
#ifndef FACCIA_ACCESS_ORIGIN_H
#define FACCIA_ACCESS_ORIGIN_H

#include <stdbool.h>

/* origin: what the browser sent; NULL = none, as from programs other than browsers: allowed. host: the
 * request's Host header, whose own pages are also allowed; NULL if that must not count (DNS rebinding:
 * under a name that an attacker points to this machine, page and host agree). list: NULL-terminated or
 * NULL; "*" allows all; a star in a host name matches anything there; "null" stands for pages from files.
 * Pages from servers on this machine are always allowed. */
bool origin_allowed(const char *origin, const char *host, char *const *list);

/* Checks a request without an Origin by the browser's Fetch Metadata headers (NULL: not sent). Returns
 * false when a page of another site caused it, by an image, a sound or a frame, and no user followed a
 * link. Loading a frame does not count as following a link, even if the user clicked on its page. */
bool origin_unsaid_allowed(const char *site, const char *mode, const char *user, const char *dest);

#endif
