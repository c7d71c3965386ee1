/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/bridges/bridge.h"
#include "server/base/log.h"
#include "server/base/mem.h"
#include "server/base/utf8.h"
#include <errno.h>
#include <signal.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/random.h>

static void on_signal(uv_signal_t *signal, int number) {
    (void)number;
    uv_stop(signal->loop);
}

void bridge_loop_open(struct bridge_loop *e, uv_loop_t *loop) {
    static const int numbers[2] = {SIGINT, SIGTERM};
    for (int i = 0; i < 2; i++) {
        uv_signal_init(loop, &e->signals[i]);
        uv_signal_start(&e->signals[i], on_signal, numbers[i]);
    }
}

void bridge_loop_run(struct bridge_loop *e) {
    for (int i = 0; i < 2; i++)
        if (!uv_is_closing((uv_handle_t *)&e->signals[i]))
            uv_close((uv_handle_t *)&e->signals[i], NULL);
    uv_run(e->signals[0].loop, UV_RUN_DEFAULT);
}

void bridge_loop_close(struct bridge_loop *e) {
    uv_loop_t *loop = e->signals[0].loop;
    bridge_loop_run(e);
    uv_loop_close(loop);
}

/* Three non-empty parts of base64url separated by dots (RFC 7515, 3.1). */
static bool is_token(const char *text) {
    static const char letters[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_";
    for (int part = 0; part < 3; part++) {
        size_t length = strspn(text, letters);
        if (!length || text[length] != (part < 2 ? '.' : '\0'))
            return false;
        text += length + (part < 2);
    }
    return true;
}

/* Does not quote the value: it may be a secret. */
static void complain(const char *where, const char *text) {
    size_t length = strlen(text), dots = 0;
    for (const char *c = text; *c; c++)
        dots += *c == '.';
    log_error(
        "%s: contains no token, but %zu characters with %zu dots%s. A token has three parts separated by "
        "dots; create one from the daemon's secret with 'faccia token --secret-file FILE --subject NAME'",
        where, length, dots,
        dots ? "" : ", perhaps the secret that signs tokens, which must not leave the daemon's machine");
}

void daemon_address_open(struct daemon_address *p) {
    const char *url = getenv("FACCIA_URL"), *token = getenv("FACCIA_TOKEN");
    bool has = token && *token, good = has && is_token(token);
    if (has && !good)
        complain("FACCIA_TOKEN", token);
    *p = (struct daemon_address){.url = url ? url : "http://127.0.0.1:8080",
                                 .token = good ? mem_strdup(token) : NULL};
}

void daemon_address_close(struct daemon_address *p) {
    free(p->token);
}

int daemon_address_read_token(struct daemon_address *p, const char *file) {
    char line[4096] = "";
    errno = 0;
    FILE *f = fopen(file, "r");
    if (f) {
        if (!fgets(line, sizeof line, f) && !errno)
            errno = ENODATA;
        fclose(f);
    }
    line[strcspn(line, "\r\n")] = '\0';
    if (!*line) {
        log_error("%s: contains no token: %s", file, strerror(errno ? errno : ENODATA));
        return -1;
    }
    if (!is_token(line)) {
        complain(file, line);
        return -1;
    }
    free(p->token);
    p->token = mem_strdup(line);
    return 0;
}

bool bridge_has_words(const char *text) {
    size_t size = strlen(text);
    for (size_t at = 0, length; at < size; at += length) {
        uint32_t cp = 0;
        length = utf8_next(text + at, size - at, &cp);
        if (!length || !(strchr(" \t\r\n", (int)cp) || utf8_is_emoji(cp)))
            return true;
    }
    return false;
}

void daemon_address_make_id(char *id, size_t cap) {
    unsigned long long number = 0;
    if (getrandom(&number, sizeof number, 0) != sizeof number)
        number = uv_hrtime();
    snprintf(id, cap, "say-%016llx", number);
}

int bridge_listen(uv_tcp_t *tcp, const char *program, const char *where, uv_connection_cb on_connection) {
    struct sockaddr_storage address;
    char host[64] = "127.0.0.1";
    const char *colon = strrchr(where, ':'), *port = colon ? colon + 1 : where;
    char *end;
    long number = strtol(port, &end, 10);
    if (colon)
        snprintf(host, sizeof host, "%.*s", (int)(colon - where - 2 * (*where == '[')),
                 where + (*where == '['));
    if (end == port || *end || number < 0 || number > 65535 ||
        (uv_ip4_addr(host, (int)number, (struct sockaddr_in *)&address) &&
         uv_ip6_addr(host, (int)number, (struct sockaddr_in6 *)&address))) {
        fprintf(stderr, "%s: the address to listen on is invalid: '%s'\n", program, where);
        return 2;
    }
    int failed = uv_tcp_bind(tcp, (struct sockaddr *)&address, 0);
    if (!failed)
        failed = uv_listen((uv_stream_t *)tcp, 16, on_connection);
    if (failed) {
        log_error("cannot listen on %s: %s", where, uv_strerror(failed));
        return 1;
    }
    int size = sizeof address;
    uv_tcp_getsockname(tcp, (struct sockaddr *)&address, &size);
    log_info("listening on %s, port %d", host, ntohs(((struct sockaddr_in *)&address)->sin_port));
    return -1;
}
