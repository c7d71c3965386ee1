/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/markup/plain.h"
#include "server/base/mem.h"
#include "server/base/utf8.h"
#include "server/markup/language_runs.h"
#include "server/markup/speaker_runs.h"
#include <stdlib.h>
#include <string.h>
#include <strings.h>

struct cursor {
    const char *text;
    size_t size, at;
};

/* Returns the character at the cursor (0 at the end) and its length. The text is well-formed UTF-8. */
static uint32_t look(const struct cursor *c, size_t *length) {
    uint32_t cp = 0;
    *length = c->at < c->size ? utf8_next(c->text + c->at, c->size - c->at, &cp) : 0;
    return cp;
}

static bool is_space(uint32_t c) {
    return c == ' ' || (c >= '\t' && c <= '\r') || c == 0xA0 || (c >= 0x2000 && c <= 0x200B) || c == 0x2028 ||
           c == 0x2029 || c == 0x3000 || c == 0xFEFF /* byte order mark */;
}

/* Unicode's Sentence_Terminal (UAX 29), limited to scripts with voices here. */
static bool is_terminator(uint32_t c) {
    if (c < 0x80)
        return c == '.' || c == '?' || c == '!';
    switch (c) {
    case 0x0589: /* Armenian */
    case 0x061F: /* Arabic question mark */
    case 0x06D4: /* Urdu */
    case 0x0964: /* Devanagari danda */
    case 0x0965:
    case 0x104B: /* Burmese */
    case 0x1362: /* Ethiopic full stop and question mark */
    case 0x1367:
    case 0x2026: /* … */
    case 0x203C: /* ‼ ⁇ ⁈ ⁉ */
    case 0x2047:
    case 0x2048:
    case 0x2049:
    case 0x3002: /* ideographic full stop */
    case 0xFF01:
    case 0xFF1F:
    case 0xFF61:
        return true;
    default:
        return false;
    }
}

static bool is_markdown(const struct markup_rules *rules) {
    return rules && rules->markdown;
}

static bool is_closing(uint32_t c, const struct markup_rules *rules) {
    if (is_markdown(rules) && (c == '*' || c == '_' || c == '`' || c == '~' || c == MARKDOWN_LEFT_OUT))
        return true;
    return c == '"' || c == '\'' || c == ')' || c == ']' || c == 0xBB || c == 0x2019 || c == 0x201D ||
           c == 0x203A || c == 0x300D /* 」 */ || c == 0x300F || c == 0xFF09;
}

/* Lower-case Latin letters of the languages with voices here. */
static bool is_lower(uint32_t c) {
    if (c < 0x100)
        return (c >= 'a' && c <= 'z') || (c >= 0xDF && c != 0xF7);
    if (c >= 0x139 && c <= 0x148)
        return c % 2 == 0;
    return c <= 0x177 && c % 2 == 1;
}

/* True if the word is one of the abbreviations with one of these signs before them (markup_rules). */
static bool listed_with(const struct markup_rules *rules, const char *signs, const char *word,
                        size_t length) {
    for (const char *const *a = rules ? rules->abbreviations : NULL; a && *a; a++)
        if (**a && strchr(signs, **a) && strlen(*a + 1) == length && !strncasecmp(*a + 1, word, length))
            return true;
    return false;
}

static bool listed(const struct markup_rules *rules, const char *word, size_t length) {
    for (const char *const *a = rules ? rules->abbreviations : NULL; a && *a; a++)
        if (strlen(*a) == length && !strncasecmp(*a, word, length))
            return true;
    return false;
}

/* True if it consists of at most three digits, or is a Roman number in capitals. */
static bool is_ordinal(const char *word, size_t length) {
    size_t digits = strspn(word, "0123456789"), roman = strspn(word, "IVXLC");
    return (digits == length && length <= 3) || (roman == length && length <= 7);
}

/* True if the word has no vowel, so that it cannot be pronounced. */
static bool has_no_vowel(const char *word, size_t length) {
    for (size_t i = 0; i < length; i++)
        if ((unsigned char)word[i] >= 0x80 || strchr("aeiouyAEIOUY0123456789", word[i]))
            return false;
    return true;
}

/* True if the word that ends before `end` is an abbreviation (an initial, "prof"). lower: a small letter
 * follows. */
static bool is_abbreviation(const char *text, size_t end, const struct markup_rules *rules, bool lower) {
    const char *before = is_markdown(rules) ? " \t\r\n(\"'*_[\1" : " \t\r\n(\"'";
    size_t from = end;
    while (from > 0 && !strchr(before, text[from - 1]))
        from--;
    size_t length = end - from, letter, amount = strspn(text + from, "0123456789");
    uint32_t cp;
    if (!length)
        return false;
    amount += amount && text[from + amount] == '-';
    if (amount && amount + 1 < length) { /* a unit: "12-oz. can" */
        from += amount;
        length -= amount;
    }
    letter = utf8_next(text + from, length, &cp);
    if (letter == length)
        return !(cp >= '0' && cp <= '9') || lower || listed(rules, "#", 1);
    if (listed(rules, "#", 1) && is_ordinal(text + from, length))
        return true;
    if (listed(rules, text + from, length))
        return true;
    return lower &&
           (memchr(text + from, '.', length) || has_no_vowel(text + from, length) ||
            strspn(text + from, "0123456789") == length || listed_with(rules, "?^", text + from, length));
}

/* True if the word that ends before `end` is an abbreviation before a number ("no. 5"). */
static bool stands_for_number(const char *text, size_t end, const struct markup_rules *rules) {
    size_t from = end;
    while (from > 0 && !strchr(" \t\r\n(-", text[from - 1]))
        from--;
    return listed_with(rules, "+", text + from, end - from);
}

/* True if the sentence goes on behind the word that ends before `end` where an initial or two capitals follow
 * ("ed. J. Smith", "Ave. NW"). */
static bool stands_before_initial(const char *text, size_t end, const struct markup_rules *rules) {
    size_t from = end;
    while (from > 0 && !strchr(" \t\r\n([", text[from - 1]))
        from--;
    return listed_with(rules, "^", text + from, end - from);
}

/* True if the mark at `at` is an exclamation mark behind a digit: a sign of arithmetic makes it a factorial.
 */
static bool may_be_factorial(const char *text, size_t at) {
    return text[at] == '!' && at && text[at - 1] >= '0' && text[at - 1] <= '9';
}

static bool is_arithmetic(uint32_t c) {
    return c == '=' || c == '+' || c == '/' || c == '<' || c == '>' || c == 0xD7 || c == 0xF7;
}

/* True if only a number precedes `end` in its line, as in a numbered list. */
static bool is_item_number(const char *text, size_t end) {
    size_t from = end;
    while (from > 0 && text[from - 1] >= '0' && text[from - 1] <= '9')
        from--;
    bool number = from < end && end - from <= 3;
    while (from > 0 && strchr(" \t*\1", text[from - 1]))
        from--;
    return number && (!from || text[from - 1] == '\n');
}

/* At a terminator: end of the sentence, including closing marks; 0 if it does not end here. */
static size_t sentence_end(struct cursor c, const struct markup_rules *rules) {
    bool more = rules && rules->more;
    size_t start = c.at, length, marks = 0;
    bool only_dots = true;
    for (uint32_t cp; marks < PLAIN_SENTENCE_BYTES && is_terminator(cp = look(&c, &length));
         c.at += length, marks++)
        only_dots = only_dots && (cp == '.' || cp == 0x2026);
    while (is_closing(look(&c, &length), rules))
        c.at += length;
    size_t end = c.at;
    if (end == c.size)
        return more ? PLAIN_UNKNOWN : end;
    uint32_t next = look(&c, &length);
    if (!is_space(next))
        return next >= 0x3000 ? end : 0; /* scripts without spaces */
    if (only_dots && marks == 1 &&
        (is_abbreviation(c.text, start, rules, false) ||
         (is_markdown(rules) && is_item_number(c.text, start))))
        return 0;
    while (is_space(next = look(&c, &length)))
        c.at += length;
    bool factorial = marks == 1 && may_be_factorial(c.text, start);
    if ((only_dots || factorial) && more && c.at == c.size)
        return PLAIN_UNKNOWN;
    if (factorial && is_arithmetic(next))
        return 0;
    if (only_dots && marks == 1 && next >= 'A' && next <= 'Z' &&
        stands_before_initial(c.text, start, rules)) {
        if (c.at + 1 == c.size && more)
            return PLAIN_UNKNOWN;
        if (c.at + 1 < c.size &&
            (c.text[c.at + 1] == '.' || (c.text[c.at + 1] >= 'A' && c.text[c.at + 1] <= 'Z')))
            return 0;
    }
    if (only_dots && marks == 1 && next >= '0' && next <= '9' && stands_for_number(c.text, start, rules))
        return 0;
    bool lower = only_dots && is_lower(next);
    return lower && (marks > 1 || c.text[start] != '.' || is_abbreviation(c.text, start, rules, true)) ? 0
                                                                                                       : end;
}

static size_t skip_space(struct cursor c, size_t *newlines) {
    size_t length;
    *newlines = 0;
    for (uint32_t cp; c.at < c.size && is_space(cp = look(&c, &length)); c.at += length)
        *newlines += cp == '\n';
    return c.at;
}

/* Tells whether a line at `at` starts a heading, list item or quotation. */
static enum { LINE_GOES_ON, LINE_BEGINS, LINE_UNKNOWN } line_at(const struct cursor *c, size_t at) {
    size_t i = at;
    while (i < c->size && i < at + 3 && c->text[i] >= '0' && c->text[i] <= '9')
        i++;
    bool number = i > at, one = i < c->size && strchr(number ? ".)" : "-*+", c->text[i]);
    if (i == c->size || (one && i + 1 == c->size))
        return LINE_UNKNOWN;
    if (!number && strchr("#>|", c->text[i]))
        return LINE_BEGINS;
    return one && strchr(" \t", c->text[i + 1]) ? LINE_BEGINS : LINE_GOES_ON;
}

/* True for a short line without a comma at its end, followed by one that begins with a capital or digit,
 * as in lists and addresses. */
enum { SHORT_LINE_BYTES = 32 };

static bool is_line_alone(const struct cursor *c, size_t line, size_t next) {
    size_t end = c->at;
    while (end > line && strchr(" \t\r", c->text[end - 1]))
        end--;
    if (next >= c->size || end == line || end - line > SHORT_LINE_BYTES || strchr(",;:-", c->text[end - 1]))
        return false;
    size_t length;
    struct cursor after = {c->text, c->size, next};
    uint32_t cp = look(&after, &length);
    return (cp >= 'A' && cp <= 'Z') || (cp >= '0' && cp <= '9') || (cp >= 0xC0 && cp <= 0xDE && cp != 0xD7) ||
           cp == 0x130 || cp == 0x15E || cp == 0x11E;
}

/* After the white space behind a line: end of the sentence, or 0. */
static size_t line_end(const struct cursor *c, size_t line, size_t next, size_t newlines,
                       const struct markup_rules *rules) {
    if (newlines > 1)
        return next;
    if (newlines && !(rules && rules->wrapped) && is_line_alone(c, line, next))
        return next;
    if (!newlines || !is_markdown(rules))
        return 0;
    if (c->text[line] == '#')
        return next;
    int begins = line_at(c, next);
    if (begins == LINE_UNKNOWN && rules->more)
        return PLAIN_UNKNOWN;
    return begins == LINE_BEGINS ? next : 0;
}

static bool is_letter(char c) {
    return (c | 32) >= 'a' && (c | 32) <= 'z';
}

/* Skips terminators that do not end a sentence, within its maximum length. */
static size_t skip_marks(struct cursor c, size_t next) {
    size_t length;
    for (c.at = next; is_terminator(look(&c, &length)) && c.at + length <= PLAIN_SENTENCE_BYTES;
         c.at += length)
        ;
    return c.at;
}

size_t plain_sentence(const char *text, size_t size, const struct markup_rules *rules) {
    struct cursor c = {text, size, 0};
    size_t comma = 0, space = 0, line = 0, length, newlines;
    size_t enough = rules && rules->sentence_bytes ? rules->sentence_bytes : PLAIN_SENTENCE_BYTES;
    while (c.at < size) {
        while (c.at < PLAIN_SENTENCE_BYTES && c.at + 1 < size && is_letter(text[c.at]))
            c.at++;
        uint32_t cp = look(&c, &length);
        size_t next = c.at + length, end = 0;
        if (is_terminator(cp)) {
            end = sentence_end(c, rules);
            if (end && end != PLAIN_UNKNOWN)
                end = skip_space((struct cursor){text, size, end}, &newlines);
            next = skip_marks(c, next);
        } else if (is_space(cp)) {
            next = skip_space(c, &newlines);
            end = line_end(&c, line, next, newlines, rules);
            line = newlines ? next : line;
            space = next;
            if (c.at && strchr(",;:", text[c.at - 1]))
                comma = next;
        }
        if (end)
            return end;
        if (rules && rules->more && next >= size) /* what follows may belong to this word */
            return PLAIN_UNKNOWN;
        length = next - c.at;
        c.at = next;
        if (c.at > enough && comma > enough / 4)
            return comma;
        if (c.at > PLAIN_SENTENCE_BYTES)
            return space ? space : c.at - length;
    }
    return rules && rules->more ? PLAIN_UNKNOWN : size;
}

bool plain_seems_ended(const char *text, size_t size, const struct markup_rules *rules) {
    struct cursor c = {text, size, 0};
    size_t length, start = 0, marks = 0;
    bool ended = false;
    for (uint32_t cp; c.at < size; c.at += length) {
        cp = look(&c, &length);
        if (is_terminator(cp)) {
            start = ended && marks ? start : c.at;
            marks = ended ? marks + 1 : 1;
            ended = true;
        } else if (!is_closing(cp, rules) && !is_space(cp)) {
            ended = false;
        }
    }
    if (!ended || marks > 1 || text[start] != '.')
        return ended;
    return start && !(text[start - 1] >= '0' && text[start - 1] <= '9') &&
           !is_abbreviation(text, start, rules, true);
}

static bool is_word(const char *text, size_t at, size_t end) {
    return at < end && (is_letter(text[at]) || (unsigned char)text[at] >= 0x80);
}

/* End of the word around `at`: languages apply to whole words. */
static size_t word_end(const char *text, size_t at, size_t end) {
    while (is_word(text, at, end) && at && is_word(text, at - 1, end))
        at++;
    return at;
}

/* Adds text[at..to). A replaced tag or reference (stray_tags_blank) becomes an item of its own, which covers
 * the bytes of its source, up to `end` with removed bytes after it. style: NULL = plain. */
static void add_text(struct score *score, const char *text, size_t at, size_t to, size_t end,
                     const struct score_style *style) {
    const char *input = score->input;
    while (at < to) {
        bool same = !input || text[at] == input[at];
        size_t from = at;
        while (at < to && same == (!input || text[at] == input[at]))
            at++;
        size_t place = at;
        while (!same && at == to && place < end && text[place] == MARKDOWN_LEFT_OUT)
            place++;
        struct score_item *item = score_add(score, SCORE_TEXT, from, place);
        item->text = score_strndup(score, text + from, at - from);
        item->verbatim = same;
        if (style)
            item->style = style;
    }
}

static size_t line_size(const char *text, size_t at, size_t to) {
    const char *end = memchr(text + at, '\n', to - at);
    return (end ? (size_t)(end - text) : to) - at;
}

/* Returns the end of the first line of text[at..to) that asks for a pause, lacks punctuation at its end and
 * is not the last; `to` if there is none. */
static size_t verse_end(const char *text, size_t at, size_t to, const struct markup_rules *rules) {
    for (const char *end; (end = memchr(text + at, '\n', to - at)); at = (size_t)(end - text) + 1) {
        size_t last = (size_t)(end - text), next = last;
        while (last > at && strchr(" \t\r", text[last - 1]))
            last--;
        while (next < to && strchr(" \t\r\n", text[next]))
            next++;
        bool dash = last >= 3 && !memcmp(text + last - 3, "\xE2\x80", 2) &&
                    ((uint8_t)text[last - 1] == 0x93 || (uint8_t)text[last - 1] == 0x94);
        if (last > at && next < to && !dash && !strchr(",;:.!?-", text[last - 1]) &&
            verse_asks_for_pause(text + at, last - at, text + next, line_size(text, next, to),
                                 rules->line_words))
            return next;
    }
    return to;
}

/* The pause of a comma, s. */
static const double comma_seconds = 0.15;

/* Adds text, with a pause at the end of each line if the rules ask for it. */
static void add_lines(struct score *score, const char *text, size_t at, size_t to, size_t end,
                      const struct markup_rules *rules, const struct score_style *style) {
    for (size_t next; rules && rules->verse_pauses && (next = verse_end(text, at, to, rules)) < to;
         at = next) {
        add_text(score, text, at, next, next, style);
        score_add(score, SCORE_BREAK, next, next)->seconds = comma_seconds;
    }
    add_text(score, text, at, to, end, style);
}

static struct score_style style_of(struct score *score, const struct speaker *who) {
    struct score_style style = score_plain_style;
    style.voice = who->voice ? score_strndup(score, who->voice, strlen(who->voice)) : NULL;
    style.gender = !who->voice && who->gender ? score_strndup(score, who->gender, strlen(who->gender)) : NULL;
    style.pitch = who->pitch;
    style.rate = who->rate;
    return style;
}

/* Adds text in one language, starting at `at`. *run: index of the next language run. Returns the end. */
static size_t add_run(struct score *score, const char *text, size_t at, size_t end,
                      const struct markup_rules *rules, size_t *run) {
    const struct language_runs *runs = rules ? rules->runs : NULL;
    while (runs && *run < runs->count && word_end(text, runs->list[*run].to, end) <= at)
        (*run)++;
    const struct language_run *next = runs && *run < runs->count ? &runs->list[*run] : NULL;
    size_t begin = next ? next->from : end, to = end;
    while (begin > at && begin < end && is_word(text, begin, end) && is_word(text, begin - 1, end))
        begin--;
    bool inside = next && begin <= at;
    if (inside && word_end(text, next->to, end) < end)
        to = word_end(text, next->to, end);
    else if (!inside && begin < end)
        to = begin;
    const bool foreign = inside && !(rules->lang && !strcmp(rules->lang, next->lang));
    const struct speaker *who = speaker_runs_at(rules ? rules->speakers : NULL, at, NULL);
    const struct score_style *own = NULL;
    if (foreign || who) {
        struct score_style style = who ? style_of(score, who) : score_plain_style;
        style.lang = foreign ? score_strndup(score, next->lang, strlen(next->lang)) : NULL;
        own = score_keep_style(score, &style);
    }
    add_lines(score, text, at, to, end, rules, own);
    return to;
}

/* Adds a sentence as items, which removed bytes separate. */
static void add_items(struct score *score, const char *text, size_t at, size_t end,
                      const struct markup_rules *rules, size_t *run) {
    bool markdown = is_markdown(rules);
    size_t whole = end;
    const char *edge = markdown ? " \t\r\n\1" : "";
    while (at < end && strchr(edge, text[at]))
        at++;
    while (end > at && strchr(edge, text[end - 1]))
        end--;
    while (!markdown && at < end)
        at = add_run(score, text, at, end, rules, run);
    while (at < end) {
        const char *out = markdown ? memchr(text + at, MARKDOWN_LEFT_OUT, end - at) : NULL;
        size_t to = out ? (size_t)(out - text) : end;
        if (to > at)
            add_lines(score, text, at, to, whole, rules, NULL);
        at = to + (out != NULL);
    }
    score_end_sentence(score);
}

/* A usual mood is milder than an outburst. */
#define MOOD_INTENSITY 0.6

/* Adds a sentence with its speaker's mood. */
static void add_sentence(struct score *score, const char *text, size_t at, size_t end,
                         const struct markup_rules *rules, size_t *run) {
    const struct speaker *who = speaker_runs_at(rules ? rules->speakers : NULL, at, NULL);
    const bool mood = who && who->affect;
    const size_t cue = score->cue_count;
    if (mood)
        score_add_cue(score, "affect", who->affect, at)->intensity = MOOD_INTENSITY;
    add_items(score, text, at, end, rules, run);
    if (mood)
        score->cues[cue].last = score->item_count;
}

static int read_all(struct score *score, const char *text, size_t size, const struct markup_rules *rules,
                    struct error *e) {
    size_t newlines, at = skip_space((struct cursor){text, size, 0}, &newlines), run = 0;
    while (at < size) {
        if (markup_given_up(rules)) {
            enum error_code code;
            const char *why = markup_why_given_up(rules, &code);
            return error_at_byte(e, code, at, "%s", why);
        }
        size_t length = plain_sentence(text + at, size - at, rules), edge = size;
        if (rules)
            speaker_runs_at(rules->speakers, at, &edge);
        length = edge > at && edge - at < length ? edge - at : length; /* a sentence has one speaker */
        size_t end = at + length;
        while (end > at && strchr(" \t\r\n\v\f", text[end - 1]))
            end--;
        add_sentence(score, text, at, end, rules, &run);
        at += length;
        while (at < size && strchr(" \t\r\n\v\f", text[at]))
            at++;
    }
    return 0;
}

int plain_read(struct score *score, const char *text, size_t size, const struct markup_rules *rules,
               struct error *e) {
    if (!rules || !rules->markdown_out || rules->markdown)
        return read_all(score, text, size, rules, e);
    struct markup_rules marked = *rules;
    if (!markdown_is_needed(text, size))
        return read_all(score, text, size, rules, e);
    char *copy = mem_strndup(text, size);
    markdown_blank(copy, size, true, rules);
    /* in a text of nothing but symbols and emoji, leave them to the voice */
    marked.markdown = markdown_has_words(copy, size);
    int failed = read_all(score, marked.markdown ? copy : text, size, &marked, e);
    free(copy);
    return failed;
}
