/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reference server of strict.mjs that lets libwebsockets parse HTTP and WebSocket. It answers a request with
 * 200 and the bytes of the received body, and a WebSocket message with "taken". Prints its port; ends with
 * SIGTERM. */
#include <libwebsockets.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

struct session {
    size_t body;  /* bytes received */
    bool answers; /* the answer is due */
    bool message; /* a WebSocket message is to be answered */
};

static int answer(struct lws *wsi, struct session *s) {
    uint8_t head[LWS_PRE + 512], *start = head + LWS_PRE, *at = start, *end = head + sizeof head - 1;
    char text[LWS_PRE + 32];
    int size = snprintf(text + LWS_PRE, sizeof text - LWS_PRE, "%zu\n", s->body);
    s->answers = false;
    if (lws_add_http_common_headers(wsi, HTTP_STATUS_OK, "text/plain", (lws_filepos_t)size, &at, end) ||
        lws_finalize_write_http_header(wsi, start, &at, end))
        return -1;
    if (lws_write(wsi, (uint8_t *)text + LWS_PRE, (size_t)size, LWS_WRITE_HTTP_FINAL) != size)
        return -1;
    return lws_http_transaction_completed(wsi) ? -1 : 0;
}

static int callback(struct lws *wsi, enum lws_callback_reasons reason, void *user, void *in, size_t size) {
    struct session *s = user;
    (void)in;
    switch (reason) {
    case LWS_CALLBACK_HTTP:
        *s = (struct session){.answers = !lws_hdr_total_length(wsi, WSI_TOKEN_POST_URI)};
        return s->answers ? lws_callback_on_writable(wsi) < 0 : 0;
    case LWS_CALLBACK_HTTP_BODY:
        s->body += size;
        return 0;
    case LWS_CALLBACK_HTTP_BODY_COMPLETION:
        s->answers = true;
        lws_callback_on_writable(wsi);
        return 0;
    case LWS_CALLBACK_HTTP_WRITEABLE:
        return s->answers ? answer(wsi, s) : 0;
    case LWS_CALLBACK_RECEIVE:
        if (lws_is_final_fragment(wsi) && !lws_remaining_packet_payload(wsi)) {
            s->message = true;
            lws_callback_on_writable(wsi);
        }
        return 0;
    case LWS_CALLBACK_SERVER_WRITEABLE: {
        uint8_t text[LWS_PRE + 8] = {0};
        memcpy(text + LWS_PRE, "taken", 5);
        if (s->message && lws_write(wsi, text + LWS_PRE, 5, LWS_WRITE_TEXT) < 5)
            return -1;
        s->message = false;
        return 0;
    }
    case LWS_CALLBACK_HTTP_CONFIRM_UPGRADE:
        return in && !strcmp(in, "websocket") ? 0 : -1; /* no HTTP/2 */
    default:
        return 0;
    }
}

int main(void) {
    static const struct lws_protocols protocols[] = {
        {"roles", callback, sizeof(struct session), 0, 0, NULL, 0}, {0}};
    struct lws_context_creation_info info = {.port = 0,
                                             .iface = "127.0.0.1",
                                             .protocols = protocols,
                                             .options = LWS_SERVER_OPTION_EXPLICIT_VHOSTS |
                                                        LWS_SERVER_OPTION_DISABLE_IPV6 |
                                                        LWS_SERVER_OPTION_VALIDATE_UTF8};
    lws_set_log_level(LLL_ERR, NULL);
    struct lws_context *context = lws_create_context(&info);
    struct lws_vhost *vhost = context ? lws_create_vhost(context, &info) : NULL;
    if (!vhost)
        return 1;
    fprintf(stderr, "libwebsockets %s\n", lws_get_library_version());
    printf("%d\n", lws_get_vhost_listen_port(vhost));
    fflush(stdout);
    while (lws_service(context, 0) >= 0)
        ;
    return 0;
}
