/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Cuts a text into the words that spellings of a lexicon are made of. */
#include "server/base/mem.h"
#include "server/base/utf8.h"
#include "server/normalize/lexicon_internal.h"
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <unicode/uchar.h>
#include <unicode/unorm2.h>
#include <unicode/uscript.h>
#include <unicode/ustring.h>

enum { WORD_BYTES = 512, WORD_UNITS = 1024 }; /* longer words are in no lexicon */

static bool is_mark(UChar32 c) {
    return U_GET_GC_MASK(c) & U_GC_M_MASK;
}

static bool is_space(UChar32 c) {
    return u_isUWhiteSpace(c);
}

static bool in_word(UChar32 c) {
    return c < 0x80 ? (c >= '0' && c <= '9') || ((c | 32) >= 'a' && (c | 32) <= 'z')
                    : u_isalnum(c) || is_mark(c) || c == 0xAD /* soft hyphen */;
}

/* True for letters of scripts without spaces (Chinese, Thai): a word may begin at each of them. */
static bool stands_alone(UChar32 c) {
    UErrorCode status = U_ZERO_ERROR;
    return c >= 0xE00 && !is_mark(c) && uscript_breaksBetweenLetters(uscript_getScript(c, &status));
}

static bool is_apostrophe(UChar32 c) {
    return c == '\'' || c == 0x2019 || c == 0x2BC;
}

static bool is_turkic(const char *lang) {
    return (!strncasecmp(lang, "tr", 2) || !strncasecmp(lang, "az", 2)) && (!lang[2] || lang[2] == '-');
}

static size_t add_key(struct tokens *tokens, const UChar *key, int32_t units) {
    size_t offset = tokens->keys.size;
    char utf8[3 * WORD_UNITS + 1];
    UErrorCode status = U_ZERO_ERROR;
    int32_t bytes = 0;
    u_strToUTF8WithSub(utf8, (int32_t)sizeof utf8 - 1, &bytes, key, units, 0xFFFD, NULL, &status);
    utf8[U_FAILURE(status) ? 0 : bytes] = '\0';
    buf_add(&tokens->keys, utf8, strlen(utf8) + 1);
    return offset;
}

static size_t add_ascii(struct tokens *tokens, const char *word, size_t size, bool lower) {
    size_t offset = tokens->keys.size;
    char *key = buf_reserve(&tokens->keys, size + 1);
    for (size_t i = 0; i < size; i++)
        key[i] = lower && word[i] >= 'A' && word[i] <= 'Z' ? (char)(word[i] | 32) : word[i];
    key[size] = '\0';
    tokens->keys.size += size + 1;
    return offset;
}

/* Keys of a word with other letters than those of ASCII, or in a language with other rules for these. */
static void add_unicode(struct tokens *tokens, struct token *token, const char *word, size_t size,
                        bool turkic) {
    UChar raw[WORD_UNITS], nfc[WORD_UNITS], other[WORD_UNITS];
    UErrorCode status = U_ZERO_ERROR;
    int32_t units = 0, kept = 0;
    u_strFromUTF8(raw, WORD_UNITS, &units, word, (int32_t)size, &status);
    for (int32_t i = 0; i < units && U_SUCCESS(status); i++)
        if (raw[i] != 0xAD)
            raw[kept++] = raw[i];
    units = unorm2_normalize(unorm2_getNFCInstance(&status), raw, kept, nfc, WORD_UNITS, &status);
    if (U_FAILURE(status)) {
        token->exact = token->folded = token->opening = add_key(tokens, NULL, 0);
        return;
    }
    token->exact = token->opening = add_key(tokens, nfc, units);
    int32_t folded = u_strFoldCase(other, WORD_UNITS, nfc, units,
                                   turkic ? U_FOLD_CASE_EXCLUDE_SPECIAL_I : U_FOLD_CASE_DEFAULT, &status);
    token->folded = U_FAILURE(status) ? token->exact : add_key(tokens, other, folded);
    int32_t first = 0;
    UChar32 c;
    status = U_ZERO_ERROR;
    U16_NEXT(nfc, first, units, c);
    if (!u_isupper(c) && !u_istitle(c))
        return;
    int32_t lower = u_strToLower(other, WORD_UNITS, nfc, first, turkic ? "tr" : "", &status);
    if (U_FAILURE(status) || lower + units - first > WORD_UNITS)
        return;
    u_memcpy(other + lower, nfc + first, units - first);
    token->opening = add_key(tokens, other, lower + units - first);
}

static void add_word(struct tokens *tokens, struct token *token, const char *text, bool ascii, bool turkic) {
    const char *word = text + token->from;
    size_t size = token->to - token->from;
    if (size > WORD_BYTES) {
        token->exact = token->folded = token->opening = add_ascii(tokens, "", 0, false);
    } else if (!ascii || (turkic && (memchr(word, 'I', size) || memchr(word, 'i', size)))) {
        add_unicode(tokens, token, word, size, turkic);
    } else {
        token->exact = token->opening = add_ascii(tokens, word, size, false);
        token->folded = add_ascii(tokens, word, size, true);
        if (*word >= 'A' && *word <= 'Z') {
            token->opening = add_ascii(tokens, word, size, false);
            tokens->keys.data[token->opening] |= 32;
        }
    }
}

static enum token_kind kind_of(UChar32 c) {
    return is_space(c)        ? TOKEN_SPACE
           : is_apostrophe(c) ? TOKEN_APOSTROPHE
           : in_word(c)       ? TOKEN_WORD
                              : TOKEN_SIGN;
}

void tokens_read(struct tokens *tokens, const char *text, size_t size, const char *lang) {
    bool turkic = is_turkic(lang);
    for (size_t at = 0; at < size;) {
        uint32_t c;
        size_t length = utf8_next(text + at, size - at, &c);
        length += !length; /* malformed */
        struct token token = {.kind = kind_of((UChar32)c), .from = at, .to = at + length};
        bool ascii = c < 0x80, alone = stands_alone((UChar32)c);
        while (token.to < size && (token.kind == TOKEN_SPACE || token.kind == TOKEN_WORD)) {
            length = utf8_next(text + token.to, size - token.to, &c);
            if (!length || kind_of((UChar32)c) != token.kind ||
                (token.kind == TOKEN_WORD && (alone ? !is_mark((UChar32)c) : stands_alone((UChar32)c))))
                break;
            ascii &= c < 0x80;
            token.to += length;
        }
        if (token.kind == TOKEN_WORD)
            add_word(tokens, &token, text, ascii, turkic);
        else if (token.kind == TOKEN_SIGN)
            token.exact = token.folded = token.opening =
                add_ascii(tokens, text + token.from, token.to - token.from, false);
        else
            token.exact = token.folded = token.opening =
                add_ascii(tokens, token.kind == TOKEN_SPACE ? " " : "'", 1, false);
        tokens->list = mem_grow(tokens->list, &tokens->cap, tokens->count + 1, sizeof *tokens->list);
        tokens->list[tokens->count++] = token;
        at = token.to;
    }
}

void tokens_free(struct tokens *tokens) {
    free(tokens->list);
    buf_free(&tokens->keys);
}

const char *token_key(const struct tokens *tokens, size_t offset) {
    return (const char *)tokens->keys.data + offset;
}
