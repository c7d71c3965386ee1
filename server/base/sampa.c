/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/sampa.h"
#include "server/base/utf8.h"
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

struct symbol {
    uint32_t ipa;
    const char *sampa;
};

/* Sorted by code point. */
static const struct symbol symbols[] = {
    {' ', " "},        {'.', "."},       {'a', "a"},       {'b', "b"},         {'c', "c"},
    {'d', "d"},        {'e', "e"},       {'f', "f"},       {'g', "g"},         {'h', "h"},
    {'i', "i"},        {'j', "j"},       {'k', "k"},       {'l', "l"},         {'m', "m"},
    {'n', "n"},        {'o', "o"},       {'p', "p"},       {'q', "q"},         {'r', "r"},
    {'s', "s"},        {'t', "t"},       {'u', "u"},       {'v', "v"},         {'w', "w"},
    {'x', "x"},        {'y', "y"},       {'z', "z"},       {'|', "|"},         {0x00E3, "a~"},
    {0x00E4, "a_\""},  {0x00E6, "{"},    {0x00E7, "C"},    {0x00F0, "D"},      {0x00F1, "n~"},
    {0x00F5, "o~"},    {0x00F8, "2"},    {0x0127, "X\\"},  {0x0129, "i~"},     {0x014B, "N"},
    {0x0153, "9"},     {0x0169, "u~"},   {0x01C0, "|\\"},  {0x01C1, "|\\|\\"}, {0x01C2, "=\\"},
    {0x01C3, "!\\"},   {0x0250, "6"},    {0x0251, "A"},    {0x0252, "Q"},      {0x0253, "b_<"},
    {0x0254, "O"},     {0x0255, "s\\"},  {0x0256, "d`"},   {0x0257, "d_<"},    {0x0258, "@\\"},
    {0x0259, "@"},     {0x025A, "@`"},   {0x025B, "E"},    {0x025C, "3"},      {0x025D, "3`"},
    {0x025E, "3\\"},   {0x025F, "J\\"},  {0x0260, "g_<"},  {0x0261, "g"},      {0x0262, "G\\"},
    {0x0263, "G"},     {0x0264, "7"},    {0x0265, "H"},    {0x0266, "h\\"},    {0x0267, "x\\"},
    {0x0268, "1"},     {0x026A, "I"},    {0x026B, "5"},    {0x026C, "K"},      {0x026D, "l`"},
    {0x026E, "K\\"},   {0x026F, "M"},    {0x0270, "M\\"},  {0x0271, "F"},      {0x0272, "J"},
    {0x0273, "n`"},    {0x0274, "N\\"},  {0x0275, "8"},    {0x0276, "&"},      {0x0278, "p\\"},
    {0x0279, "r\\"},   {0x027A, "l\\"},  {0x027B, "r\\`"}, {0x027D, "r`"},     {0x027E, "4"},
    {0x0280, "R\\"},   {0x0281, "R"},    {0x0282, "s`"},   {0x0283, "S"},      {0x0284, "J\\_<"},
    {0x0288, "t`"},    {0x0289, "}"},    {0x028A, "U"},    {0x028B, "P"},      {0x028C, "V"},
    {0x028D, "W"},     {0x028E, "L"},    {0x028F, "Y"},    {0x0290, "z`"},     {0x0291, "z\\"},
    {0x0292, "Z"},     {0x0294, "?"},    {0x0295, "?\\"},  {0x0298, "O\\"},    {0x0299, "B\\"},
    {0x029B, "G\\_<"}, {0x029C, "H\\"},  {0x029D, "j\\"},  {0x029F, "L\\"},    {0x02A1, ">\\"},
    {0x02A2, "<\\"},   {0x02A3, "dz"},   {0x02A4, "dZ"},   {0x02A5, "dz\\"},   {0x02A6, "ts"},
    {0x02A7, "tS"},    {0x02A8, "ts\\"}, {0x02B0, "_h"},   {0x02B1, "_h\\"},   {0x02B2, "'"},
    {0x02B7, "_w"},    {0x02BC, "_>"},   {0x02C8, "\""},   {0x02CC, "%"},      {0x02D0, ":"},
    {0x02D1, ":\\"},   {0x02DE, "`"},    {0x02E0, "_G"},   {0x02E1, "_l"},     {0x02E4, "_?\\"},
    {0x02E5, "_T"},    {0x02E6, "_H"},   {0x02E7, "_M"},   {0x02E8, "_L"},     {0x02E9, "_B"},
    {0x0300, "_L"},    {0x0301, "_H"},   {0x0302, "_F"},   {0x0303, "~"},      {0x0304, "_M"},
    {0x0306, "_X"},    {0x0308, "_\""},  {0x030A, "_0"},   {0x030B, "_T"},     {0x030C, "_R"},
    {0x030D, "="},     {0x030F, "_B"},   {0x0318, "_A"},   {0x0319, "_q"},     {0x031A, "_}"},
    {0x031C, "_c"},    {0x031D, "_r"},   {0x031E, "_o"},   {0x031F, "_+"},     {0x0320, "_-"},
    {0x0324, "_t"},    {0x0325, "_0"},   {0x0329, "="},    {0x032A, "_d"},     {0x032C, "_v"},
    {0x032F, "_^"},    {0x0330, "_k"},   {0x0334, "_e"},   {0x0339, "_O"},     {0x033A, "_a"},
    {0x033B, "_m"},    {0x033C, "_N"},   {0x033D, "_x"},   {0x035C, ""},       {0x0361, ""},
    {0x03A6, "p\\"},   {0x03B2, "B"},    {0x03B5, "E"},    {0x03B8, "T"},      {0x03C7, "X"},
    {0x1D50, "_n"},    {0x1D51, "_n"},   {0x1D5D, "_w"},   {0x1D7B, "I\\"},    {0x1D7F, "U\\"},
    {0x1DC4, "_H_T"},  {0x1DC5, "_B_L"}, {0x1DC8, "_R_F"}, {0x1EBD, "e~"},     {0x1EF9, "y~"},
    {0x200D, ""},      {0x2016, "||"},   {0x203F, "-\\"},  {0x207F, "_n"},     {0x2191, "^"},
    {0x2193, "!"},     {0x2197, "<R>"},  {0x2198, "<F>"},  {0xA71B, "^"},      {0xA71C, "!"},
};

static int compare(const void *key, const void *element) {
    uint32_t a = *(const uint32_t *)key, b = ((const struct symbol *)element)->ipa;
    return (a > b) - (a < b);
}

size_t sampa_from_ipa(const char *ipa, char *out, size_t cap) {
    size_t size = strlen(ipa), at = 0, used = 0, unknown = 0;
    bool full = false;
    while (at < size && !full) {
        uint32_t cp;
        size_t length = utf8_next(ipa + at, size - at, &cp);
        const struct symbol *s = NULL;
        if (length)
            s = bsearch(&cp, symbols, sizeof symbols / sizeof *symbols, sizeof *symbols, compare);
        const char *text = s ? s->sampa : length ? ipa + at : "?";
        size_t bytes = s ? strlen(text) : length ? length : 1;
        unknown += !s;
        full = used + bytes >= cap;
        if (!full)
            memcpy(out + used, text, bytes);
        used += full ? 0 : bytes;
        at += length ? length : 1;
    }
    out[used] = '\0';
    if (!size && cap > 1)
        strcpy(out, "_");
    return unknown;
}

/* Code points whose X-SAMPA converts back to another one: ligatures, precomposed letters with a tilde,
 * diacritics that may stand above or below, and distinctions that X-SAMPA lacks. */
static bool is_second(uint32_t ipa) {
    static const uint32_t second[] = {0x00E3, 0x00F1, 0x00F5, 0x0129, 0x0169, 0x02A3, 0x02A4,
                                      0x02A5, 0x02A6, 0x02A7, 0x02A8, 0x030A, 0x030D, 0x03B5,
                                      0x1EBD, 0x1EF9, 0x00E4, 0x03A6, 0x1D50, 0x1D51, 0x1D5D};
    for (size_t i = 0; i < sizeof second / sizeof *second; i++)
        if (second[i] == ipa)
            return true;
    return false;
}

/* Returns the longest symbol at the start of the string, or NULL. */
static const struct symbol *longest(const char *sampa) {
    const struct symbol *best = NULL;
    for (size_t i = 0; i < sizeof symbols / sizeof *symbols; i++) {
        const struct symbol *s = &symbols[i];
        size_t length = strlen(s->sampa);
        if (length && (!best || length > strlen(best->sampa)) && !strncmp(sampa, s->sampa, length) &&
            !is_second(s->ipa))
            best = s;
    }
    return best;
}

size_t sampa_to_ipa(const char *sampa, char *out, size_t cap) {
    size_t used = 0, unknown = 0;
    while (*sampa) {
        const struct symbol *s = longest(sampa);
        char bytes[4];
        size_t length = s ? utf8_put(s->ipa, bytes) : 0;
        if (used + length >= cap)
            break;
        memcpy(out + used, bytes, length);
        used += length;
        unknown += !s && !strchr("_- ", *sampa) && ((unsigned char)*sampa & 0xC0) != 0x80;
        sampa += s ? strlen(s->sampa) : 1;
    }
    out[used] = '\0';
    return unknown;
}
