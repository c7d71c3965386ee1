/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/cluster/redis_address.h"
#include "server/base/buf.h"
#include "server/base/mem.h"
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { NUMBER_MOST = 65535 };

static int fail(struct error *e, const char *why) {
    return error_in_field(
        e, ERROR_BAD_FIELD, "--cluster",
        "%s: redis://[[USER]:PASSWORD@]HOST[:PORT][/NUMBER] or unix://[[USER]:PASSWORD@]/PATH is wanted",
        why);
}

/* Parses a number that consists of digits only. Returns -1 if it is not valid. */
static int number_of(const char *text, size_t size) {
    int number = 0;
    if (!size || size > 5)
        return -1;
    for (size_t i = 0; i < size; i++) {
        if (text[i] < '0' || text[i] > '9')
            return -1;
        number = number * 10 + text[i] - '0';
    }
    return number <= NUMBER_MOST ? number : -1;
}

/* Decodes percent-encoding. Returns NULL for a percent sign without two hexadecimal digits, or for an
 * encoded NUL. */
static char *decoded(const char *text, size_t size) {
    char *out = mem_alloc(size + 1), *to = out;
    for (size_t i = 0; i < size; i++) {
        char hex[3] = {0}, *end = hex;
        if (text[i] != '%') {
            *to++ = text[i];
            continue;
        }
        if (i + 2 < size)
            memcpy(hex, text + i + 1, 2);
        *to = (char)strtol(hex, &end, 16);
        if (end != hex + 2 || !*to++) {
            free(out);
            return NULL;
        }
        i += 2;
    }
    return out;
}

/* Reads "USER:PASSWORD", the part before the last @. */
static int read_login(const char *text, size_t size, struct redis_address *address, struct error *e) {
    const char *colon = memchr(text, ':', size);
    if (!colon)
        return fail(e, "a password follows a colon");
    if (colon > text && !(address->user = decoded(text, (size_t)(colon - text))))
        return fail(e, "a percent sign that encodes nothing");
    address->password = decoded(colon + 1, size - (size_t)(colon + 1 - text));
    return address->password ? 0 : fail(e, "a percent sign that encodes nothing");
}

static int read_place(const char *at, struct redis_address *address, struct error *e) {
    const char *slash = strchr(at, '/'), *end = slash ? slash : at + strlen(at);
    const char *bracket = *at == '[' ? memchr(at, ']', (size_t)(end - at)) : NULL;
    const char *colon = memchr(bracket ? bracket : at, ':', (size_t)(end - (bracket ? bracket : at)));
    const char *name = bracket ? at + 1 : at, *name_end = bracket ? bracket : colon ? colon : end;
    if (name_end == name || (bracket && bracket + 1 != (colon ? colon : end)))
        return fail(e, "no host");
    address->host = mem_strndup(name, (size_t)(name_end - name));
    address->port = colon ? number_of(colon + 1, (size_t)(end - colon - 1)) : REDIS_PORT;
    if (address->port <= 0)
        return fail(e, "no such port");
    address->number = slash && slash[1] ? number_of(slash + 1, strlen(slash + 1)) : 0;
    return address->number < 0 ? fail(e, "no such number of a database") : 0;
}

static void show(struct redis_address *address) {
    struct buf text = {0};
    if (address->path)
        buf_printf(&text, "%s", address->path);
    else
        buf_printf(&text, strchr(address->host, ':') ? "[%s]:%d" : "%s:%d", address->host, address->port);
    address->shown = mem_strndup((const char *)text.data, text.size);
    buf_free(&text);
}

int redis_address_read(const char *text, struct redis_address *address, struct error *e) {
    *address = (struct redis_address){0};
    bool file = !strncmp(text, "unix://", 7);
    if (!file && strncmp(text, "redis://", 8) != 0)
        return fail(e, "no address of Redis");
    const char *at = text + (file ? 7 : 8), *login_end = strrchr(at, '@');
    int status = login_end ? read_login(at, (size_t)(login_end - at), address, e) : 0;
    if (login_end)
        at = login_end + 1;
    if (!status && file && *at != '/')
        status = fail(e, "no path of a socket");
    else if (!status && file)
        address->path = mem_strdup(at);
    else if (!status)
        status = read_place(at, address, e);
    if (status)
        redis_address_free(address);
    else
        show(address);
    return status;
}

void redis_address_free(struct redis_address *address) {
    free(address->user);
    free(address->password);
    free(address->host);
    free(address->path);
    free(address->shown);
    *address = (struct redis_address){0};
}
