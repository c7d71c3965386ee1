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

/* Checks the Host header (RFC 9110, 7.2) against a list of allowed names. A page whose own name is made to
 * point to this machine uses that name, and its browser takes the daemon for the page's own server (DNS
 * rebinding). Neither Origin nor a loopback address prevents this, but the name does. */

/* host: the header, with or without a port; NULL or "" = none, as in HTTP/1.0, which no browser uses. Always
 * allowed: "localhost" and names under it (RFC 6761, 6.3), and loopback addresses (127.0.0.0/8 and ::1).
 * own: the machine's name. names: further names, NULL-terminated or NULL; "*" allows all. own and names may
 * end in a port, which is not compared.
 *
 * local: the daemon listens on loopback only, often without tokens. Then all other addresses, and own, are
 * rejected unless listed. Browsers send Sec-Fetch-Site only to addresses that they trust: localhost and
 * loopback addresses. For http://0.0.0.0, http://[::ffff:7f00:1] and the machine's name, which reach the same
 * socket, they do not send it, so an image on any page could make the daemon speak. Without local, every
 * numeric address, and own, are allowed: no page can make those point elsewhere. */
bool host_allowed(const char *host, const char *own, char *const *names, bool local);

#endif
