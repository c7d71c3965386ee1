/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/daemon/library_setup.h"
#include "server/base/etag.h"
#include "server/base/log.h"
#include "server/base/mem.h"
#include "server/library/recordings/library_voices.h"
#include <errno.h>
#include <jansson.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

/* Creates a folder, and its parents as needed. */
static bool make(const char *folder) {
    return !mkdir(folder, 0700) || errno == EEXIST;
}

static char *index_place(const struct settings *s, struct error *e) {
    struct buf path = {0};
    char *real = realpath(s->library, NULL);
    const char *library = real ? real : s->library;
    uint64_t hash = hash_add(HASH_BEGIN, library, strlen(library)); /* each library has its own index */
    free(real);
    if (s->index)
        return mem_strdup(s->index);
    char *cache = settings_cache_folder();
    if (!cache) {
        error_in_field(e, ERROR_BAD_INDEX, "--library-index", "there is no cache folder: name one");
        return NULL;
    }
    bool well = make(cache);
    buf_printf(&path, "%s/faccia", cache);
    buf_add(&path, "", 1);
    well = well && make((char *)path.data);
    path.size--;
    buf_printf(&path, "/library-%016llx.index", (unsigned long long)hash);
    buf_add(&path, "", 1);
    if (!well)
        error_in_field(e, ERROR_BAD_INDEX, "--library-index", "%.150s: %.80s", cache, strerror(errno));
    free(cache);
    if (!well)
        buf_free(&path);
    return (char *)path.data;
}

/* Adds the recordings to the plugin's configuration, unless that names another folder. */
static char *with_recordings(const char *config, const char *folder, const char *library, const char *lang) {
    json_t *all = config ? json_loads(config, 0, NULL) : json_object();
    char *text = NULL, *real = realpath(library, NULL);
    if (json_is_object(all) && !json_object_get(all, "recording")) {
        json_object_set_new(
            all, "recording",
            json_pack("{ss ss s[s]}", "folder", folder, "lang", lang, "may_read", real ? real : library));
        text = json_dumps(all, JSON_COMPACT);
    }
    json_decref(all);
    free(real);
    return text;
}

static int place_voices(const struct settings *s, const char *index, const struct reader *reader,
                        char **folder, char **config, struct error *e) {
    struct buf path = {0};
    buf_printf(&path, "%s.voices", index);
    buf_add(&path, "", 1);
    *config = NULL;
    int count = library_voices_prepare(s->library, (char *)path.data, s->lang, reader, e);
    *folder = count >= 0 ? realpath((char *)path.data, NULL) : NULL;
    buf_free(&path);
    if (*folder)
        *config = with_recordings(s->voices.config, *folder, s->library, s->lang);
    if (!*config) {
        free(*folder);
        *folder = NULL;
    } else if (!count) { /* the plugin would reject an empty folder */
        free(*config);
        *config = NULL;
    }
    return count < 0 ? -1 : 0;
}

int library_setup_open(const struct settings *s, const struct paths *paths, struct library **library,
                       char **voice_config, struct error *e) {
    *library = NULL;
    *voice_config = NULL;
    if (!s->library)
        return 0;
    char *index = index_place(s, e), *voices = NULL;
    struct buf plugin = {0};
    buf_printf(&plugin, "%s/espeak.so", s->voices.plugin_dir);
    buf_add(&plugin, "", 1);
    char normalization[4096], spellings[4200], directions[4200];
    snprintf(normalization, sizeof normalization, "%s/normalization", s->models);
    snprintf(directions, sizeof directions, "%s/directions", s->models);
    snprintf(spellings, sizeof spellings, "%s/spelling", normalization);
    const struct aligner aligner = {.program = paths->aligner,
                                    .worker = s->voices.worker,
                                    .plugin = (char *)plugin.data,
                                    .normalization = normalization,
                                    .percent = *paths->aligner ? s->align_percent : 0,
                                    .megabytes = s->voices.megabytes,
                                    .unconfined = s->voices.unconfined};
    const struct reader reader = {paths->reader, s->voices.unconfined};
    if (!*paths->reader)
        log_warn("faccia-reader is missing: works are read without limits and sandbox");
    if (index && !place_voices(s, index, &reader, &voices, voice_config, e))
        *library = library_open(&(struct library_options){.folder = s->library,
                                                          .index = index,
                                                          .voices = voices,
                                                          .lang = s->lang,
                                                          .spellings = spellings,
                                                          .directions = directions,
                                                          .aligner = aligner,
                                                          .reader = reader},
                                e);
    buf_free(&plugin);
    free(index);
    free(voices);
    return *library ? 0 : -1;
}

int library_setup_voices(const struct settings *s, char **voice_config, struct error *e) {
    char *index = index_place(s, e), *voices = NULL;
    int result = index ? place_voices(s, index, NULL, &voices, voice_config, e) : -1;
    free(index);
    free(voices);
    return result;
}
