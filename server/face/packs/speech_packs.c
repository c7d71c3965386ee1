/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/face/packs/speech_packs.h"
#include "server/base/lang.h"
#include "server/base/mem.h"
#include "server/face/packs/phone_match.h"
#include <glob.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

static int load_one(struct speech_packs *packs, const char *path, struct error *e) {
    struct error inner = {0};
    struct speech_pack *pack = speech_pack_load(path, &inner);
    if (!pack) {
        char text[320];
        return error_set(e, inner.code, "%s: %s", path, error_text(&inner, text, sizeof text));
    }
    packs->packs = mem_grow(packs->packs, &packs->cap, packs->count + 1, sizeof(struct speech_pack *));
    packs->packs[packs->count++] = pack;
    return 0;
}

int speech_packs_load(struct speech_packs *packs, const char *folder, struct error *e) {
    char pattern[4096];
    glob_t found;
    *packs = (struct speech_packs){0};
    snprintf(pattern, sizeof pattern, "%s/*.json", folder);
    if (glob(pattern, 0, NULL, &found))
        return error_set(e, ERROR_BAD_SPEECH_PACK, "no language pack in '%s'", folder);
    int failed = 0;
    for (size_t i = 0; i < found.gl_pathc && !failed; i++)
        failed = load_one(packs, found.gl_pathv[i], e);
    globfree(&found);
    if (failed)
        speech_packs_free(packs);
    return failed;
}

void speech_packs_free(struct speech_packs *packs) {
    for (size_t i = 0; i < packs->count; i++)
        speech_pack_free(packs->packs[i]);
    free(packs->packs);
    *packs = (struct speech_packs){0};
}

/* BCP 47: "-x-" and what follows is private use. */
static bool is_private(const char *tag) {
    return strstr(tag, "-x-") != NULL;
}

const struct speech_pack *speech_packs_find(const struct speech_packs *packs, const char *lang) {
    lang = lang_usual(lang);
    size_t primary = strcspn(lang, "-_");
    const struct speech_pack *same_language = NULL, *general = NULL;
    for (size_t i = 0; i < packs->count; i++) {
        const char *tag = speech_pack_lang(packs->packs[i]);
        if (!strcasecmp(tag, lang))
            return packs->packs[i];
        if (!same_language && !is_private(tag) && strcspn(tag, "-") == primary &&
            !strncasecmp(tag, lang, primary))
            same_language = packs->packs[i];
        if (speech_pack_is_general(packs->packs[i]))
            general = packs->packs[i];
    }
    return same_language ? same_language : general;
}

const struct speech_pack *speech_packs_spoken(const struct speech_packs *packs,
                                              const struct speech_pack *asked, const char *lang) {
    const char *usual = lang_usual(lang), *tag = speech_pack_lang(asked);
    size_t primary = strcspn(usual, "-_");
    return strcspn(tag, "-") == primary && !strncasecmp(tag, usual, primary) ? asked
                                                                             : speech_packs_find(packs, lang);
}

bool speech_pack_is_general(const struct speech_pack *pack) {
    return !strcmp(speech_pack_lang(pack), SPEECH_PACK_GENERAL);
}

static size_t unknown_phones(const struct speech_pack *pack, const struct sentence_audio *u) {
    struct phone_matches found;
    size_t count = 0;
    for (size_t i = 0; i < u->phone_count; i++) {
        phone_match_find(pack, u->phones[i].ipa, &found);
        count += found.unknown != 0;
    }
    return count;
}

const struct speech_pack *speech_packs_cover(const struct speech_packs *packs, const struct speech_pack *own,
                                             const struct sentence_audio *u) {
    size_t fewest = unknown_phones(own, u);
    for (size_t i = 0; i < packs->count && fewest; i++) {
        size_t unknown = unknown_phones(packs->packs[i], u);
        if (unknown < fewest) {
            fewest = unknown;
            own = packs->packs[i];
        }
    }
    return own;
}
