/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/library/search_rank.h"
#include "server/library/search_query.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define K1 1.2
#define B 0.75
/* A term that is nearly everywhere still weighs something. */
#define WEIGHT_LEAST 1e-6
enum { PHRASES_MAX = QUERY_TERMS_MAX * (QUERY_STEMS_MAX + 1), LOOKED_AT = 100 };

/* Of one query. */
struct ranking {
    double weights[PHRASES_MAX], mean_size; /* words in a row */
};

struct counting {
    sqlite3_int64 rows, last; /* so far; the number of the last one */
};

static int count(const Fts5ExtensionApi *api, Fts5Context *fts, void *ctx) {
    struct counting *c = ctx;
    c->last = api->xRowid(fts);
    return ++c->rows < LOOKED_AT ? SQLITE_OK : SQLITE_DONE;
}

static double weight_of(const Fts5ExtensionApi *api, Fts5Context *fts, int phrase, sqlite3_int64 rows) {
    struct counting c = {0};
    if (api->xQueryPhrase(fts, phrase, &c, count) != SQLITE_OK)
        return WEIGHT_LEAST;
    double hits = (double)c.rows;
    if (c.rows == LOOKED_AT && c.last > 0)
        hits = fmin((double)rows, fmax(hits, hits * (double)rows / (double)c.last));
    return fmax(WEIGHT_LEAST, log(((double)rows - hits + 0.5) / (hits + 0.5)));
}

static struct ranking *ranking_of(const Fts5ExtensionApi *api, Fts5Context *fts) {
    struct ranking *r = api->xGetAuxdata(fts, 0);
    sqlite3_int64 rows = 0, words = 0;
    int phrases = api->xPhraseCount(fts);
    if (r)
        return r;
    r = calloc(1, sizeof *r); /* SQLite frees it */
    if (!r || api->xRowCount(fts, &rows) != SQLITE_OK || api->xColumnTotalSize(fts, 0, &words) != SQLITE_OK ||
        api->xSetAuxdata(fts, r, free) != SQLITE_OK) {
        free(r);
        return NULL;
    }
    r->mean_size = rows > 0 && words > 0 ? (double)words / (double)rows : 1;
    for (int i = 0; i < phrases && i < PHRASES_MAX; i++)
        r->weights[i] = weight_of(api, fts, i, rows);
    return r;
}

static void worth(const Fts5ExtensionApi *api, Fts5Context *fts, sqlite3_context *out, int count_of_values,
                  sqlite3_value **values) {
    double often[PHRASES_MAX] = {0}, sum = 0;
    const struct ranking *r = ranking_of(api, fts);
    int instances = 0, size = 0, phrases = api->xPhraseCount(fts);
    (void)count_of_values;
    (void)values;
    if (!r || api->xInstCount(fts, &instances) != SQLITE_OK || api->xColumnSize(fts, 0, &size) != SQLITE_OK) {
        sqlite3_result_error_nomem(out);
        return;
    }
    for (int i = 0; i < instances; i++) {
        int phrase, column, offset;
        if (api->xInst(fts, i, &phrase, &column, &offset) == SQLITE_OK && phrase < PHRASES_MAX)
            often[phrase]++;
    }
    for (int i = 0; i < phrases && i < PHRASES_MAX; i++)
        sum += r->weights[i] * often[i] * (K1 + 1) / (often[i] + K1 * (1 - B + B * size / r->mean_size));
    sqlite3_result_double(out, sum);
}

int search_rank_add(sqlite3 *sql) {
    sqlite3_stmt *s = NULL;
    fts5_api *api = NULL;
    if (sqlite3_prepare_v2(sql, "SELECT fts5(?)", -1, &s, NULL) == SQLITE_OK) {
        sqlite3_bind_pointer(s, 1, &api, "fts5_api_ptr", NULL);
        sqlite3_step(s);
    }
    sqlite3_finalize(s);
    return api && api->xCreateFunction(api, "worth", NULL, worth, NULL) == SQLITE_OK ? 0 : -1;
}
