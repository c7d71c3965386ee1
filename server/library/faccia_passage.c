/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/library/faccia_passage.h"
#include "server/base/mem.h"
#include "server/cli/cli.h"
#include "server/library/directions.h"
#include "server/library/faccia_cast.h"
#include "server/library/library_files.h"
#include "server/library/publish/publish_internal.h"
#include "server/library/work_lexicons.h"
#include <stdlib.h>
#include <string.h>

enum { WORK_BYTES = 256 };

struct passage {
    char work[WORK_BYTES];
    const char *block; /* name; NULL: all of them */
    unsigned number;   /* of the section; 0: all of them */
    struct narration narration;
    const struct settings *settings;
    bool found;
};

/* Reads WORK, WORK:SECTION or WORK:SECTION:BLOCK. */
static int read_place(struct passage *p, const char *place) {
    size_t length = strcspn(place, ":");
    char *end = "";
    snprintf(p->work, sizeof p->work, "%.*s", (int)length, place);
    if (place[length]) {
        unsigned long number = strtoul(place + length + 1, &end, 10);
        p->number = number <= SECTIONS_MAX ? (unsigned)number : 0;
        p->block = *end ? end + 1 : NULL;
        if (!p->number || (*end && *end != ':'))
            length = 0;
    }
    if (length && length < WORK_BYTES)
        return 0;
    cli_complain("--passage: '%s' is not WORK, WORK:SECTION or WORK:SECTION:BLOCK", place);
    return -1;
}

static int speak_section(void *ctx, const struct section *section) {
    struct passage *p = ctx;
    struct narration_part part = {0};
    struct section chosen = *section;
    if (p->number && section->number != p->number)
        return 0;
    for (size_t i = 0; p->block && i < section->count; i++)
        if (!strcmp(section->blocks[i].name, p->block)) {
            chosen.blocks = &section->blocks[i];
            chosen.count = 1;
        }
    if (!p->block || chosen.blocks != section->blocks || !strcmp(section->blocks[0].name, p->block)) {
        p->found = true;
        narration_section(&p->narration, &chosen, &part);
        narration_part_free(&part);
    }
    return p->narration.stopped; /* else the whole work is read: to stop counts as a failure */
}

static int pass_by(void *ctx, const struct section *section) {
    (void)ctx, (void)section;
    return 0;
}

static void pass_over(void *ctx, const struct error *e, bool serious) {
    (void)ctx, (void)e, (void)serious;
}

static void tell(void *ctx, const struct error *e, bool serious) {
    (void)ctx;
    if (serious)
        cli_complain_of(e);
}

static int speak_file(struct passage *p, const char *folder, const char *file, struct cli *cli,
                      struct error *e) {
    const struct work_sink sink = {p, speak_section, tell}, first = {NULL, pass_by, pass_over};
    struct lexicons lexicons = {0};
    struct cast cast = {0};
    struct directions *directions = NULL;
    struct work_meta meta = {.lang = mem_strdup(p->settings->lang)}, again = {.lang = mem_strdup(meta.lang)};
    char moods[4200];
    snprintf(moods, sizeof moods, "%s/directions", p->settings->models);
    int result = library_lexicons_beside(folder, file, &lexicons, e) ||
                 cast_of_file(folder, file, cli, p->settings, &cast, e) ||
                 work_read(folder, file, &meta, &first, e); /* its language, which may stand at its end */
    if (!result && (directions = directions_load(moods, e))) {
        p->narration.lexicons = &lexicons;
        p->narration.cast = &cast;
        p->narration.directions = directions;
        p->narration.lang = meta.lang;
        result = work_read(folder, file, &again, &sink, e);
    }
    if (directions && !result && !p->found)
        result = error_plain(e, p->block ? ERROR_UNKNOWN_PASSAGE : ERROR_UNKNOWN_SECTION);
    work_meta_free(&meta);
    work_meta_free(&again);
    cast_free(&cast);
    directions_free(directions);
    lexicons_free(&lexicons);
    return directions && !result ? 0 : -1;
}

int passage_speak(const struct passage_speaking *s, struct cli *cli, const struct settings *settings) {
    struct passage p = {.settings = settings,
                        .narration = {.pipeline = &cli->components.pipeline,
                                      .request = s->request,
                                      .cast_voices = !s->request->voice,
                                      .segment = s->segment,
                                      .problem = s->problem,
                                      .ctx = s->ctx}};
    struct library_files files = {0};
    struct error e;
    if (read_place(&p, s->passage))
        return -1;
    int result = library_files_list(&files, s->folder, &e);
    const char *file = result ? NULL : library_files_work(&files, p.work);
    if (file)
        result = speak_file(&p, s->folder, file, cli, &e);
    if (!result && !file)
        cli_complain("unknown work '%s' in %s", p.work, s->folder);
    else if (result)
        cli_complain_of(&e);
    library_files_free(&files);
    return file && !result ? 0 : -1;
}
