/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/lang.h"
#include <stddef.h>
#include <string.h>
#include <strings.h>

static bool is_letter(char c) {
    return (c | 32) >= 'a' && (c | 32) <= 'z';
}

bool lang_is_tag(const char *s, size_t n, size_t *bad) {
    enum { SUBTAG = 8 };
    size_t at = 0, from = 0;
    for (; at < n && at < LANG_BYTES; at++) {
        bool first = !from, single = at == from + 1 && ((s[from] | 32) == 'x' || (s[from] | 32) == 'i');
        if (s[at] == '-' && at > from && (!first || at > 1 || single) && at + 1 < n)
            from = at + 1;
        else if (!(is_letter(s[at]) || (!first && s[at] >= '0' && s[at] <= '9')) || at - from == SUBTAG)
            break;
    }
    *bad = at;
    return at == n && n > 1;
}

/* Codes of three letters (ISO 639-2, both sets) that have one of two letters, which a tag has to have. */
static void shorten(char *tag) {
    static const char codes[] =
        "eng en ita it por pt tur tr fra fr fre fr deu de ger de spa es lat la ell el gre el nld nl dut nl "
        "cat ca glg gl eus eu baq eu ron ro rum ro rus ru ukr uk pol pl ces cs cze cs slk sk slo sk slv sl "
        "hrv hr srp sr bos bs bul bg mkd mk mac mk sqi sq alb sq hun hu fin fi est et lav lv lit lt swe sv "
        "dan da nor no nob nb nno nn isl is ice is gle ga gla gd cym cy wel cy bre br cor kw mlt mt heb he "
        "ara ar fas fa per fa hin hi ben bn tam ta tel te urd ur kat ka geo ka hye hy arm hy aze az kaz kk "
        "jpn ja kor ko zho zh chi zh tha th vie vi ind id msa ms may ms epo eo afr af swa sw oci oc ";
    char code[5] = {0};
    if (strcspn(tag, "-") != 3)
        return;
    for (size_t i = 0; i < 3; i++)
        code[i] = (char)(tag[i] | 32);
    code[3] = ' ';
    for (const char *at = codes; *at; at += 7)
        if (!strncmp(at, code, 4)) {
            memcpy(tag, at + 4, 2);
            memmove(tag + 2, tag + 3, strlen(tag + 3) + 1);
            return;
        }
}

bool lang_read(const char *s, size_t n, char tag[LANG_BYTES + 1], size_t *bad) {
    static const char codeset[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-";
    size_t end = 0;
    while (end < n && s[end] != '.' && s[end] != '@')
        end++;
    for (size_t at = end; at < n; at++) /* the rest of a locale: codeset and modifier */
        if (!memchr(codeset, s[at], sizeof codeset - 1) &&
            !(at == end || (s[at] == '@' && s[end] == '.' && !memchr(s + end, '@', at - end)))) {
            *bad = at;
            return false;
        }
    *bad = end;
    if (end > LANG_BYTES || (end < n && end + 1 == n))
        return false;
    memcpy(tag, s, end);
    tag[end] = '\0';
    char *territory = memchr(tag, '_', end);
    if (territory && (territory - tag == 2 || territory - tag == 3) && end - (size_t)(territory - tag) == 3)
        *territory = '-';
    bool known = lang_is_tag(tag, end, bad);
    if (known) {
        for (size_t i = 0; i < end && tag[i] != '-'; i++)
            tag[i] |= 32;
        shorten(tag);
    }
    return known;
}

const char *lang_usual(const char *tag) {
    static const char *const tags[][2] = {{"zh-HK", "yue"}, {"zh-MO", "yue"}, {"zh", "cmn"}, {"no", "nb"},
                                          {"nn", "nb"},     {"sh", "hr"},     {"iw", "he"},  {"in", "id"}};
    for (size_t i = 0; i < sizeof tags / sizeof *tags; i++) {
        size_t length = strlen(tags[i][0]);
        if (!strncasecmp(tag, tags[i][0], length) && (!tag[length] || tag[length] == '-'))
            return tags[i][1];
    }
    return tag;
}

int lang_fit(const char *lang, const char *wanted) {
    wanted = lang_usual(wanted);
    lang = lang_usual(lang);
    size_t primary = strcspn(wanted, "-"), length = strlen(wanted);
    if (!strcasecmp(lang, wanted))
        return LANG_SAME;
    if (!strncasecmp(lang, wanted, length) && lang[length] == '-')
        return 2;
    return strcspn(lang, "-") == primary && !strncasecmp(lang, wanted, primary);
}
