/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/mem.h"
#include "server/base/utf8.h"
#include "server/markup/dialogue_internal.h"
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <utf8proc.h>

enum {
    NAMES_MOST = 300,
    NAME_BYTES = 64,
    NAME_WORDS = 5,
    TOKENS_MOST = 40, /* of a sentence of the narrator */
    SENTENCE_BYTES = 400,
    WORD_BYTES = 32,
    FILL_MOST = 12, /* turns that go on by themselves */
};

#define NOBODY SIZE_MAX

enum mark { MARK_NONE, MARK_COMMA, MARK_COLON, MARK_END };

struct token {
    size_t from, to;
    char lower[WORD_BYTES];
    bool capital, declined; /* declined: with an ending after an apostrophe ("Alice's", "Ahmet'e") */
    enum mark mark;         /* after it */
};

struct sentence {
    struct token list[TOKENS_MOST];
    size_t count;
};

/* A person. */
struct name {
    char id[NAME_BYTES];                      /* the words in lower case, joined by hyphens */
    size_t from, to;                          /* where it stands in the text */
    char first[WORD_BYTES], last[WORD_BYTES]; /* words without titles */
    size_t words;
    int sex;     /* by its title: 1 male, -1 female, 0 not known */
    size_t same; /* a fuller name of the person, or this one */
    size_t uses; /* turns */
    size_t speaker;
};

struct naming {
    const char *text;
    const struct dialogue_words *words;
    struct name *names;
    size_t count;
};

static bool is_letter(uint32_t c) {
    utf8proc_category_t category = utf8proc_category((utf8proc_int32_t)c);
    return category >= UTF8PROC_CATEGORY_LU && category <= UTF8PROC_CATEGORY_LO;
}

static bool is_capital(uint32_t c) {
    return utf8proc_category((utf8proc_int32_t)c) == UTF8PROC_CATEGORY_LU;
}

static uint32_t letter_at(const char *text, size_t at, size_t to, size_t *after) {
    uint32_t c = ' ';
    size_t n = at < to ? utf8_next(text + at, to - at, &c) : 0;
    *after = at + (n ? n : 1);
    return n ? c : ' ';
}

static bool is_apostrophe(uint32_t c) {
    return c == '\'' || c == 0x2019;
}

/* Reads a word. An apostrophe ends it, with what follows where that is an ending. */
static size_t read_word(const struct naming *n, size_t at, size_t to, struct token *t) {
    size_t after, length = 0;
    uint32_t c = letter_at(n->text, at, to, &after);
    *t =
        (struct token){.from = at, .capital = utf8proc_category((utf8proc_int32_t)c) == UTF8PROC_CATEGORY_LU};
    for (size_t next;
         at < to && (is_letter(c) || (c == '-' && is_capital(letter_at(n->text, after, to, &next))));
         at = after, c = letter_at(n->text, at, to, &after)) {
        char bytes[4];
        uint32_t small =
            c == 'I' && n->words->verb_last ? 0x131 : (uint32_t)utf8proc_tolower((utf8proc_int32_t)c);
        size_t size = utf8_put(small, bytes);
        if (length + size < WORD_BYTES) {
            memcpy(t->lower + length, bytes, size);
            length += size;
        }
    }
    t->to = at;
    bool endings = n->words->verb_last || !strcmp(n->words->lang, "en");
    if (endings && at < to && is_apostrophe(c) && is_letter(letter_at(n->text, after, to, &after))) {
        t->declined = true;
        for (at = after; at < to && is_letter(letter_at(n->text, at, to, &after)); at = after)
            ;
    }
    return at;
}

/* True for an abbreviation, whose full stop does not end a sentence. */
static bool is_short(const struct naming *n, const struct token *t) {
    size_t length = strlen(t->lower);
    return length <= 3 && (length == 1 ? t->capital
                                       : dialogue_word_in(n->words->male, t->lower) ||
                                             dialogue_word_in(n->words->female, t->lower) ||
                                             dialogue_word_in(n->words->titles, t->lower));
}

static enum mark mark_of(const struct naming *n, const struct token *t, uint32_t c) {
    switch (c) {
    case ',':
    case 0x2013:
    case 0x2014:
    case '(':
    case ')':
        return MARK_COMMA;
    case ':':
        return MARK_COLON;
    case '.':
        return is_short(n, t) ? MARK_NONE : MARK_END;
    case '!':
    case '?':
    case ';':
    case 0x2026:
        return MARK_END;
    default:
        return MARK_NONE;
    }
}

/* Reads the words of [from, to), to the end of the first sentence. Returns where it ends. */
static size_t read_sentence(const struct naming *n, size_t from, size_t to, struct sentence *s) {
    s->count = 0;
    for (size_t at = from, after; at < to; at = after) {
        uint32_t c = letter_at(n->text, at, to, &after);
        struct token *last = s->count ? &s->list[s->count - 1] : NULL;
        if (is_letter(c)) {
            if (s->count == TOKENS_MOST)
                return at;
            after = read_word(n, at, to, &s->list[s->count++]);
        } else if (last) {
            enum mark mark = mark_of(n, last, c);
            last->mark = mark > last->mark ? mark : last->mark;
            if (mark == MARK_END)
                return after;
        }
    }
    return to;
}

/* Reads the last sentence before `to`. */
static void read_last(const struct naming *n, size_t from, size_t to, struct sentence *s) {
    struct sentence next;
    if (to - from > SENTENCE_BYTES)
        from = to - SENTENCE_BYTES;
    while (from < to && ((unsigned char)n->text[from] & 0xC0) == 0x80)
        from++;
    s->count = 0;
    while (from < to) {
        from = read_sentence(n, from, to, &next);
        if (next.count)
            *s = next;
    }
}

static bool is_title(const struct dialogue_words *w, const char *word) {
    return dialogue_word_in(w->male, word) || dialogue_word_in(w->female, word) ||
           dialogue_word_in(w->titles, word);
}

static bool is_particle(const char *word) {
    return dialogue_word_in(" de da do dos das di del della von van der la le du ", word);
}

static bool may_be_name(const struct dialogue_words *w, const struct token *t) {
    return t->capital && !t->declined && t->lower[0] && t->lower[1] && !dialogue_word_in(w->others, t->lower);
}

/* Reads a name at token `at`, perhaps with titles. Returns the token after it; `at`: none. */
static size_t read_name(const struct naming *n, const struct sentence *s, size_t at, struct name *out) {
    const struct dialogue_words *w = n->words;
    size_t end = at, length = 0;
    *out = (struct name){0};
    for (size_t i = at; i < s->count && i < at + NAME_WORDS; i++) {
        const struct token *t = &s->list[i];
        bool title = is_title(w, t->lower) && !t->declined && (t->capital || i == at || end == i);
        bool joins =
            out->words && i + 1 < s->count && is_particle(t->lower) && may_be_name(w, &s->list[i + 1]);
        if (!title && !joins && !may_be_name(w, t))
            break;
        if (title && !t->capital && out->words)
            break;
        int written =
            snprintf(out->id + length, sizeof out->id - length, "%s%s", length ? "-" : "", t->lower);
        if (written < 0 || length + (size_t)written >= sizeof out->id)
            break;
        length += (size_t)written;
        if (title) {
            out->sex = dialogue_word_in(w->male, t->lower)     ? 1
                       : dialogue_word_in(w->female, t->lower) ? -1
                                                               : out->sex;
        } else if (!joins) {
            memcpy(out->words ? out->last : out->first, t->lower, WORD_BYTES);
            if (!out->words)
                memcpy(out->last, t->lower, WORD_BYTES);
            out->words++;
        }
        if (out->words && !joins)
            end = i + 1;
        if (t->mark != MARK_NONE)
            break;
    }
    const struct token *first = &s->list[at];
    if (at < s->count && !out->words && first->capital && !first->declined &&
        length == strlen(first->lower) && is_title(w, first->lower) && !is_short(n, first)) { /* "the King" */
        memcpy(out->first, first->lower, WORD_BYTES);
        memcpy(out->last, first->lower, WORD_BYTES);
        out->words = 1;
        end = at + 1;
    }
    if (!out->words || end == at)
        return at;
    out->from = s->list[at].from;
    out->to = s->list[end - 1].to;
    return end;
}

/* Looks for a name right after the verb at `verb`. */
static bool name_after_verb(const struct naming *n, const struct sentence *s, size_t verb, struct name *out) {
    size_t at = verb + 1;
    if (s->list[verb].mark != MARK_NONE)
        return false;
    for (size_t skipped = 0; at < s->count && skipped < 3; at++, skipped++) {
        if (read_name(n, s, at, out) > at)
            return true;
        if (s->list[at].capital || s->list[at].mark != MARK_NONE ||
            !dialogue_word_in(n->words->between, s->list[at].lower))
            return false;
    }
    return at < s->count && read_name(n, s, at, out) > at;
}

/* Looks for a name at the beginning of a sentence, and a verb soon after it. */
static bool name_before_verb(const struct naming *n, const struct sentence *s, struct name *out) {
    size_t end = read_name(n, s, 0, out);
    size_t most = n->words->verb_last ? s->count : end + 3;
    if (!end)
        return false;
    for (size_t i = end; i < s->count && i < most; i++) {
        if (!n->words->verb_last && s->list[i - 1].mark != MARK_NONE)
            return false;
        if (dialogue_word_in(n->words->verbs, s->list[i].lower))
            return true;
    }
    return false;
}

/* Reads the narrator's words after a quotation. */
static bool name_after(const struct naming *n, size_t from, size_t to, struct name *out, bool *told) {
    struct sentence s;
    read_sentence(n, from, to, &s);
    for (size_t i = 0; i < s.count && i < 4; i++) {
        if (dialogue_word_in(n->words->verbs, s.list[i].lower)) {
            *told = true;
            return name_after_verb(n, &s, i, out) || name_before_verb(n, &s, out);
        }
        if (s.list[i].capital || s.list[i].mark != MARK_NONE)
            break;
    }
    return name_before_verb(n, &s, out);
}

/* Returns the number of a name; NOBODY: it is new. */
static size_t number_known(const struct naming *n, const struct name *name) {
    for (size_t i = 0; i < n->count; i++)
        if (!strcmp(n->names[i].id, name->id))
            return i;
    return NOBODY;
}

/* Returns the number of a name, adding it. */
static size_t number_of(struct naming *n, const struct name *name) {
    size_t known = number_known(n, name);
    if (known != NOBODY)
        n->names[known].uses++;
    if (known != NOBODY || n->count == NAMES_MOST)
        return known;
    n->names[n->count] = *name;
    n->names[n->count].same = n->count;
    n->names[n->count].uses = 1;
    return n->count++;
}

/* A single word at the beginning of a sentence, away from the verb, may have a capital for this only: it must
 * be a name elsewhere.
 */
static bool is_sure(const struct naming *n, const struct name *name, size_t at) {
    return at || name->words > 1 || strlen(name->id) > strlen(name->first) || number_known(n, name) != NOBODY;
}

/* Reads the narrator's words before a quotation, which lead to it by a colon or a comma. */
static bool name_before(const struct naming *n, size_t from, size_t to, struct name *out) {
    struct sentence s;
    read_last(n, from, to, &s);
    if (!s.count || s.list[s.count - 1].mark == MARK_END || s.list[s.count - 1].mark == MARK_NONE)
        return false;
    bool colon = s.list[s.count - 1].mark == MARK_COLON;
    for (size_t v = s.count; v-- > 0;) {
        if (!dialogue_word_in(n->words->verbs, s.list[v].lower))
            continue;
        if (name_after_verb(n, &s, v, out))
            return true;
        if (v && dialogue_word_in(n->words->pronouns, s.list[v - 1].lower))
            return false;
        for (size_t i = v; i-- > 0;) {
            size_t first = i;
            while (first && (s.list[first - 1].capital || is_title(n->words, s.list[first - 1].lower)) &&
                   s.list[first - 1].mark == MARK_NONE && read_name(n, &s, first - 1, out) > first)
                first--;
            if (read_name(n, &s, first, out) > i &&
                !(first && dialogue_word_in(n->words->before, s.list[first - 1].lower)))
                return i + 1 == v || is_sure(n, out, first);
        }
        return false;
    }
    return (colon || n->words->verb_last) && read_name(n, &s, 0, out) > 0 && is_sure(n, out, 0);
}

/* True if b is a fuller name for a single word without a title: "Elizabeth Bennet", "Mr. Darcy". "Miss
 * Bennet" is not any Miss Bennet, but the eldest. */
static bool is_fuller(const struct name *a, const struct name *b) {
    bool titled = strlen(a->id) > strlen(a->first), more = b->words > 1 || strlen(b->id) > strlen(b->first);
    return a->words == 1 && !titled && more && (!strcmp(a->first, b->first) || !strcmp(a->first, b->last));
}

/* Joins names of a person, if nobody else is called so. */
static void join_names(struct naming *n) {
    for (size_t i = 0; i < n->count; i++) {
        size_t fuller = NOBODY;
        bool several = false;
        for (size_t k = 0; k < n->count; k++)
            if (k != i && is_fuller(&n->names[i], &n->names[k])) {
                several = several || fuller != NOBODY;
                fuller = k;
            }
        if (fuller != NOBODY && !several)
            n->names[i].same = fuller;
    }
    for (size_t i = 0; i < n->count; i++)
        for (size_t steps = 0; n->names[n->names[i].same].same != n->names[i].same && steps < 3; steps++)
            n->names[i].same = n->names[n->names[i].same].same;
}

/* Returns the name by which the text calls the person most often: the same one in each section of a work. */
static struct name *usual_name(struct naming *n, size_t person) {
    struct name *best = &n->names[person];
    for (size_t i = 0; i < n->count; i++)
        if (n->names[i].same == person && n->names[i].uses > best->uses)
            best = &n->names[i];
    return best;
}

/* Finds who is said to speak the turn. *told: the narrator's words do say who, perhaps by a pronoun. */
static size_t name_of_turn(struct naming *n, const struct speaker_runs *runs, const struct dialogue_turn *t,
                           bool *told) {
    struct name name;
    *told = false;
    for (size_t i = 0; i < t->count && !*told; i++) {
        const struct speaker_run *run = &runs->list[t->first + i];
        size_t next = i + 1 < t->count ? run[1].from : t->to;
        if (name_after(n, run->to, next, &name, told))
            return number_of(n, &name);
    }
    size_t from = t->from;
    for (size_t i = 0; i < t->count; i++) {
        const struct speaker_run *run = &runs->list[t->first + i];
        if (name_before(n, from, run->from, &name))
            return number_of(n, &name);
        if (*told)
            break;
        from = run->to;
    }
    return NOBODY;
}

/* Finds a person, known by other turns, whose doing is told beside the speech. */
static size_t doer_of_turn(const struct naming *n, const struct speaker_runs *runs,
                           const struct dialogue_turn *t) {
    const struct speaker_run *first = &runs->list[t->first], *last = &first[t->count - 1];
    for (size_t i = 0; i < 2; i++) {
        struct sentence s;
        struct name name;
        if (i)
            read_last(n, t->from, first->from, &s);
        else
            read_sentence(n, last->to, t->to, &s);
        size_t end = read_name(n, &s, 0, &name);
        if (end && end < s.count && !s.list[end].capital && s.list[end - 1].mark == MARK_NONE &&
            number_known(n, &name) != NOBODY)
            return number_known(n, &name);
    }
    return NOBODY;
}

/* Turns between two named ones of the same two persons, and after them. */
static void fill_turns(const struct dialogue_turn *turns, size_t count, size_t *who) {
    for (size_t i = 0; i < count; i++)
        if (who[i] == NOBODY && turns[i].goes_on && i && !turns[i].begins)
            who[i] = who[i - 1];
    for (size_t i = 1; i + 1 < count; i++) {
        size_t a = who[i - 1], b = who[i], to = i + 1;
        if (a == NOBODY || b == NOBODY || a == b || turns[i].begins || turns[i].apart)
            continue;
        while (to < count && who[to] == NOBODY && !turns[to].begins && !turns[to].apart && to - i < FILL_MOST)
            to++;
        bool ends = to == count || turns[to].begins || turns[to].apart || who[to] == NOBODY;
        size_t due = (to - i) % 2 ? a : b;
        for (size_t k = i + 1; k < to && (ends || who[to] == due); k++)
            who[k] = (k - i) % 2 ? a : b;
    }
    for (size_t i = count; i-- > 1;) { /* the same, from the end */
        if (who[i - 1] != NOBODY || turns[i].begins || turns[i].apart || i + 1 >= count ||
            turns[i + 1].begins || turns[i + 1].apart)
            continue;
        if (who[i] != NOBODY && who[i + 1] != NOBODY && who[i] != who[i + 1] && !turns[i - 1].goes_on)
            who[i - 1] = who[i + 1];
    }
}

static size_t speaker_of(struct naming *n, struct speaker_runs *runs, struct name *name) {
    static const double pitches[3][4] = {
        {1.16, 1.24, 1.1, 1.3}, {1.08, 0.92, 1.2, 0.8}, {0.88, 0.96, 0.8, 0.84}};
    if (!name->speaker) {
        runs->speakers = mem_resize(runs->speakers, (runs->speaker_count + 1) * sizeof *runs->speakers);
        runs->speakers[runs->speaker_count] =
            (struct speaker){.id = mem_strdup(name->id),
                             .name = mem_strndup(n->text + name->from, name->to - name->from),
                             .pitch = pitches[name->sex + 1][runs->speaker_count % 4],
                             .rate = 1};
        name->speaker = runs->speaker_count++;
    }
    return name->speaker;
}

void dialogue_name(struct speaker_runs *runs, const struct dialogue_turn *turns, size_t count,
                   const char *text, const char *lang, size_t unsure) {
    struct naming n = {.text = text, .words = dialogue_words_of(lang)};
    if (!n.words || !count)
        return;
    size_t *who = mem_alloc(count * sizeof *who);
    bool *told = mem_alloc(count * sizeof *told);
    n.names = mem_alloc(NAMES_MOST * sizeof *n.names);
    for (size_t pass = 0; pass < 2; pass++) /* the second one knows the names of the first */
        for (size_t i = 0; i < count; i++)
            who[i] = name_of_turn(&n, runs, &turns[i], &told[i]);
    join_names(&n);
    for (size_t i = 0; i < count; i++) {
        who[i] = who[i] == NOBODY && !told[i] ? doer_of_turn(&n, runs, &turns[i]) : who[i];
        who[i] = who[i] == NOBODY ? NOBODY : n.names[who[i]].same;
    }
    fill_turns(turns, count, who);
    for (size_t from = 0, to; from < count; from = to) {
        bool named = who[from] != NOBODY;
        for (to = from + 1; to < count && !turns[to].begins; to++)
            named = named || who[to] != NOBODY;
        for (size_t i = from; named && i < to; i++) {
            size_t speaker = who[i] == NOBODY ? unsure : speaker_of(&n, runs, usual_name(&n, who[i]));
            for (size_t k = 0; k < turns[i].count; k++)
                runs->list[turns[i].first + k].speaker = speaker;
        }
    }
    free(n.names);
    free(told);
    free(who);
}
