/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finds the words of a script that lexicons have, and rewrites the script's items. */
#include "server/base/mem.h"
#include "server/markup/languages/pls.h"
#include "server/normalize/lexicon_internal.h"
#include <stdlib.h>
#include <string.h>
#include <strings.h>

/* A text range, in bytes of a stretch, that an entry replaces. */
struct match {
    size_t from, to;
    size_t suffix; /* where a suffix begins that follows the alias; to = none */
    const struct lexicon_entry *entry;
};

/* Adjacent items of one style, and the marks between them: words may cross their bounds, where an entity
 * such as &amp; or a mark is. */
struct stretch {
    size_t first, last; /* items [first, last) of the old script */
    size_t *begins;     /* offset of each item's text; the last entry is the end */
    struct buf text;
    struct tokens tokens;
    struct match *matches;
    size_t match_count, match_cap;
};

struct applying {
    const struct lexicons *lexicons, *named; /* NULL = none */
    const struct lexicon **asked;            /* those for the stretch, by precedence */
    size_t asked_count, asked_cap;
    struct score *script;
    const char *const *langs;
    const void *const *voices;
    struct score_item *items; /* of the new script */
    size_t count, cap;
    size_t *was; /* of each new item: its index in the old script */
    size_t was_cap;
    size_t *begins, *ends;    /* new index where each old item begins, and after it */
    size_t added, added_here; /* bytes of aliases: in the text, and in the sentence */
    bool changed, begun;      /* begun: the sentence has had a word */
    bool told, told_here;
};

static const char *lang_of(const struct applying *a, size_t item) {
    return a->langs[item] ? a->langs[item] : "";
}

/* True if the author did not specify how to say the text. */
static bool is_open(const struct score_item *item) {
    return item->kind == SCORE_TEXT && item->text && !item->given && !item->style->say_as &&
           !item->style->phonemes && !item->parts;
}

static bool joins(const struct applying *a, size_t one, size_t next) {
    const struct score_item *x = &a->script->items[one], *y = &a->script->items[next];
    return is_open(y) && x->style == y->style && !strcasecmp(lang_of(a, one), lang_of(a, next)) &&
           (!a->voices || a->voices[one] == a->voices[next]);
}

/* A lexicon without a region is for all of its language; a text without a region takes any. */
static bool speaks(const struct lexicon *lexicon, const char *lang) {
    const char *own = lexicon_lang(lexicon);
    size_t primary = strcspn(own, "-"), n = strcspn(lang, "-");
    return primary == n && !strncasecmp(own, lang, n) &&
           (!own[primary] || !lang[n] || !strcasecmp(own, lang));
}

static bool is_language(const char *lang, const char *code) {
    return !strncasecmp(lang, code, 2) && (!lang[2] || lang[2] == '-');
}

static bool is_word(const struct tokens *t, size_t i) {
    return i < t->count && t->list[i].kind == TOKEN_WORD;
}

/* True if the token is an apostrophe inside a word. */
static bool is_elision(const struct tokens *t, size_t i) {
    return i && i < t->count && t->list[i].kind == TOKEN_APOSTROPHE && is_word(t, i - 1) && is_word(t, i + 1);
}

/* Elision (l'Adda) lets a word begin after an apostrophe, but not in languages whose words go on after it
 * (don't, Ankara'da). */
static bool may_begin(const struct tokens *t, size_t i, const char *lang) {
    if (t->list[i].kind == TOKEN_SPACE)
        return false;
    return !i || !is_elision(t, i - 1) || !(is_language(lang, "en") || is_language(lang, "tr"));
}

/* True if a word may end before token i. A suffix after an apostrophe can follow an alias, as it joins it:
 * Turkish case, English 's. */
static bool may_end(const struct tokens *t, size_t i, const struct lexicon_entry *entry, const char *lang) {
    if (!is_elision(t, i))
        return true;
    return entry->alias && (is_language(lang, "tr") ||
                            (is_language(lang, "en") && !strcmp(token_key(t, t->list[i + 1].folded), "s")));
}

/* Ways of comparing a spelling with the text. */
enum how { AS_WRITTEN, OPENING /* of a sentence: first letter in lower case */, ANY_CASE };

static size_t key_of(const struct token *token, enum how how, bool first) {
    return how == ANY_CASE ? token->folded : how == OPENING && first ? token->opening : token->exact;
}

/* Matches spellings from token i on. Returns the number of tokens of the longest match, or 0, and sets
 * *entry. */
static size_t follow(const struct lexicon *x, enum how how, const struct tokens *t, size_t i,
                     const char *lang, const struct lexicon_entry **entry) {
    int32_t node = how == ANY_CASE ? LEXICON_FOLDED : LEXICON_EXACT;
    size_t longest = 0;
    for (size_t k = i; k < t->count; k++) {
        node = lexicon_step(x, node, token_key(t, key_of(&t->list[k], how, k == i)));
        if (node < 0)
            break;
        const struct lexicon_entry *here = lexicon_entry_at(x, node);
        if (here && may_end(t, k + 1, here, lang)) {
            longest = k + 1 - i;
            *entry = here;
        }
    }
    return longest;
}

/* Finds the longest spelling at token i in any lexicon; of equally long ones, the first lexicon's. */
static size_t look_up(const struct applying *a, const struct tokens *t, size_t i, const char *lang,
                      const struct lexicon_entry **entry) {
    size_t best = 0;
    if (!may_begin(t, i, lang))
        return 0;
    bool opening = !a->begun && is_word(t, i) && t->list[i].opening != t->list[i].exact;
    for (size_t k = 0; k < a->asked_count; k++) {
        const struct lexicon *x = a->asked[k];
        const struct lexicon_entry *found = NULL;
        for (enum how how = AS_WRITTEN; how <= ANY_CASE; how++) {
            if ((how == OPENING && !opening) || (how == ANY_CASE && !lexicon_folds(x)))
                continue;
            size_t tokens = follow(x, how, t, i, lang, &found);
            if (tokens > best) {
                best = tokens;
                *entry = found;
            }
        }
    }
    return best;
}

static void ask(struct applying *a, const struct lexicon *lexicon, const char *lang) {
    if (!speaks(lexicon, lang))
        return;
    a->asked = mem_grow(a->asked, &a->asked_cap, a->asked_count + 1, sizeof *a->asked);
    a->asked[a->asked_count++] = lexicon;
}

/* Lists the lexicons for a text: those that it names, then those for all texts. */
static void ask_lexicons(struct applying *a, const char *names, const char *lang) {
    a->asked_count = 0;
    for (size_t n; names && *names; names += n + (names[n] == '\n')) {
        n = strcspn(names, "\n");
        for (size_t i = 0; a->named && i < a->named->count; i++)
            if (strlen(a->named->names[i]) == n && !strncmp(a->named->names[i], names, n))
                ask(a, a->named->list[i], lang);
    }
    for (size_t i = 0; a->lexicons && i < a->lexicons->count; i++)
        ask(a, a->lexicons->list[i], lang);
}

size_t lexicons_sign(const void *lexicons, const char *lang, const char *s, size_t n) {
    const struct lexicons *all = lexicons;
    const struct lexicon_entry *entry;
    struct tokens tokens = {0};
    size_t best = 0;
    n = n < PLS_GRAPHEME_BYTES ? n : PLS_GRAPHEME_BYTES;
    for (size_t i = 0; all && i < all->count; i++) {
        const struct lexicon *x = all->list[i];
        if (!lexicon_has_signs(x) || !speaks(x, lang))
            continue;
        if (!tokens.count)
            tokens_read(&tokens, s, n, lang);
        for (enum how how = AS_WRITTEN; how <= ANY_CASE; how += ANY_CASE) {
            size_t count = follow(x, how, &tokens, 0, lang, &entry);
            if (count && tokens.list[count - 1].to > best)
                best = tokens.list[count - 1].to;
        }
    }
    tokens_free(&tokens);
    return best;
}

/* Byte of the input for a byte of the stretch, which lies in that item. */
static size_t place_of(const struct applying *a, const struct stretch *s, size_t item, size_t byte,
                       bool end) {
    const struct score_item *i = &a->script->items[item];
    if (i->verbatim)
        return i->start + (byte - s->begins[item - s->first]);
    return end ? i->end : i->start;
}

static bool has_room(struct applying *a, const struct lexicon_entry *entry, size_t at) {
    size_t bytes = entry->alias ? strlen(entry->alias) : 0;
    bool here = a->added_here + bytes <= LEXICON_SENTENCE, all = a->added + bytes <= LEXICON_TEXT;
    if (here && all) {
        a->added_here += bytes;
        a->added += bytes;
        return true;
    }
    if (!*(here ? &a->told : &a->told_here))
        score_warn(
            a->script, at, ERROR_BAD_VALUE,
            "aliases of the lexicon may put %d bytes into a %s: the words from here are read as written",
            here ? LEXICON_TEXT : LEXICON_SENTENCE, here ? "text" : "sentence");
    *(here ? &a->told : &a->told_here) = true;
    return false;
}

static void find_matches(struct applying *a, struct stretch *s) {
    const char *lang = lang_of(a, s->first);
    const struct tokens *t = &s->tokens;
    size_t item = s->first;
    for (size_t i = 0; i < t->count;) {
        const struct lexicon_entry *entry = NULL;
        size_t count = look_up(a, t, i, lang, &entry), from = t->list[i].from;
        while (item + 1 < s->last && s->begins[item + 1 - s->first] <= from)
            item++;
        if (count && has_room(a, entry, place_of(a, s, item, from, false))) {
            s->matches = mem_grow(s->matches, &s->match_cap, s->match_count + 1, sizeof *s->matches);
            size_t word = t->list[i + count - 1].to;
            count += is_elision(t, i + count) ? 2 : 0; /* the suffix is a part of the word */
            s->matches[s->match_count++] = (struct match){from, t->list[i + count - 1].to, word, entry};
        }
        count += !count;
        for (size_t k = i; k < i + count; k++)
            a->begun |= is_word(t, k);
        i += count;
    }
}

static struct score_item *add_item(struct applying *a, size_t was) {
    size_t cap = a->cap;
    a->items = mem_grow(a->items, &a->cap, a->count + 1, sizeof *a->items);
    a->was = a->cap == cap ? a->was : mem_resize(a->was, a->cap * sizeof *a->was);
    a->was[a->count] = was;
    a->items[a->count] = a->script->items[was];
    return &a->items[a->count++];
}

/* Adds what an item has outside the matches. */
static void add_rest(struct applying *a, const struct stretch *s, size_t item, size_t from, size_t to) {
    if (from >= to)
        return;
    struct score_item *i = add_item(a, item);
    size_t begin = s->begins[item - s->first], end = s->begins[item + 1 - s->first];
    if (from == begin && to == end)
        return;
    i->text = score_strndup(a->script, (const char *)s->text.data + from, to - from);
    i->start = place_of(a, s, item, from, false);
    i->end = place_of(a, s, item, to, true);
}

/* last: the item where the match ends. */
static void add_match(struct applying *a, const struct stretch *s, size_t item, size_t last,
                      const struct match *match) {
    const struct lexicon_entry *entry = match->entry;
    struct score_item *i = add_item(a, item);
    i->start = place_of(a, s, item, match->from, false);
    i->end = place_of(a, s, last, match->to, true);
    i->verbatim &= item == last && !entry->alias;
    i->given = entry->alias != NULL;
    const char *text = (const char *)s->text.data;
    struct buf said = {0};
    if (entry->alias) {
        buf_add(&said, entry->alias, strlen(entry->alias));
        buf_add(&said, text + match->suffix, match->to - match->suffix);
    } else {
        buf_add(&said, text + match->from, match->to - match->from);
    }
    i->text = score_strndup(a->script, (const char *)said.data, said.size);
    buf_free(&said);
    if (entry->ipa) {
        struct score_style style = *i->style;
        style.phonemes = score_strndup(a->script, entry->ipa, strlen(entry->ipa));
        i->style = score_keep_style(a->script, &style);
    }
}

static void copy_items(struct applying *a, size_t first, size_t last) {
    for (size_t i = first; i < last; i++) {
        a->begins[i] = a->count;
        add_item(a, i);
        a->ends[i] = a->count;
    }
}

/* Writes the items of a stretch, cut at its matches. */
static void write_stretch(struct applying *a, const struct stretch *s) {
    size_t next = 0, at = 0, matched = 0; /* matched: new index of the last match */
    for (size_t item = s->first; item < s->last; item++) {
        size_t begin = s->begins[item - s->first], end = s->begins[item + 1 - s->first];
        if (a->script->items[item].kind == SCORE_MARK) { /* in a match, it comes after the match */
            copy_items(a, item, item + 1);
            continue;
        }
        a->begins[item] = at > begin ? matched : a->count; /* an earlier match may reach into it */
        at = at > begin ? at : begin;
        for (; next < s->match_count && s->matches[next].from < end; next++) {
            const struct match *match = &s->matches[next];
            size_t last = item;
            while (s->begins[last + 1 - s->first] < match->to)
                last++;
            add_rest(a, s, item, at, match->from);
            matched = a->count;
            add_match(a, s, item, last, match);
            at = match->to;
        }
        add_rest(a, s, item, at, end);
        a->ends[item] = a->count;
    }
}

static void apply_to_stretch(struct applying *a, size_t first, size_t last) {
    struct stretch s = {.first = first, .last = last};
    ask_lexicons(a, a->script->items[first].style->lexicons, lang_of(a, first));
    if (!a->asked_count) {
        a->begun = true;
        copy_items(a, first, last);
        return;
    }
    s.begins = mem_alloc((last - first + 1) * sizeof *s.begins);
    for (size_t i = first; i < last; i++) {
        const struct score_item *item = &a->script->items[i];
        s.begins[i - first] = s.text.size;
        if (item->kind != SCORE_MARK)
            buf_add(&s.text, item->text, strlen(item->text));
    }
    s.begins[last - first] = s.text.size;
    tokens_read(&s.tokens, (const char *)s.text.data, s.text.size, lang_of(a, first));
    find_matches(a, &s);
    if (s.match_count)
        write_stretch(a, &s);
    else
        copy_items(a, first, last);
    a->changed |= s.match_count > 0;
    tokens_free(&s.tokens);
    buf_free(&s.text);
    free(s.matches);
    free(s.begins);
}

static void apply_to_sentence(struct applying *a, size_t first, size_t end) {
    a->begun = a->told_here = false;
    a->added_here = 0;
    for (size_t i = first; i < end;) {
        size_t last = i + 1;
        if (is_open(&a->script->items[i])) {
            for (size_t text = i, next = last; next < end; next++) {
                if (a->script->items[next].kind == SCORE_MARK)
                    continue;
                if (!joins(a, text, next))
                    break;
                text = next;
                last = next + 1;
            }
            apply_to_stretch(a, i, last);
        } else {
            a->begun |= a->script->items[i].kind == SCORE_TEXT;
            copy_items(a, i, last);
        }
        i = last;
    }
}

/* Converts the indices of items, from the old script to the new one. */
static void renumber(struct applying *a) {
    struct score *script = a->script;
    size_t old = script->item_count;
    a->begins[old] = a->count;
    for (size_t i = 0; i < script->sentence_count; i++) {
        struct score_sentence *s = &script->sentences[i];
        size_t end = a->begins[s->first + s->count];
        s->first = a->begins[s->first];
        s->count = end - s->first;
    }
    for (size_t i = 0; i < script->cue_count; i++) {
        struct score_cue *cue = &script->cues[i];
        bool spans = cue->last > cue->first;
        size_t last = spans ? a->ends[cue->last - 1] : 0;
        cue->first = a->begins[cue->first];
        cue->last = spans ? last : cue->first;
    }
    for (size_t i = 0; i < a->count; i++)
        if (a->items[i].fallback)
            a->items[i].fallback = a->ends[a->was[i] + a->items[i].fallback] - i - 1;
    free(script->items);
    script->items = a->items;
    script->item_count = a->count;
    script->item_cap = a->cap;
}

size_t *lexicons_apply(const struct lexicons *lexicons, const struct lexicons *named, struct score *script,
                       const char *const *langs, const void *const *voices, struct work_limit *limit) {
    struct applying a = {
        .lexicons = lexicons, .named = named, .script = script, .langs = langs, .voices = voices};
    size_t items = script->item_count;
    if (!items || !((lexicons && lexicons->count) || (named && named->count)))
        return NULL;
    a.begins = mem_alloc((items + 1) * sizeof *a.begins);
    a.ends = mem_alloc((items + 1) * sizeof *a.ends);
    for (size_t k = 0; k < script->sentence_count; k++) {
        size_t first = script->sentences[k].first, end = first + script->sentences[k].count;
        if (work_limit_over(limit))
            copy_items(&a, first, end);
        else
            apply_to_sentence(&a, first, end);
    }
    if (a.changed)
        renumber(&a);
    else
        free(a.items);
    free(a.begins);
    free(a.ends);
    free(a.asked);
    if (a.changed)
        return a.was;
    free(a.was);
    return NULL;
}
