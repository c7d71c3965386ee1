/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/app/ahead_start.h"
#include "server/base/log.h"

void ahead_start(struct speak_ahead **ahead, const struct settings *s, const struct pipeline *pipeline,
                 struct library *library) {
    const struct cache_options *cache = &s->voices.cache;
    uint64_t kept = cache->file && *cache->file ? cache->file_bytes : cache->bytes;
    uint64_t most = s->ahead_bytes ? s->ahead_bytes : kept / 4 * 3;
    struct error e;
    if (*ahead || !s->ahead || !library)
        return;
    if (!kept)
        log_warn("nothing is spoken ahead: finished sentences are not kept (--cache, --cache-file)");
    else if (voice_pool_settled(pipeline->voices, s->ahead, NULL) &&
             !voice_pool_find(pipeline->voices, s->ahead, NULL, NULL, &e))
        log_warn("nothing is spoken ahead: --library-ahead: %s", e.message);
    else
        *ahead = speak_ahead_open(pipeline, library, s->ahead, most < kept ? most : kept, s->api.text_bytes);
}
