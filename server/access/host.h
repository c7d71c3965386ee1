/* SPDX-License-Identifier: GPL-3.0-or-later */
/* By which names the daemon may be asked: the Host header (RFC 9110, 7.2) against a list. A page whose own
 * name is made to point to this machine asks by that name, and its browser takes the daemon for the page's
 * own server (DNS rebinding): neither origins nor the loopback address help there, but the name does. */
#ifndef FACCIA_ACCESS_HOST_H
#define FACCIA_ACCESS_HOST_H

#include <stdbool.h>

/* host: the header with or without a port; NULL or "" = there is none, as with HTTP/1.0, which no browser
 * speaks. Always allowed: "localhost" and names under it (RFC 6761, 6.3), and loopback addresses (127.0.0.0/8
 * and ::1). names: NULL-terminated or NULL; "*" stands for all. own and names may end in a port, which is not
 * compared.
 *
 * local: the daemon listens on loopback only, often without tokens. No other address and no other name is
 * allowed then. Browsers say for which page they fetch (Sec-Fetch-Site) only where they trust the address:
 * localhost and loopback addresses. For http://0.0.0.0, http://[::ffff:7f00:1] and the machine's name, which
 * lead to the same socket, they say nothing, and an image on any page could make the daemon speak. Otherwise
 * every address in figures and own, the machine's name, are allowed: no page can make those point
 * elsewhere. */
bool host_allowed(const char *host, const char *own, char *const *names, bool local);

#endif
