/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/face/packs/speech_pack.h"
#include "server/base/lang.h"
#include "server/base/mem.h"
#include "server/face/packs/context_table.h"
#include "server/face/packs/phone_match.h"
#include "server/face/packs/speech_pack_internal.h"
#include "server/face/packs/spelling.h"
#include <glob.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

const char *const speech_params[PARAM_COUNT + 1] = {"LI", "LS", "AR", "PI", "PS",
                                                    "EM", "TH", "TA", "TB", NULL};

/* What has been read so far, with a reference to each: a pack that several inherit is read once. */
struct family {
    struct member {
        char *path;
        struct speech_pack *pack;
    } * members;
    size_t count, cap;
};

static struct speech_pack *load(struct family *family, const char *path, int depth, struct error *e);

static void family_free(struct family *family) {
    for (size_t i = 0; i < family->count; i++) {
        free(family->members[i].path);
        speech_pack_free(family->members[i].pack);
    }
    free(family->members);
}

static int load_one(struct speech_packs *packs, struct family *family, const char *path, struct error *e) {
    struct error inner = {0};
    struct speech_pack *pack = load(family, path, 0, &inner);
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
    struct family family = {0};
    *packs = (struct speech_packs){0};
    snprintf(pattern, sizeof pattern, "%s/*.json", folder);
    if (glob(pattern, 0, NULL, &found))
        return error_set(e, ERROR_BAD_SPEECH_PACK, "no language pack in '%s'", folder);
    int failed = 0;
    for (size_t i = 0; i < found.gl_pathc && !failed; i++)
        failed = load_one(packs, &family, found.gl_pathv[i], e);
    globfree(&found);
    family_free(&family);
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

/* In BCP 47 everything from "-x-" on is private use. */
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

enum { MAX_INHERITANCE = 4 };

/* FOLDER of path / name suffix. */
static char *beside(const char *path, const char *name, const char *suffix) {
    const char *slash = strrchr(path, '/');
    size_t folder = slash ? (size_t)(slash - path) + 1 : 0, size = folder + strlen(name) + strlen(suffix) + 1;
    char *out = mem_alloc(size);
    snprintf(out, size, "%.*s%s%s", (int)folder, path, name, suffix);
    return out;
}

static int read_texts(const struct json_place *root, const char *key, char ***out) {
    struct json_place at = json_place_key(root, key);
    return json_place_texts(&at, out);
}

static int read_name(const struct json_place *root, const char *key, char **out) {
    struct json_place at = json_place_key(root, key);
    const char *text;
    if (json_place_text(&at, &text))
        return -1;
    *out = mem_strdup(text);
    return 0;
}

static int read_tag(const struct json_place *root, char **out) {
    struct json_place at = json_place_key(root, "tag");
    const char *tag;
    if (json_place_tag(&at, &tag))
        return -1;
    *out = mem_strdup(tag);
    return 0;
}

/* PLUGIN:VOICE. */
static int read_voices(const struct json_place *root, char ***out) {
    struct json_place at = json_place_key(root, "voices");
    if (json_place_texts(&at, out))
        return -1;
    for (size_t i = 0; (*out)[i]; i++) {
        const char *colon = strchr((*out)[i], ':');
        struct json_place item = json_place_item(&at, i);
        if (!colon || colon == (*out)[i] || !colon[1])
            return json_place_fail(&item, "must be the id of a voice, such as espeak:it");
    }
    return 0;
}

static int read_sources(const struct json_place *root) {
    char **sources;
    if (read_texts(root, "sources", &sources))
        return -1;
    json_texts_free(sources);
    return 0;
}

static int read_fapu(const struct json_place *at, struct speech_fapu *fapu) {
    static const char *const keys[] = {"IRISD", "ES", "ENS", "MNS", "MW", NULL};
    double *const out[] = {&fapu->irisd, &fapu->es, &fapu->ens, &fapu->mns, &fapu->mw};
    if (json_place_keys(at, keys))
        return -1;
    for (size_t i = 0; keys[i]; i++) {
        struct json_place child = json_place_key(at, keys[i]);
        if (json_place_real(&child, 1, 200, out[i]))
            return -1;
    }
    return 0;
}

static int read_rest(const struct json_place *at, struct speech_rest *rest) {
    static const char *const keys[] = {"reach", "leave", "partial", "coefficients", NULL};
    struct json_place reach = json_place_key(at, "reach"), leave = json_place_key(at, "leave"),
                      partial = json_place_key(at, "partial"),
                      coefficients = json_place_key(at, "coefficients");
    if (json_place_keys(at, keys) || json_place_real(&reach, 0, 1, &rest->reach) ||
        json_place_real(&leave, 0, 1, &rest->leave) || json_place_real(&partial, 0.001, 1, &rest->partial) ||
        json_place_object(&coefficients))
        return -1;
    for (int p = 0; p < PARAM_COUNT; p++)
        rest->coefficients[p] = (struct coefficients){.t = 0.5,
                                                      .alpha = 1,
                                                      .k = 1,
                                                      .theta_bw = 10,
                                                      .theta_fw = 10,
                                                      .c_bw = 1,
                                                      .c_fw = 1,
                                                      .p_bw = 1,
                                                      .p_fw = 1};
    return speech_read_parameters(&coefficients, rest->coefficients);
}

static int read_undershoot(const struct json_place *at, double undershoot[PARAM_COUNT]) {
    if (json_place_keys(at, speech_params))
        return -1;
    for (int p = 0; p < PARAM_COUNT; p++) {
        struct json_place child = json_place_key(at, speech_params[p]);
        if (json_place_real(&child, 0, 1, &undershoot[p]))
            return -1;
    }
    return 0;
}

static int read_context_list(const struct json_place *up, const char *key, char ***out, size_t *count) {
    struct json_place at = json_place_key(up, key);
    if (json_place_texts(&at, out))
        return -1;
    *count = json_array_size(at.json);
    if (!*count || *count > SPEECH_MAX_CONTEXTS)
        return json_place_fail(&at, "must have 1 to %d names", SPEECH_MAX_CONTEXTS);
    return 0;
}

static int read_alphabet(struct speech_pack *pack, const struct json_place *at, const char *path) {
    const char *name;
    if (json_place_text(at, &name))
        return -1;
    char *folder = beside(path, "alphabets/", name), *file = beside(folder, name, ".json");
    struct error inner = {0};
    pack->alphabet = alphabet_load(file, &inner);
    free(folder);
    free(file);
    return pack->alphabet ? 0 : json_place_fail_in(at, name, &inner);
}

/* Reads what a pack without "inherits" must define. */
static int read_foundations(struct speech_pack *pack, const struct json_place *root, const char *path) {
    static const char *const keys[] = {"vowels", "consonants", NULL};
    struct json_place alphabet = json_place_key(root, "alphabet"), fapu = json_place_key(root, "fapu"),
                      rest = json_place_key(root, "rest"), undershoot = json_place_key(root, "undershoot"),
                      contexts = json_place_key(root, "contexts");
    if (read_alphabet(pack, &alphabet, path) || read_fapu(&fapu, &pack->fapu) ||
        read_rest(&rest, &pack->rest) || read_undershoot(&undershoot, pack->undershoot) ||
        json_place_keys(&contexts, keys))
        return -1;
    return read_context_list(&contexts, "vowels", &pack->vowel_contexts, &pack->vowel_context_count) ||
                   read_context_list(&contexts, "consonants", &pack->consonant_contexts,
                                     &pack->consonant_context_count)
               ? -1
               : 0;
}

static int read_trough(const struct json_place *at, double *trough) {
    return at->json ? json_place_real(at, 0, 1, trough) : 0;
}

static int inherit(struct family *family, struct speech_pack *pack, const struct json_place *at,
                   const char *path, int depth) {
    const char *name;
    if (json_place_text(at, &name))
        return -1;
    if (depth >= MAX_INHERITANCE)
        return json_place_fail(at, "goes on for more than %d packs", MAX_INHERITANCE);
    char *file = beside(path, name, ".json");
    struct error inner = {0};
    struct speech_pack *base = load(family, file, depth + 1, &inner);
    free(file);
    if (!base)
        return json_place_fail_in(at, name, &inner);
    pack->base = base;
    pack->alphabet = base->alphabet;
    pack->fapu = base->fapu;
    pack->rest = base->rest;
    memcpy(pack->undershoot, base->undershoot, sizeof pack->undershoot);
    pack->trough = base->trough;
    pack->vowel_contexts = base->vowel_contexts;
    pack->vowel_context_count = base->vowel_context_count;
    pack->consonant_contexts = base->consonant_contexts;
    pack->consonant_context_count = base->consonant_context_count;
    pack->longest = base->longest;
    return 0;
}

/* Loads an optional file for an engine from a folder beside the pack. */
static int read_extra(struct speech_pack *pack, const struct json_place *at, const char *folder,
                      const char *path,
                      bool (*load_it)(struct speech_pack *pack, const char *file, struct error *e)) {
    const char *name;
    if (!at->json)
        return 0;
    if (json_place_text(at, &name))
        return -1;
    char *beside_it = beside(path, folder, name), *file = beside(beside_it, name, ".json");
    struct error inner = {0};
    bool is_loaded = load_it(pack, file, &inner);
    free(beside_it);
    free(file);
    return is_loaded ? 0 : json_place_fail_in(at, name, &inner);
}

static bool load_visemes(struct speech_pack *pack, const char *file, struct error *e) {
    pack->visemes = context_table_load(file, pack, e);
    return pack->visemes != NULL;
}

static bool load_letters(struct speech_pack *pack, const char *file, struct error *e) {
    pack->letters = spelling_load(file, pack, e);
    return pack->letters != NULL;
}

static int read_pack(struct family *family, struct speech_pack *pack, const struct json_place *root,
                     const char *path, int depth) {
    static const char *const base_keys[] = {
        "tag",    "name",       "sources",  "voices", "abbreviations", "alphabet", "fapu",   "rest",
        "groups", "undershoot", "contexts", "phones", "visemes",       "letters",  "trough", NULL};
    static const char *const heir_keys[] = {"tag",     "name",          "inherits", "sources",
                                            "voices",  "abbreviations", "groups",   "phones",
                                            "visemes", "letters",       "trough",   NULL};
    struct json_place inherits = json_place_key(root, "inherits"), groups = json_place_key(root, "groups"),
                      phones = json_place_key(root, "phones"), visemes = json_place_key(root, "visemes"),
                      letters = json_place_key(root, "letters"), trough = json_place_key(root, "trough");
    pack->trough = -1;
    if (json_place_keys(root, inherits.json ? heir_keys : base_keys) || read_tag(root, &pack->lang) ||
        read_name(root, "name", &pack->name) || read_sources(root) || read_voices(root, &pack->voices) ||
        read_texts(root, "abbreviations", &pack->abbreviations) ||
        (inherits.json ? inherit(family, pack, &inherits, path, depth)
                       : read_foundations(pack, root, path)) ||
        read_trough(&trough, &pack->trough))
        return -1;
    if ((groups.json || !inherits.json) && speech_read_groups(pack, &groups))
        return -1;
    return speech_read_phones(pack, &phones) || read_extra(pack, &visemes, "visemes/", path, load_visemes) ||
                   read_extra(pack, &letters, "letters/", path, load_letters)
               ? -1
               : 0;
}

/* How many packs a pack inherits, one from the other. */
static int ancestors(const struct speech_pack *pack) {
    int count = 0;
    for (; pack->base; pack = pack->base)
        count++;
    return count;
}

/* Returns a reference. A pack that would make a chain too long is read again, which tells where. */
static struct speech_pack *load(struct family *family, const char *path, int depth, struct error *e) {
    struct json_place root;
    for (size_t i = 0; i < family->count; i++)
        if (!strcmp(family->members[i].path, path) &&
            depth + ancestors(family->members[i].pack) <= MAX_INHERITANCE) {
            family->members[i].pack->references++;
            return family->members[i].pack;
        }
    if (json_place_load(path, ERROR_BAD_SPEECH_PACK, &root, e))
        return NULL;
    struct speech_pack *pack = mem_alloc(sizeof *pack);
    pack->references = 1;
    if (read_pack(family, pack, &root, path, depth)) {
        speech_pack_free(pack);
        pack = NULL;
    }
    json_decref(root.json);
    if (pack) {
        family->members = mem_grow(family->members, &family->cap, family->count + 1, sizeof *family->members);
        pack->references++;
        family->members[family->count++] = (struct member){mem_strdup(path), pack};
    }
    return pack;
}

struct speech_pack *speech_pack_load(const char *path, struct error *e) {
    struct family family = {0};
    struct speech_pack *pack = load(&family, path, 0, e);
    family_free(&family);
    return pack;
}

void speech_pack_free(struct speech_pack *pack) {
    if (!pack || --pack->references)
        return;
    if (!pack->base) {
        alphabet_free(pack->alphabet);
        json_texts_free(pack->vowel_contexts);
        json_texts_free(pack->consonant_contexts);
    }
    for (size_t i = 0; i < pack->phone_count; i++)
        speech_phone_free(pack->phones[i]);
    free(pack->phones);
    for (size_t i = 0; i < pack->group_count; i++)
        free(pack->groups[i].name);
    free(pack->groups);
    context_table_free(pack->visemes);
    spelling_free(pack->letters);
    speech_pack_free(pack->base);
    free(pack->lang);
    free(pack->name);
    json_texts_free(pack->voices);
    json_texts_free(pack->abbreviations);
    free(pack);
}

const char *speech_pack_lang(const struct speech_pack *pack) {
    return pack->lang;
}

const char *speech_pack_name(const struct speech_pack *pack) {
    return pack->name;
}

const char *const *speech_pack_voices(const struct speech_pack *pack) {
    return (const char *const *)pack->voices;
}

const char *const *speech_pack_abbreviations(const struct speech_pack *pack) {
    return (const char *const *)pack->abbreviations;
}
