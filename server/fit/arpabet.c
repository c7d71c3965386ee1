/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/fit/arpabet.h"
#include <ctype.h>
#include <string.h>

static const struct {
    const char *name, *ipa;
} names[] = {
    {"aa", "ɑː"},
    {"ae", "æ"},
    {"ah", "ʌ"},
    {"ao", "ɔː"},
    {"aw", "aʊ"},
    {"ax", "ə"},
    {"axr", "ɚ"},
    {"ay", "aɪ"},
    {"eh", "ɛ"},
    {"er", "ɜː"},
    {"ey", "eɪ"},
    {"ih", "ɪ"},
    {"ix", "ɪ"},
    {"iy", "iː"},
    {"ow", "oʊ"},
    {"oy", "ɔɪ"},
    {"uh", "ʊ"},
    {"uw", "uː"},
    {"ux", "uː"},
    {"ax-h", "ə"},
    {"b", "b"},
    {"ch", "tʃ"},
    {"d", "d"},
    {"dh", "ð"},
    {"dx", "ɾ"},
    {"el", "l"},
    {"em", "m"},
    {"en", "n"},
    {"eng", "ŋ"},
    {"f", "f"},
    {"g", "ɡ"},
    {"hh", "h"},
    {"hv", "h"},
    {"h", "h"},
    {"jh", "dʒ"},
    {"k", "k"},
    {"l", "l"},
    {"m", "m"},
    {"n", "n"},
    {"ng", "ŋ"},
    {"nx", "n"},
    {"p", "p"},
    {"q", "ʔ"},
    {"r", "ɹ"},
    {"s", "s"},
    {"sh", "ʃ"},
    {"t", "t"},
    {"th", "θ"},
    {"v", "v"},
    {"w", "w"},
    {"wh", "w"},
    {"y", "j"},
    {"z", "z"},
    {"zh", "ʒ"},
    /* closures of stops, which TIMIT counts apart */
    {"bcl", "b"},
    {"dcl", "d"},
    {"gcl", "ɡ"},
    {"kcl", "k"},
    {"pcl", "p"},
    {"tcl", "t"},
    {"sil", ""},
    {"sp", ""},
    {"spn", ""},
    {"pau", ""},
    {"epi", ""},
    {"h#", ""},
};

static bool is_same(const char *name, size_t length, const char *entry) {
    for (size_t i = 0; i < length; i++)
        if (tolower((unsigned char)name[i]) != entry[i])
            return false;
    return !entry[length];
}

const char *arpabet_ipa(const char *name, uint8_t *stress) {
    size_t length = strlen(name);
    *stress = 0;
    if (length > 2 && name[length - 1] >= '0' && name[length - 1] <= '2') {
        static const uint8_t levels[] = {0, 2, 1};
        *stress = levels[name[length - 1] - '0'];
        length--;
    }
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        if (is_same(name, length, names[i].name)) /* an unstressed AH is a schwa */
            return !strcmp(names[i].name, "ah") && name[length] == '0' ? "ə" : names[i].ipa;
    return NULL;
}

bool arpabet_is_telling(const char *name) {
    uint8_t stress;
    const char *ipa = arpabet_ipa(name, &stress);
    return ipa && *ipa && strlen(name) > 1;
}
