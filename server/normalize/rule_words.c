/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Fills the template of a matched rule. A template is text with {GROUP|FUNCTION:ARGUMENT|...}: the match
 * of a named group passes through the functions in turn. A function that is unknown here is the name of a
 * table. models/normalization/text/README.md lists the functions. */
#include "server/base/mem.h"
#include "server/normalize/text_rules_internal.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unicode/ustring.h>

enum { NAME_BYTES = 64, PLAIN_DECIMALS = 3 /* most decimals read as one number */ };

static char *copy_group(const struct text_rule *rule, int32_t group) {
    UErrorCode e = U_ZERO_ERROR;
    UChar units[RULE_WINDOW + 1];
    int32_t bytes = 0, size = uregex_group(rule->match, group, units, RULE_WINDOW + 1, &e);
    size = U_SUCCESS(e) ? size : 0;
    char *text = mem_alloc((size_t)size * 3 + 1);
    e = U_ZERO_ERROR;
    u_strToUTF8(text, size * 3 + 1, &bytes, units, size, &e);
    return text;
}

static void copy_groups(struct filling *f) {
    UErrorCode e = U_ZERO_ERROR;
    int32_t count = uregex_groupCount(f->rule->match, &e);
    for (int32_t i = 0; i <= count && i < RULE_GROUPS; i++)
        f->groups[i] = copy_group(f->rule, i);
}

/* Copy of what a group matched; "" if it took no part in the match or does not exist. */
static char *group_text(const struct filling *f, const char *name) {
    UErrorCode e = U_ZERO_ERROR;
    int32_t group = *name ? uregex_groupNumberFromCName(f->rule->match, name, -1, &e) : 0;
    const char *text = U_SUCCESS(e) && group < RULE_GROUPS ? f->groups[group] : NULL;
    return mem_strdup(text ? text : "");
}

static const char *number_string(const struct text_rules *r, const char *name) {
    const char *value = json_string_value(json_object_get(json_object_get(r->root, "number"), name));
    return value ? value : "";
}

/* A number as written. */
struct figure {
    bool minus, plus;
    char whole[RULE_WINDOW + 1], decimals[RULE_WINDOW + 1];
};

static bool starts(const char *s, const char *prefix) {
    return !strncmp(s, prefix, strlen(prefix));
}

static void read_figure(const char *text, char decimal, struct figure *out) {
    size_t whole = 0, decimals = 0, length = strlen(text);
    bool after = false;
    const char other = decimal == ',' ? '.' : ',';
    /* two digits after the other language's decimal sign are decimals, too: "$49.95" */
    if (decimal && length > 3 && text[length - 3] == other && !strchr(text, decimal))
        decimal = other;
    *out = (struct figure){.minus = *text == '-' || starts(text, "\u2212") || starts(text, "\u2013"),
                           .plus = *text == '+'};
    for (const char *s = text; *s; s++) {
        if (*s == decimal)
            after = true;
        else if (*s >= '0' && *s <= '9' && after && decimals < RULE_WINDOW)
            out->decimals[decimals++] = *s;
        else if (*s >= '0' && *s <= '9' && whole < RULE_WINDOW)
            out->whole[whole++] = *s;
    }
}

static const char *skip_zeros(const char *digits) {
    while (digits[0] == '0' && digits[1])
        digits++;
    return digits;
}

static void add_whole(const struct text_rules *r, const char *form, const char *digits, struct buf *out) {
    if (!spellout_whole(r->spellout, form, digits, out) &&
        !spellout_whole(r->spellout, "cardinal", digits, out))
        spellout_digits(r->spellout, digits, out);
}

/* Reads decimals in the language's way: one by one or as a number. */
static void add_decimals(const struct text_rules *r, const char *digits, struct buf *out) {
    bool one_by_one = !strcmp(number_string(r, "decimals"), "digits") || strlen(digits) > PLAIN_DECIMALS;
    size_t zeros = one_by_one ? strlen(digits) : strspn(digits, "0");
    char *first = mem_strndup(digits, zeros);
    spellout_digits(r->spellout, first, out);
    free(first);
    if (!digits[zeros])
        return;
    buf_add(out, " ", zeros > 0);
    add_whole(r, "cardinal", digits + zeros, out);
}

static void add_figure(const struct text_rules *r, const struct figure *f, const char *form,
                       struct buf *out) {
    if (f->minus || f->plus)
        buf_printf(out, "%s ", number_string(r, f->minus ? "minus" : "plus"));
    add_whole(r, *f->decimals ? "cardinal" : form, skip_zeros(*f->whole ? f->whole : "0"), out);
    if (!*f->decimals)
        return;
    buf_printf(out, " %s ", number_string(r, "point"));
    add_decimals(r, f->decimals, out);
}

static char decimal_of(const struct text_rules *r) {
    const char *decimal = json_string_value(json_object_get(r->root, "decimal"));
    return decimal ? *decimal : '.';
}

static bool is_one(const struct figure *f) {
    return !*f->decimals && !strcmp(skip_zeros(f->whole), "1");
}

/* Form of the number for the noun's gender, such as "cardinal" or "cardinal-f"; "one" or "one-f" for one. */
static const char *form_for(const json_t *noun, bool one, char form[16]) {
    const char *gender = json_string_value(json_array_get(noun, 2));
    snprintf(form, 16, "%s%s%s", one ? "one" : "cardinal", gender && *gender ? "-" : "",
             gender ? gender : "");
    return form;
}

/* Adds a number with what it counts; noun: [ONE, MANY, GENDER]. "#" in the noun is replaced by the number;
 * a noun that begins with "=" includes the number already. */
static void add_counted(const struct text_rules *r, const struct figure *f, const json_t *noun,
                        struct buf *out) {
    bool one = is_one(f);
    const char *name = json_string_value(json_array_get(noun, !one));
    char form[16];
    struct buf number = {0};
    form_for(noun, one, form);
    const char *word = one ? number_string(r, form) : "";
    if (one && *word && (f->minus || f->plus))
        buf_printf(&number, "%s ", number_string(r, f->minus ? "minus" : "plus"));
    if (one && *word)
        buf_printf(&number, "%s", word);
    else
        add_figure(r, f, one ? form_for(noun, false, form) : form, &number);
    size_t digits = strlen(f->whole);
    const char *of = number_string(r, "million-of");
    if (!*f->decimals && digits > 6 && !strcmp(f->whole + digits - 6, "000000") && *of)
        buf_printf(&number, " %s", of);
    buf_add(&number, "", 1);
    const char *place = name ? strchr(name, '#') : NULL;
    if (name && *name == '=')
        buf_printf(out, "%s%s%s", f->minus ? number_string(r, "minus") : "", f->minus ? " " : "", name + 1);
    else if (place)
        buf_printf(out, "%.*s%s%s", (int)(place - name), name, (char *)number.data, place + 1);
    else
        buf_printf(out, "%s %s", (char *)number.data, name ? name : "");
    buf_free(&number);
}

/* Splits NAME1,NAME2. */
static bool two_names(const char *argument, char first[NAME_BYTES], char second[NAME_BYTES]) {
    const char *comma = strchr(argument, ',');
    if (!comma || comma - argument >= NAME_BYTES || strlen(comma) > NAME_BYTES)
        return false;
    snprintf(first, NAME_BYTES, "%.*s", (int)(comma - argument), argument);
    snprintf(second, NAME_BYTES, "%s", comma + 1);
    return true;
}

static bool amount(const struct filling *f, const char *value, const char *argument, struct buf *out) {
    char group[NAME_BYTES], table[NAME_BYTES];
    struct figure figure;
    if (!two_names(argument, group, table))
        return false;
    char *key = group_text(f, group);
    const json_t *noun = rules_look_up(f->rules, table, *key ? key : group);
    free(key);
    if (!json_is_array(noun))
        return false;
    read_figure(value, decimal_of(f->rules), &figure);
    add_counted(f->rules, &figure, noun, out);
    return true;
}

/* Replaces {NAME} in a template; values: pairs of name and value, ended by NULL. */
static void fill_in(struct buf *out, const char *template, const char *const *values) {
    for (const char *s = template; *s;) {
        size_t length = *s == '{' ? strcspn(s, "}") : 0;
        const char *const *v = values;
        while (length && *v && (strlen(*v) != length - 1 || strncmp(*v, s + 1, length - 1) != 0))
            v += 2;
        if (length && *v) {
            buf_printf(out, "%s", v[1]);
            s += length + (s[length] == '}');
        } else {
            buf_add(out, s++, 1);
        }
    }
}

/* Reads a sum of money, with hundredths. */
static bool money(const struct filling *f, const char *value, const char *argument, struct buf *out) {
    const struct text_rules *r = f->rules;
    char *sign = group_text(f, argument);
    const json_t *currency = rules_look_up(r, "currencies", sign);
    struct figure figure;
    free(sign);
    read_figure(value, decimal_of(r), &figure);
    size_t length = strlen(figure.decimals);
    const json_t *noun = json_array_get(currency, 0), *small = json_array_get(currency, 1);
    if (!noun)
        return false;
    bool minus = figure.minus, nothing = !*skip_zeros(figure.whole) || !strcmp(skip_zeros(figure.whole), "0");
    bool zeros = strspn(figure.decimals, "0") == length;
    if (zeros)
        *figure.decimals = '\0';
    if (zeros || length > 2 || !json_is_array(small)) {
        add_counted(r, &figure, noun, out);
        return true;
    }
    struct figure hundredths = {0}, whole = figure;
    snprintf(hundredths.whole, sizeof hundredths.whole, "%.2s%s", figure.decimals, length == 1 ? "0" : "");
    *whole.decimals = '\0';
    whole.minus = false;
    struct buf large = {0}, rest = {0}, bare = {0};
    add_counted(r, &whole, noun, &large);
    add_counted(r, &hundredths, small, &rest);
    add_whole(r, "cardinal", skip_zeros(hundredths.whole), &bare);
    buf_add(&large, "", 1);
    buf_add(&rest, "", 1);
    buf_add(&bare, "", 1);
    const char *const values[] = {"large", (char *)large.data, "small", (char *)rest.data,
                                  "bare",  (char *)bare.data,  NULL};
    if (minus)
        buf_printf(out, "%s ", number_string(r, "minus"));
    const char *template = number_string(r, *hundredths.whole == '0' ? "money-few" : "money");
    fill_in(out, nothing ? "{small}" : template, values);
    buf_free(&large);
    buf_free(&rest);
    buf_free(&bare);
    return true;
}

/* Reads the name of each letter; a letter without a name stays. */
static void add_letters(const struct text_rules *r, const char *text, struct buf *out) {
    bool first = true;
    for (size_t at = 0, length, size = strlen(text); at < size; at += length) {
        length = 1;
        while (at + length < size && ((unsigned char)text[at + length] & 0xC0) == 0x80)
            length++;
        char *letter = mem_strndup(text + at, length);
        const char *name = json_string_value(rules_look_up(r, "letters", letter));
        if (*letter >= '0' && *letter <= '9') {
            buf_printf(out, "%s", first ? "" : " ");
            spellout_digits(r->spellout, letter, out);
            first = false;
        } else if (!strchr(" .-'", *letter)) {
            buf_printf(out, "%s%s", first ? "" : " ", name ? name : letter);
            first = false;
        }
        free(letter);
    }
}

/* Reads an Internet address: signs by their names, numbers of up to four digits as numbers, other numbers
 * digit by digit, short words without vowels letter by letter, and other words as they are. */
static void add_address(const struct text_rules *r, const char *text, struct buf *out) {
    size_t before = out->size;
    for (const char *s = text; *s;) {
        char sign[2] = {*s, '\0'};
        const char *name = json_string_value(rules_look_up(r, "net", sign));
        size_t length = name ? 1 : strspn(s, "0123456789");
        buf_add(out, " ", out->size > before && s > text);
        if (name) {
            buf_printf(out, "%s", name);
        } else if (length) {
            char *digits = mem_strndup(s, length);
            if (length <= 4 && *digits != '0')
                add_whole(r, "cardinal", digits, out);
            else
                spellout_digits(r->spellout, digits, out);
            free(digits);
        } else {
            while (s[length] && !strchr("0123456789", s[length])) {
                const char next[2] = {s[length], '\0'};
                if (json_object_get(json_object_get(r->tables, "net"), next))
                    break;
                length++;
            }
            char *word = mem_strndup(s, length), *lower = rules_lower(r, word);
            const char *said = json_string_value(rules_look_up(r, "networds", lower));
            if (said)
                buf_printf(out, "%s", said);
            else if (!strpbrk(lower, "aeiouy") && length <= 4 && (unsigned char)*lower < 0x80)
                add_letters(r, lower, out);
            else
                buf_printf(out, "%s", word);
            free(word);
            free(lower);
        }
        s += length;
    }
}

/* Converts a Roman numeral, 1 to 3999, to digits. */
static bool roman(const char *text, struct buf *out) {
    static const struct {
        const char *digits;
        unsigned value;
    } steps[] = {{"M", 1000}, {"CM", 900}, {"D", 500}, {"CD", 400}, {"C", 100}, {"XC", 90}, {"L", 50},
                 {"XL", 40},  {"X", 10},   {"IX", 9},  {"V", 5},    {"IV", 4},  {"I", 1}};
    char upper[24];
    unsigned value = 0;
    if (strlen(text) >= sizeof upper)
        return false;
    for (size_t i = 0; i <= strlen(text); i++)
        upper[i] = (char)(text[i] >= 'a' && text[i] <= 'z' ? text[i] - 'a' + 'A' : text[i]);
    const char *s = upper;
    for (size_t i = 0; i < sizeof steps / sizeof *steps; i++) {
        size_t length = strlen(steps[i].digits);
        int most = length == 1 && strchr("MCXI", *steps[i].digits) ? 4 : 1;
        for (; most && !strncmp(s, steps[i].digits, length); most--, s += length)
            value += steps[i].value;
    }
    if (*s || !value)
        return false;
    buf_printf(out, "%u", value);
    return true;
}

/* Replaces the last word by its form in a table ("sekiz" -> "sekizden"). */
static bool last_word(const struct text_rules *r, const char *words, const char *table, struct buf *out) {
    const char *space = strrchr(words, ' '), *last = space ? space + 1 : words;
    const char *form = json_string_value(rules_look_up(r, table, last));
    if (!form)
        return false;
    buf_printf(out, "%.*s%s", (int)(last - words), words, form);
    return true;
}

/* Reads digits in groups of at most `most`, with a short pause between groups. */
static void add_groups(const struct text_rules *r, const char *text, size_t most, struct buf *out) {
    size_t run = 0, before = out->size;
    bool parted = false;
    for (const char *s = text; *s; s++) {
        const char digit[2] = {*s, '\0'};
        if (*s < '0' || *s > '9') {
            parted = run > 0;
            continue;
        }
        if (out->size > before)
            buf_printf(out, "%s", parted || run == most ? ", " : " ");
        run = parted || run == most ? 1 : run + 1;
        parted = false;
        spellout_digits(r->spellout, digit, out);
    }
}

static bool say_again(const struct filling *f, const char *value, struct buf *out) {
    struct said said;
    if (f->depth >= RULE_DEPTH || !f->again(f->rules, value, strlen(value), f->depth + 1, &said)) {
        buf_printf(out, "%s", value);
        return true;
    }
    buf_add(out, said.words.data, said.words.size);
    said_free(&said);
    return true;
}

static bool in_table(const struct text_rules *r, const char *table, const char *argument, const char *value,
                     struct buf *out) {
    const json_t *found = rules_look_up(r, table, value);
    if (json_is_array(found) && json_is_array(json_array_get(found, 0)))
        found = json_array_get(found, 0); /* of a currency: its name, not its hundredths */
    if (json_is_array(found))
        found = json_array_get(found, !strcmp(argument, "many"));
    if (!json_is_string(found))
        return false;
    buf_printf(out, "%s", json_string_value(found));
    return true;
}

static bool apply(const struct filling *f, const char *function, const char *argument, const char *value,
                  struct buf *out) {
    const struct text_rules *r = f->rules;
    struct figure figure;
    if (!strcmp(function, "number")) {
        if (!*value)
            return true;
        read_figure(value, *argument == '.' || *argument == ',' ? *argument : decimal_of(r), &figure);
        add_figure(r, &figure, *argument && !strchr(".,", *argument) ? argument : "cardinal", out);
        return true;
    }
    if (!strcmp(function, "spell")) {
        read_figure(value, '\0', &figure);
        return !*value || (*figure.whole && spellout_whole(r->spellout, argument, figure.whole, out));
    }
    if (!strcmp(function, "decimals")) {
        add_decimals(r, value, out);
        return true;
    }
    if (!strcmp(function, "digits")) {
        spellout_digits(r->spellout, value, out);
        return true;
    }
    if (!strcmp(function, "groups")) {
        add_groups(r, value, (size_t)atoi(argument), out);
        return true;
    }
    if (!strcmp(function, "amount"))
        return amount(f, value, argument, out);
    if (!strcmp(function, "money"))
        return money(f, value, argument, out);
    if (!strcmp(function, "letters")) {
        add_letters(r, value, out);
        return true;
    }
    if (!strcmp(function, "address")) {
        add_address(r, value, out);
        return true;
    }
    if (!strcmp(function, "roman"))
        return roman(value, out);
    if (!strcmp(function, "last"))
        return last_word(r, value, argument, out);
    if (!strcmp(function, "say"))
        return say_again(f, value, out);
    if (!strcmp(function, "lower")) {
        char *lower = rules_lower(r, value);
        buf_printf(out, "%s", lower);
        free(lower);
        return true;
    }
    if (!strcmp(function, "or")) { /* default for an empty value */
        buf_printf(out, "%s", *value ? value : argument);
        return true;
    }
    return in_table(r, function, argument, value, out);
}

/* Fills one {...} of a template, which ends before `end`. */
static bool fill_place(const struct filling *f, const char *place, const char *end, struct buf *out) {
    char *all = mem_strndup(place, (size_t)(end - place)), *rest = all;
    char *value = group_text(f, strsep(&rest, "|"));
    bool fits = true;
    while (rest && fits) {
        char *function = strsep(&rest, "|"), *argument = strchr(function, ':');
        struct buf next = {0};
        if (argument)
            *argument++ = '\0';
        fits = apply(f, function, argument ? argument : "", value, &next);
        buf_add(&next, "", 1);
        free(value);
        value = (char *)next.data;
    }
    if (fits)
        buf_printf(out, "%s", value);
    free(value);
    free(all);
    return fits;
}

bool rule_words(struct filling *f, struct buf *out) {
    size_t before = out->size;
    bool fits = true;
    copy_groups(f);
    for (const char *s = f->rule->say; *s && fits; s++) {
        const char *end = *s == '{' ? strchr(s, '}') : NULL;
        if (!end) {
            buf_add(out, s, 1);
        } else {
            fits = fill_place(f, s + 1, end, out);
            s = end;
        }
    }
    out->size = fits ? out->size : before;
    for (size_t i = 0; i < RULE_GROUPS; i++)
        free(f->groups[i]);
    return fits;
}
