/* SPDX-License-Identifier: GPL-3.0-or-later */
/* By which names the daemon may be asked: the Host header (RFC 9110, 7.2) against a list. A page whose own
 * name is made to point to this machine asks by that name, and its browser takes the daemon for the page's
 * own server (DNS rebinding): neither origins nor the loopback address help there, but the name does. */
#ifndef FACCIA_ACCESS_HOST_H
#define FACCIA_ACCESS_HOST_H

#include <stdbool.h>

/* host: the header with or without a port; NULL or "" = there is none, as with HTTP/1.0, which no browser
 * speaks. Always allowed: addresses in figures, of whatever interface, as nobody can make one point
 * elsewhere; "localhost" and names under it (RFC 6761, 6.3); own, the machine's name. names: NULL-terminated
 * or NULL; "*" stands for all. own and names may end in a port, which is not compared. */
bool host_allowed(const char *host, const char *own, char *const *names);

#endif
