/* SPDX-License-Identifier: GPL-3.0-or-later */
/* HTTP from a connection. Byte 0 selects: requests, in pieces whose sizes byte 1 determines, or a form
 * preceded by a line with its Content-Type. The division must not change the result. */
#include "server/api/api_internal.h"
#include "server/base/utf8.h"
#include "server/http/http_reader.h"
#include "server/http/multipart.h"
#include "tests/fuzz/fuzz.h"
#include <stdlib.h>
#include <string.h>

enum { EVENTS_MAX = 4000 };

static void check_lists(const struct http_request *r) {
    static const char *const names[] = {"connection", "upgrade", "sec-websocket-protocol", "origin"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        const char *word;
        size_t at = 0, length;
        while (http_header_next(r, names[i], &at, &word, &length))
            FUZZ_CHECK(length && memchr(word, 0, length) == NULL);
        FUZZ_CHECK(!http_header(r, names[i]) == !http_header_count(r, names[i]));
        http_header_lists(r, names[i], "close");
    }
}

static void note_head(const struct http_request *r, struct buf *trace) {
    struct speech_request request;
    struct error e = {0};
    FUZZ_CHECK(*r->path == '/' || !strcmp(r->path, "*"));
    buf_printf(trace, "%d %u %s%s%s%s %llu\n", r->method, r->minor, r->path, r->keep_alive ? " keep" : "",
               r->expects_continue ? " expects" : "", r->chunked ? " chunked" : "",
               (unsigned long long)r->content_length);
    for (size_t i = 0; i < r->member_count; i++) {
        buf_printf(trace, "?%s=", r->members[i].name);
        buf_add(trace, r->members[i].value, r->members[i].size);
        FUZZ_CHECK(r->members[i].value[r->members[i].size] == '\0');
    }
    for (size_t i = 0; i < r->field_count; i++)
        buf_printf(trace, "%s: %s\n", r->fields[i].name, r->fields[i].value);
    FUZZ_CHECK(r->field_count <= HTTP_FIELDS);
    check_lists(r);
    request_init(&request);
    FUZZ_CHECK(!request_from_query(&request, r, "name", &e) || e.code);
    request_free(&request);
}

/* Result of parsing the bytes piece by piece. */
static void read_requests(const uint8_t *bytes, size_t size, size_t piece, struct buf *trace) {
    struct http_reader reader = {0};
    enum http_event event = HTTP_READ_MORE;
    bool body = false;
    for (size_t at = 0; at < size && event != HTTP_READ_WRONG;) {
        size_t some = size - at < piece ? size - at : piece, used = 0;
        uint8_t *exact = malloc(some);
        memcpy(exact, bytes + at, some);
        event = http_reader_feed(&reader, exact, some, &used);
        FUZZ_CHECK(used <= some && (event != HTTP_READ_MORE || used == some));
        at += used;
        if (event == HTTP_READ_HEAD)
            note_head(&reader.request, trace);
        if (event == HTTP_READ_BODY) {
            FUZZ_CHECK(reader.body_size && reader.body >= exact &&
                       reader.body + reader.body_size <= exact + some);
            buf_add(trace, reader.body, reader.body_size);
            body = true;
        }
        if (event == HTTP_READ_END)
            buf_printf(trace, "end %d\n", body);
        body = body && event != HTTP_READ_END;
        free(exact);
    }
    if (event == HTTP_READ_WRONG)
        buf_printf(trace, "%u %s", error_status(reader.error.code), error_name(reader.error.code));
    http_reader_free(&reader);
}

static void requests(struct fuzz_input *in) {
    size_t piece = 1 + fuzz_u8(in) % 64;
    struct buf whole = {0}, cut = {0};
    read_requests(in->at, fuzz_left(in), SIZE_MAX, &whole);
    read_requests(in->at, fuzz_left(in), piece, &cut);
    FUZZ_CHECK(whole.size == cut.size && (!whole.size || !memcmp(whole.data, cut.data, whole.size)));
    buf_free(&whole);
    buf_free(&cut);
}

static void form(struct fuzz_input *in) {
    char *type = fuzz_line(in);
    const uint8_t *part;
    size_t part_size, size;
    struct error e = {0};
    uint8_t *body = fuzz_rest(in, &size);
    int found = form_part(type, body, size, "fap", &part, &part_size, &e);
    FUZZ_CHECK(found >= 0 || e.code);
    if (found > 0)
        FUZZ_CHECK(part >= body && part_size <= size && part + part_size <= body + size);
    free(body);
    free(type);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    struct fuzz_input in = fuzz_input(data, size);
    if (fuzz_u8(&in) % 4 == 3)
        form(&in);
    else
        requests(&in);
    return 0;
}
