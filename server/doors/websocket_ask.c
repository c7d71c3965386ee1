/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/doors/websocket_ask.h"
#include <openssl/evp.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>
#include <sys/random.h>
#include <uv.h>

static void base64(char *out, const uint8_t *bytes, int size) {
    EVP_EncodeBlock((unsigned char *)out, bytes, size);
}

void websocket_ask(struct buf *head, const char *host, const char *path, const char *token,
                   char answer[WEBSOCKET_ANSWER_BYTES]) {
    static const char magic[] = "258EAFA5-E914-47DA-95CA-C5AB0DC85B11";
    uint8_t number[16] = {0}, sum[EVP_MAX_MD_SIZE];
    char key[32], text[96];
    unsigned size = 0;
    if (getrandom(number, sizeof number, 0) != sizeof number)
        number[0] = (uint8_t)uv_hrtime();
    base64(key, number, sizeof number);
    snprintf(text, sizeof text, "%s%s", key, magic);
    EVP_Digest(text, strlen(text), sum, &size, EVP_sha1(), NULL);
    base64(answer, sum, (int)size);
    buf_printf(head,
               "GET %s HTTP/1.1\r\nHost: %s\r\nUpgrade: websocket\r\nConnection: "
               "Upgrade\r\nSec-WebSocket-Key: %s\r\n"
               "Sec-WebSocket-Version: 13\r\n",
               path, host, key);
    if (token)
        buf_printf(head, "Authorization: Bearer %s\r\n", token);
    buf_printf(head, "\r\n");
}

/* Whether the value of a header begins with it. */
static bool has_header(const char *head, const char *name, const char *value) {
    size_t length = strlen(name);
    for (const char *line = strstr(head, "\r\n"); line; line = strstr(line + 2, "\r\n"))
        if (!strncasecmp(line + 2, name, length) && line[2 + length] == ':') {
            const char *at = line + 3 + length + strspn(line + 3 + length, " \t");
            return !strncasecmp(at, value, strlen(value));
        }
    return false;
}

bool websocket_answered(const char *head, const char *answer) {
    return !strncmp(head, "HTTP/1.1 101", 12) && has_header(head, "Sec-WebSocket-Accept", answer);
}

int websocket_mask(wslay_event_context_ptr frames, uint8_t *mask, size_t size, void *ctx) {
    (void)frames;
    (void)ctx;
    return getrandom(mask, size, 0) == (ssize_t)size ? 0 : -1;
}
