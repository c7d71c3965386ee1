/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/mem.h"
#include "server/http/http_internal.h"
#include <arpa/inet.h>
#include <ifaddrs.h>
#include <net/if.h>
#include <netdb.h>
#include <netinet/in.h>
#include <stdlib.h>
#include <string.h>
#include <sys/un.h>

static void add(struct listen_addresses *found, const struct sockaddr *address, int family) {
    socklen_t size = family == AF_INET ? sizeof(struct sockaddr_in) : sizeof(struct sockaddr_in6);
    struct listen_address a = {.size = size};
    if (!address || address->sa_family != family)
        return;
    memcpy(&a.at, address, size);
    listen_address_set_port(&a.at, 0);
    for (size_t i = 0; i < found->count; i++)
        if (found->list[i].size == size && !memcmp(&found->list[i].at, &a.at, size))
            return;
    found->list = mem_grow(found->list, &found->cap, found->count + 1, sizeof *found->list);
    found->list[found->count++] = a;
}

/* name NULL: all interfaces that are up. */
static void of_interface(struct listen_addresses *found, const char *name, int family) {
    struct ifaddrs *all;
    if (getifaddrs(&all))
        return;
    for (const struct ifaddrs *a = all; a; a = a->ifa_next)
        if (name ? !strcmp(a->ifa_name, name) : a->ifa_flags & IFF_UP)
            add(found, a->ifa_addr, family);
    freeifaddrs(all);
}

static void of_name(struct listen_addresses *found, const char *name, int family) {
    const struct addrinfo hints = {.ai_family = family, .ai_socktype = SOCK_STREAM};
    struct addrinfo *all;
    if (getaddrinfo(name, NULL, &hints, &all))
        return;
    for (const struct addrinfo *a = all; a; a = a->ai_next)
        add(found, a->ai_addr, family);
    freeaddrinfo(all);
}

static void of_family(struct listen_addresses *found, const char *host, int family) {
    const char *four = NULL, *six = NULL;
    if (!strcmp(host, "*"))
        four = "0.0.0.0", six = "::";
    else if (!strcasecmp(host, "localhost")) /* always loopback: the resolver might say otherwise */
        four = "127.0.0.1", six = "::1";
    if (four)
        of_name(found, family == AF_INET ? four : six, family);
    else if (if_nametoindex(host))
        of_interface(found, host, family);
    else
        of_name(found, host, family);
}

void listen_addresses_find(struct listen_addresses *found, const char *host) {
    size_t length = strlen(host);
    bool brackets = length > 2 && *host == '[' && host[length - 1] == ']';
    char *name = mem_strndup(host + brackets, length - 2 * (size_t)brackets);
    *found = (struct listen_addresses){0};
    if (*name) {
        of_family(found, name, AF_INET);
        of_family(found, name, AF_INET6);
    }
    free(name);
}

static bool is_any(const struct sockaddr_storage *address) {
    if (address->ss_family == AF_INET)
        return ((const struct sockaddr_in *)address)->sin_addr.s_addr == htonl(INADDR_ANY);
    return IN6_IS_ADDR_UNSPECIFIED(&((const struct sockaddr_in6 *)address)->sin6_addr);
}

static bool is_link_local(const struct sockaddr_storage *address) {
    return address->ss_family == AF_INET6 &&
           IN6_IS_ADDR_LINKLOCAL(&((const struct sockaddr_in6 *)address)->sin6_addr);
}

void listen_addresses_outside(struct listen_addresses *found, const struct sockaddr_storage *address) {
    size_t before = found->count, kept = before;
    if (address->ss_family == AF_UNIX)
        return;
    if (is_any(address))
        of_interface(found, NULL, address->ss_family);
    else
        add(found, (const struct sockaddr *)address, address->ss_family);
    for (size_t i = before; i < found->count; i++) {
        struct listen_address a = found->list[i];
        if (listen_address_is_local(&a.at) || is_link_local(&a.at))
            continue;
        listen_address_set_port(&a.at, listen_address_port(address));
        found->list[kept++] = a;
    }
    found->count = kept;
}

bool listen_address_is_local(const struct sockaddr_storage *address) {
    if (address->ss_family == AF_INET)
        return ntohl(((const struct sockaddr_in *)address)->sin_addr.s_addr) >> 24 == 127;
    if (address->ss_family == AF_INET6) {
        const struct in6_addr *six = &((const struct sockaddr_in6 *)address)->sin6_addr;
        return IN6_IS_ADDR_LOOPBACK(six) || (IN6_IS_ADDR_V4MAPPED(six) && six->s6_addr[12] == 127);
    }
    return address->ss_family == AF_UNIX;
}

void listen_address_set_port(struct sockaddr_storage *address, int port) {
    if (address->ss_family == AF_INET)
        ((struct sockaddr_in *)address)->sin_port = htons((uint16_t)port);
    else if (address->ss_family == AF_INET6)
        ((struct sockaddr_in6 *)address)->sin6_port = htons((uint16_t)port);
}

int listen_address_port(const struct sockaddr_storage *address) {
    if (address->ss_family == AF_INET)
        return ntohs(((const struct sockaddr_in *)address)->sin_port);
    return address->ss_family == AF_INET6 ? ntohs(((const struct sockaddr_in6 *)address)->sin6_port) : 0;
}

void listen_address_write(const struct sockaddr_storage *address, bool tls, struct buf *out) {
    char text[INET6_ADDRSTRLEN + IF_NAMESIZE + 1] = "";
    bool six = address->ss_family == AF_INET6;
    if (address->ss_family == AF_UNIX) {
        buf_printf(out, "unix:%s", ((const struct sockaddr_un *)address)->sun_path);
        return;
    }
    getnameinfo((const struct sockaddr *)address,
                six ? sizeof(struct sockaddr_in6) : sizeof(struct sockaddr_in), text, sizeof text, NULL, 0,
                NI_NUMERICHOST);
    buf_printf(out, six ? "http%s://[%s]:%d/" : "http%s://%s:%d/", tls ? "s" : "", text,
               listen_address_port(address));
}
