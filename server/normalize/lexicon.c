/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A lexicon: a tree of spellings, whose branches are words. A step is a look-up in one hash table, so that
 * the cost of a match depends neither on the number of entries nor on how many of them begin alike. */
#include "server/normalize/lexicon.h"
#include "server/base/mem.h"
#include "server/markup/languages/pls.h"
#include "server/normalize/lexicon_internal.h"
#include <dirent.h>
#include <errno.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct node {
    int32_t parent;
    uint32_t hash;
    uint32_t key;   /* offset in keys */
    uint32_t entry; /* 1 + index; 0 = none ends here */
};

struct lexicon {
    atomic_uint refs;
    char lang[36];
    char *name;         /* of its file; NULL = none */
    struct node *nodes; /* the first two are the roots */
    size_t node_count, node_cap;
    uint32_t *table; /* 1 + index of a node; 0 = empty; its size is a power of two */
    size_t table_size;
    struct buf keys;
    struct lexicon_entry *entries;
    size_t entry_count, entry_cap;
    size_t spellings, left_out;
    bool folds, signs, full;
    struct score *notes; /* owns the entries' strings; its warnings */
};

static uint32_t hash_of(int32_t parent, const char *key) {
    uint32_t hash = 2166136261u ^ (uint32_t)parent;
    hash *= 16777619u;
    for (; *key; key++)
        hash = (hash ^ (unsigned char)*key) * 16777619u;
    return hash ^ hash >> 15;
}

/* Slot of the node, or the empty slot for it. */
static size_t slot_of(const struct lexicon *x, int32_t parent, const char *key, uint32_t hash) {
    size_t mask = x->table_size - 1, slot = hash & mask;
    for (; x->table[slot]; slot = (slot + 1) & mask) {
        const struct node *node = &x->nodes[x->table[slot] - 1];
        if (node->hash == hash && node->parent == parent && !strcmp((char *)x->keys.data + node->key, key))
            break;
    }
    return slot;
}

int32_t lexicon_step(const struct lexicon *x, int32_t node, const char *key) {
    if (!*key) /* a word that is too long for any spelling */
        return LEXICON_NONE;
    uint32_t at = x->table[slot_of(x, node, key, hash_of(node, key))];
    return at ? (int32_t)at - 1 : LEXICON_NONE;
}

const struct lexicon_entry *lexicon_entry_at(const struct lexicon *x, int32_t node) {
    uint32_t entry = x->nodes[node].entry;
    return entry ? &x->entries[entry - 1] : NULL;
}

bool lexicon_has_signs(const struct lexicon *x) {
    return x->signs;
}

bool lexicon_folds(const struct lexicon *x) {
    return x->folds;
}

static void widen(struct lexicon *x) {
    free(x->table);
    x->table_size *= 2;
    x->table = mem_alloc(x->table_size * sizeof *x->table);
    for (size_t i = 2; i < x->node_count; i++) {
        size_t slot = x->nodes[i].hash & (x->table_size - 1);
        while (x->table[slot])
            slot = (slot + 1) & (x->table_size - 1);
        x->table[slot] = (uint32_t)i + 1;
    }
}

static int32_t add_step(struct lexicon *x, int32_t parent, const char *key) {
    uint32_t hash = hash_of(parent, key);
    size_t slot = slot_of(x, parent, key, hash);
    if (x->table[slot])
        return (int32_t)x->table[slot] - 1;
    x->nodes = mem_grow(x->nodes, &x->node_cap, x->node_count + 1, sizeof *x->nodes);
    x->nodes[x->node_count] = (struct node){parent, hash, (uint32_t)x->keys.size, 0};
    buf_add(&x->keys, key, strlen(key) + 1);
    x->table[slot] = (uint32_t)++x->node_count;
    if (2 * x->node_count > x->table_size)
        widen(x);
    return (int32_t)x->node_count - 1;
}

static void on_language(void *ctx, const char *lang) {
    struct lexicon *x = ctx;
    snprintf(x->lang, sizeof x->lang, "%s", lang);
}

static void leave_out(struct lexicon *x, size_t at, const char *why) {
    score_warn(x->notes, at, ERROR_BAD_VALUE, "%s: it is left out", why);
    x->left_out++;
}

static void add_spelling(struct lexicon *x, const struct pls_lexeme *lexeme, size_t i, uint32_t entry) {
    struct tokens tokens = {0};
    size_t at = lexeme->places[i];
    tokens_read(&tokens, lexeme->graphemes[i], strlen(lexeme->graphemes[i]), x->lang);
    if (x->spellings == LEXICON_ENTRIES) {
        if (!x->full)
            score_warn(x->notes, at, ERROR_BAD_VALUE, "a lexicon may have %d graphemes: the rest is left out",
                       LEXICON_ENTRIES);
        x->full = true;
        x->left_out++;
    } else if (tokens.count > LEXICON_TOKENS) {
        leave_out(x, at, "the grapheme has more than 32 words, spaces and signs");
    } else {
        int32_t node = lexeme->any_case ? LEXICON_FOLDED : LEXICON_EXACT;
        for (size_t k = 0; k < tokens.count; k++)
            node = add_step(
                x, node, token_key(&tokens, lexeme->any_case ? tokens.list[k].folded : tokens.list[k].exact));
        if (x->nodes[node].entry) {
            score_warn(x->notes, at, ERROR_IGNORED,
                       "the grapheme \"%.60s\" stands in an earlier lexeme, which has the say",
                       lexeme->graphemes[i]);
        } else {
            x->nodes[node].entry = entry;
            x->spellings++;
            x->folds |= lexeme->any_case;
            x->signs |= tokens.count && tokens.list[0].kind == TOKEN_SIGN && (*lexeme->graphemes[i] & 0x80);
        }
    }
    tokens_free(&tokens);
}

static void on_lexeme(void *ctx, const struct pls_lexeme *lexeme) {
    struct lexicon *x = ctx;
    x->entries = mem_grow(x->entries, &x->entry_cap, x->entry_count + 1, sizeof *x->entries);
    x->entries[x->entry_count++] = (struct lexicon_entry){lexeme->alias, lexeme->ipa};
    for (size_t i = 0; i < lexeme->count; i++)
        add_spelling(x, lexeme, i, (uint32_t)x->entry_count);
}

struct lexicon *lexicon_read(const char *text, size_t size, struct error *e) {
    struct lexicon *x = mem_alloc(sizeof *x);
    struct pls_sink sink = {on_language, on_lexeme, x, 0};
    atomic_init(&x->refs, 1);
    x->table_size = 64;
    x->table = mem_alloc(x->table_size * sizeof *x->table);
    x->nodes = mem_grow(x->nodes, &x->node_cap, 2, sizeof *x->nodes);
    x->nodes[0] = x->nodes[1] = (struct node){.parent = LEXICON_NONE};
    x->node_count = 2;
    x->notes = score_new();
    x->notes->input = text;
    x->notes->input_size = size;
    int failed = pls_read(x->notes, &sink, e);
    x->notes->input = NULL; /* the caller's */
    x->left_out += sink.left_out;
    if (!failed)
        return x;
    lexicon_free(x);
    return NULL;
}

struct lexicon *lexicon_read_sent(const char *text, size_t size, struct error *e) {
    struct error inner = {0};
    struct lexicon *x = NULL;
    if (size > LEXICON_SENT)
        error_set(&inner, ERROR_BAD_LEXICON, "it may have at most %d bytes", LEXICON_SENT);
    else
        x = lexicon_read(text, size, &inner);
    if (x)
        return x;
    *e = inner;
    e->code = ERROR_BAD_LEXICON;
    snprintf(e->message, sizeof e->message, "the lexicon: %.240s", inner.message);
    return NULL;
}

struct lexicon *lexicon_load(const char *path, struct error *e) {
    FILE *file = fopen(path, "rb");
    if (file)
        return lexicon_load_file(file, path, e);
    error_set(e, ERROR_BAD_LEXICON, "%s: %s", path, strerror(errno));
    return NULL;
}

struct lexicon *lexicon_load_file(FILE *file, const char *path, struct error *e) {
    struct error inner = {0};
    struct lexicon *lexicon = NULL;
    struct buf text = {0};
    int why = buf_add_stream(&text, file, LEXICON_BYTES);
    if (why == EFBIG)
        error_set(&inner, ERROR_BAD_LEXICON, "a lexicon may have at most %d bytes", LEXICON_BYTES);
    else if (why)
        error_set(&inner, ERROR_BAD_LEXICON, "%s", strerror(why));
    else
        lexicon = lexicon_read((const char *)text.data, text.size, &inner);
    fclose(file);
    buf_free(&text);
    if (!lexicon) {
        char message[320];
        error_set(e, inner.code, "%s:%s%s", path, inner.place == PLACE_LINE ? "" : " ",
                  error_text(&inner, message, sizeof message));
        return NULL;
    }
    const char *slash = strrchr(path, '/');
    lexicon->name = mem_strdup(slash ? slash + 1 : path);
    return lexicon;
}

struct lexicon *lexicon_share(struct lexicon *x) {
    atomic_fetch_add(&x->refs, 1);
    return x;
}

void lexicon_free(struct lexicon *x) {
    if (!x || atomic_fetch_sub(&x->refs, 1) > 1)
        return;
    free(x->name);
    free(x->nodes);
    free(x->table);
    free(x->entries);
    buf_free(&x->keys);
    score_free(x->notes);
    free(x);
}

const char *lexicon_lang(const struct lexicon *x) {
    return x->lang;
}

const char *lexicon_name(const struct lexicon *x) {
    return x->name ? x->name : "";
}

size_t lexicon_count(const struct lexicon *x) {
    return x->spellings;
}

size_t lexicon_left_out(const struct lexicon *x) {
    return x->left_out;
}

const struct error *lexicon_warnings(const struct lexicon *x, size_t *count) {
    *count = x->notes->warning_count;
    return x->notes->warnings;
}

void lexicons_add(struct lexicons *lexicons, struct lexicon *lexicon) {
    lexicons->list = mem_grow(lexicons->list, &lexicons->cap, lexicons->count + 1, sizeof *lexicons->list);
    lexicons->list[lexicons->count++] = lexicon;
}

void lexicons_add_all(struct lexicons *lexicons, const struct lexicons *others) {
    for (size_t i = 0; others && i < others->count; i++)
        lexicons_add(lexicons, lexicon_share(others->list[i]));
}

int lexicons_load(struct lexicons *lexicons, const char *path, struct error *e) {
    struct lexicon *lexicon = lexicon_load(path, e);
    if (!lexicon)
        return -1;
    lexicons_add(lexicons, lexicon);
    lexicons->names = mem_resize(lexicons->names, (lexicons->count + 1) * sizeof *lexicons->names);
    lexicons->names[lexicons->count - 1] = lexicon->name;
    lexicons->names[lexicons->count] = NULL;
    return 0;
}

static int is_pls(const struct dirent *entry) {
    const char *dot = strrchr(entry->d_name, '.');
    return entry->d_name[0] != '.' && dot && !strcmp(dot, ".pls");
}

int lexicons_load_folder(struct lexicons *lexicons, const char *folder, struct error *e) {
    struct dirent **entries;
    char path[4096];
    int count = scandir(folder, &entries, is_pls, alphasort), result = 0;
    if (count < 0)
        return error_set(e, ERROR_BAD_LEXICON, "%s: %s", folder, strerror(errno));
    if (count > LEXICON_FILES)
        result = error_set(e, ERROR_BAD_LEXICON, "%s: a folder may have %d lexicons", folder, LEXICON_FILES);
    for (int i = 0; i < count; i++) {
        snprintf(path, sizeof path, "%s/%s", folder, entries[i]->d_name);
        if (!result)
            result = lexicons_load(lexicons, path, e);
        free(entries[i]);
    }
    free(entries);
    return result;
}

void lexicons_free(struct lexicons *lexicons) {
    for (size_t i = 0; i < lexicons->count; i++)
        lexicon_free(lexicons->list[i]);
    free(lexicons->list);
    free(lexicons->names);
    *lexicons = (struct lexicons){0};
}
