/* SPDX-License-Identifier: GPL-3.0-or-later */
/* HTTP on one connection: its requests, one after the other, and how long they may take. */
#ifndef FACCIA_NET_HTTP_SESSION_H
#define FACCIA_NET_HTTP_SESSION_H

#include "server/net/connection.h"

struct http_session;

struct http_session *http_session_new(struct connection *connection);
void http_session_free(struct http_session *session);

/* Bytes have come; no more will come; bytes have left. */
void http_session_read(struct connection *connection, const void *bytes, size_t size);
void http_session_eof(struct connection *connection);
void http_session_sent(struct connection *connection);

/* All of an answer has left: the session goes on, soon, and then at once. */
void http_session_answered(struct connection *connection);
void http_session_go_on(struct connection *connection);

/* It has answered, and waits for another request. */
bool http_session_is_idle(const struct connection *connection);

/* From time to time. */
void http_session_look(struct connection *connection);

/* Whether the connection can go on after an answer that is given now; it is said in its head. */
bool http_session_persists(const struct connection *connection);

#endif
