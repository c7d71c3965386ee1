/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/access/page_link.h"
#include <qrencode.h>
#include <stdbool.h>
#include <string.h>

enum { MARGIN = 4 }; /* light modules around a code (ISO/IEC 18004) */

/* Returns what follows the scheme, or NULL. */
static const char *after_scheme(const char *page) {
    static const char *const schemes[] = {"http://", "https://"};
    for (size_t i = 0; i < sizeof schemes / sizeof *schemes; i++)
        if (!strncmp(page, schemes[i], strlen(schemes[i])))
            return page + strlen(schemes[i]);
    return NULL;
}

/* Returns whether the query, from its '?' to `end`, has a parameter named "token". */
static bool names_token(const char *query, const char *end) {
    static const char name[] = "token=";
    for (const char *at = query; at && at < end; at = memchr(at + 1, '&', (size_t)(end - at - 1)))
        if ((size_t)(end - at) >= sizeof name && !strncmp(at + 1, name, sizeof name - 1))
            return true;
    return false;
}

int page_link_write(const char *page, const char *token, struct buf *out, struct error *e) {
    const char *host = after_scheme(page);
    if (!host || !*host || strchr("/?#", *host) || strpbrk(page, " \t\r\n"))
        return error_in_field(
            e, ERROR_BAD_FIELD, "--page",
            "'%s' is no address of a page, such as http://192.168.1.20:8080/room.html?room=kitchen", page);
    const char *end = host + strcspn(host, "#");
    const char *query = memchr(host, '?', (size_t)(end - host));
    if (names_token(query, end))
        return error_in_field(e, ERROR_BAD_FIELD, "--page", "'%s' has a token already", page);
    bool path = memchr(host, '/', (size_t)((query ? query : end) - host)) != NULL;
    buf_printf(out, "%.*s%s%stoken=%s%s", (int)(end - page), page, path || query ? "" : "/",
               query ? "&" : "?", token, end);
    return 0;
}

/* Returns whether a module is dark; the margin is light. */
static bool dark(const QRcode *code, int x, int y) {
    if (x < 0 || y < 0 || x >= code->width || y >= code->width)
        return false;
    return code->data[y * code->width + x] & 1;
}

int page_link_draw(const char *text, FILE *out) {
    static const char *const pairs[2][2] = {{" ", "▄"}, {"▀", "█"}}; /* [upper is dark][lower is dark] */
    QRcode *code = QRcode_encodeString8bit(text, 0, QR_ECLEVEL_L);
    if (!code)
        return -1;
    for (int y = -MARGIN; y < code->width + MARGIN; y += 2) {
        fputs("\033[30;107m", out);
        for (int x = -MARGIN; x < code->width + MARGIN; x++)
            fputs(pairs[dark(code, x, y)][dark(code, x, y + 1)], out);
        fputs("\033[0m\n", out);
    }
    QRcode_free(code);
    return 0;
}
