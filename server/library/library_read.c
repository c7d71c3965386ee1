/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/library/library_internal.h"
#include <stdlib.h>
#include <time.h>

static uint64_t now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (uint64_t)t.tv_sec * 1000 + (uint64_t)t.tv_nsec / 1000000;
}

bool answer_is_late(struct answer_limit *limit) {
    limit->late = limit->late || (limit->given_up && atomic_load(limit->given_up)) || now() > limit->until;
    return limit->late;
}

void library_reader_look(struct index_reader *r) {
    r->damaged = r->damaged || index_is_damaged(r->sql);
}

sqlite3_stmt *library_prepare(struct index_reader *r, const char *sql, struct error *e) {
    sqlite3_stmt *s = NULL;
    library_reader_look(r);
    if (sqlite3_prepare_v2(r->sql, sql, -1, &s, NULL) != SQLITE_OK)
        error_set(e, ERROR_BAD_INDEX, "the index: %.200s", sqlite3_errmsg(r->sql));
    library_reader_look(r);
    return s;
}

json_t *library_text(sqlite3_stmt *s, int column) {
    const char *text = (const char *)sqlite3_column_text(s, column);
    json_t *string = text ? json_string(text) : NULL;
    return string ? string : json_null();
}

int library_number(const char *field, const char *text, unsigned min, unsigned max, unsigned otherwise,
                   unsigned *out, struct error *e) {
    char *end;
    unsigned long value = text ? strtoul(text, &end, 10) : otherwise;
    if (text && (*text < '0' || *text > '9' || *end || value < min || value > max))
        return error_in_field(e, ERROR_BAD_FIELD, field, "must be a whole number from %u to %u", min, max);
    *out = (unsigned)value;
    return 0;
}
