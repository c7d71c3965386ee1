/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/utf8.h"
#include "server/face/packs/phone_match.h"
#include "server/face/packs/speech_pack.h"
#include "server/face/packs/speech_pack_internal.h"
#include <jansson.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmocka.h>

#define PACKS SOURCE_ROOT "/models/speech/"

static struct speech_pack *load(const char *path) {
    struct error e = {0};
    struct speech_pack *pack = speech_pack_load(path, &e);
    char text[400];
    if (!pack)
        fail_msg("%s: %s", path, error_text(&e, text, sizeof text));
    return pack;
}

static void loads_all_packs(void **state) {
    (void)state;
    struct speech_packs packs;
    struct error e = {0};
    assert_int_equal(speech_packs_load(&packs, PACKS, &e), 0);
    assert_true(packs.count >= 5);
    static const char *const tags[][2] = {
        {"it", "italiano"}, {"pt-BR", "português (Brasil)"}, {"tr", "Türkçe"}, {"en", "English"}};
    for (size_t i = 0; i < 4; i++) {
        const struct speech_pack *pack = speech_packs_find(&packs, tags[i][0]);
        assert_non_null(pack);
        assert_string_equal(speech_pack_lang(pack), tags[i][0]);
        assert_string_equal(speech_pack_name(pack), tags[i][1]);
        assert_non_null(strstr(speech_pack_voices(pack)[0], "+f"));
        assert_true(speech_pack_abbreviations(pack)[0] != NULL);
    }
    speech_packs_free(&packs);
}

static void has_the_printed_coefficients(void **state) {
    (void)state;
    struct speech_pack *pack = load(PACKS "it.json");
    assert_string_equal(pack->consonant_contexts[0], "a");
    /* Leone, table 3.2: t, T, c_bw, c_fw of LI beside /a/. */
    static const struct {
        const char *ipa;
        double t, T, c_bw, c_fw;
    } printed[] = {
        {"p", 0.330, -2, 0.881, 2.072}, {"b", 0.260, -1, 0.584, 2.072}, {"m", 0.140, -0.2, 0.386, 0.595}};
    for (size_t i = 0; i < 3; i++) {
        const struct coefficients *c = &speech_pack_phone(pack, printed[i].ipa, 1)->plain[PARAM_LI];
        assert_true(c->t == printed[i].t && c->T == printed[i].T && c->c_bw == printed[i].c_bw &&
                    c->c_fw == printed[i].c_fw);
        assert_true(c->alpha == 1 && c->k == 1 && c->theta_bw == 8.907 && c->theta_fw == 3);
        assert_true(c->p_bw == 1 && c->p_fw == 1 && c->beta_bw == 0.025 && c->beta_fw == 0.025);
    }
    /* Glides have no dominance, labiodentals just less than all of it. */
    assert_true(speech_pack_phone(pack, "l", 1)->plain[PARAM_LI].alpha == 0);
    assert_true(speech_pack_phone(pack, "n", 1)->plain[PARAM_LI].alpha == 0);
    double fv = speech_pack_phone(pack, "f", 1)->plain[PARAM_LI].alpha;
    assert_true(fv < 1 && fv > 0.9);
    speech_pack_free(pack);
}

/* The phones that espeak-ng 1.51 emits over Debian's word lists of the language. */
static const char *const inventories[][3] = {
    {"it", "it.json",
     "a e o r i t n l s m d k v p ɪ ɛ ʊ f ss j z ɡ b aː u tʃ tː ts bː kː ɔ dʒ w ɾ tsː pː dʒː tʃː ʎ ɲ ʃ ŋ dzː "
     "dː ɡː aɪ dz ɒ ɪː ɔː "
     "t̪ iː eɪ eː ɛː oː uː d̪ h aʊ"},
    {"pt-br", "pt-BR.json",
     "a i e s ɾ z m o ŋ eɪ t æ k d ʊ l p r v u ə n x b f y tʃ ɡ ɐ̃ w ɐ̃ʊ̃ dʒ ʒ j aɪ ʃ aʊ ɛ ɔ ɲ ũ õ iʊ eʊ oɪ uɪ "
     "ɛʊ ɔɪ ɛɪ ɪ ts ʎ h aː iː"},
    {"tr", "tr.json",
     "a n ɯ m j e i ɪ l d ɫ k t r ɛ s z ʃ ɾ dʒ b ʊ æ ɯɯ u ɔ tʃ p o ø y aː ɟ v h œ f ɡ tː uː ʊː oː yː øː ʒ œː "
     "dː c kː bː tʃː dʒː pː ɣ "
     "ɡː ɔː"},
    {"en-us", "en.json",
     "s ɪ n z t ɹ k l ə d m p æ ɛ ɚ b ᵻ eɪ i ɑː f ŋ oʊ ɡ iː ʌ aɪ ʃ ɾ v uː w dʒ əl h ɐ ɜː j tʃ ɑːɹ ɔː aʊ θ iə "
     "ʊ oːɹ ɔːɹ ɔ ɔɪ oː ʊɹ "
     "ɛɹ ɪɹ ʒ ð aɪɚ aɪə n̩ ʔ r x ɑ̃ ɬ e ç o nʲ iːː ɔ̃"},
    {"en-gb", "en.json",
     "ɪ s ə n z t ɹ k l d m a p ɛ b eɪ ɒ i f ŋ əʊ aɪ ʌ iː ɡ ʃ v uː w ɔː dʒ h əl j ɑː ɐ ɜː tʃ iə aʊ θ ʊ eə ɔɪ "
     "aɪə ʊə ð ʒ r x ɔ ɑ̃ ɬ e "
     "ɔ̃ ç o nʲ iːː n̩"},
};

static void maps_every_phone_of_the_voices(void **state) {
    (void)state;
    for (size_t i = 0; i < sizeof inventories / sizeof *inventories; i++) {
        char path[512], list[1024];
        snprintf(path, sizeof path, PACKS "%s", inventories[i][1]);
        snprintf(list, sizeof list, "%s", inventories[i][2]);
        struct speech_pack *pack = load(path);
        for (char *phone = strtok(list, " "); phone; phone = strtok(NULL, " ")) {
            struct phone_matches found;
            phone_match_find(pack, phone, &found);
            if (found.unknown || !found.count)
                fail_msg("%s: \"%s\" is not mapped", inventories[i][0], phone);
        }
        speech_pack_free(pack);
    }
}

static void check_phones(const struct speech_pack *pack, const char *ipa, const char *expected) {
    struct phone_matches found;
    char got[128] = "";
    phone_match_find(pack, ipa, &found);
    double sum = 0;
    for (size_t i = 0; i < found.count; i++) {
        snprintf(got + strlen(got), sizeof got - strlen(got), "%s%s", i ? " " : "",
                 found.match[i].phone->ipa);
        sum += found.match[i].share;
    }
    assert_string_equal(got, expected);
    assert_true(!found.count || (sum > 0.999 && sum < 1.001));
}

static void cuts_phones_at_the_longest_keys(void **state) {
    (void)state;
    struct speech_pack *it = load(PACKS "it.json"), *en = load(PACKS "en.json");
    check_phones(it, "tʃ", "tʃ");
    check_phones(it, "t͡ʃː", "tʃ");
    check_phones(it, "aɪ", "a ɪ");
    check_phones(it, "ˈɛ̃", "ɛ");
    check_phones(it, "tʷ", "t");
    check_phones(it, "", "");
    check_phones(it, "ː", "");
    check_phones(it, "S", "ʃ"); /* SAMPA */
    check_phones(it, "\xff\xfe", "");
    check_phones(en, "n̩", "ə n");
    check_phones(en, "aɪɚ", "a ɪ ɚ");
    check_phones(en, "əl", "ə l");
    struct phone_matches found;
    phone_match_find(en, "aʊ", &found);
    assert_true(found.match[0].share == 0.6);
    speech_pack_free(it);
    speech_pack_free(en);
}

static const struct speech_phone *only(const struct speech_pack *pack, const char *ipa) {
    struct phone_matches found;
    phone_match_find(pack, ipa, &found);
    if (found.unknown || found.count != 1)
        fail_msg("\"%s\" is not one known phone", ipa);
    return found.match[0].phone;
}

static double mean(const struct speech_pack *pack, const char *ipa, enum speech_param p) {
    const struct speech_phone *phone = only(pack, ipa);
    size_t count = phone->group->vowel ? pack->vowel_context_count : pack->consonant_context_count;
    double sum = 0;
    for (size_t i = 0; i < count; i++)
        sum += phone->plain[i * PARAM_COUNT + p].T;
    return sum / (double)count;
}

/* The general pack has every letter of the alphabet, and other names used by voices. */
static void knows_the_whole_alphabet(void **state) {
    (void)state;
    struct speech_pack *pack = load(PACKS "und.json");
    assert_true(speech_pack_is_general(pack));
    assert_true(pack->alphabet->count > 105);
    for (size_t i = 0; i < pack->alphabet->count; i++) {
        char letter[5] = {0};
        utf8_put(pack->alphabet->letters[i].code, letter);
        assert_true(speech_phone_is_vowel(only(pack, letter)) == pack->alphabet->letters[i].vowel);
    }
    /* ties, length, stress, tones, nasality, palatalisation, ejectives, prenasalisation */
    static const char *const marked[][2] = {
        {"t͡ɕʰ", "tɕ"}, {"ʈ͡ʂ", "ʈʂ"}, {"ˈyː", "y"}, {"œ̃", "œ"},    {"a˥˩", "a"},  {"pʲ", "p"},
        {"kʼ", "k"},   {"ᵐb", "b"},  {"ⁿd", "d"},  {"ɡ͡b", "ɡb"},  {"k͡p", "kp"},  {"dˤ", "d"},
        {"r̝̊", "r̝"},    {"ɯᵝ", "ɯᵝ"}, {"ä", "ä"},   {"ʂʷ", "ʂ ʷ"}, {"œy", "œ y"}, {"iau", "i a u"},
        {"p͡f", "p f"}, {"ʘ", "ʘ"},   {"ŋǃ", "ŋ ǃ"}};
    for (size_t i = 0; i < sizeof marked / sizeof *marked; i++)
        check_phones(pack, marked[i][0], marked[i][1]);
    speech_pack_free(pack);
}

static void shows_what_the_features_say(void **state) {
    (void)state;
    struct speech_pack *pack = load(PACKS "und.json");
    /* from close to open */
    static const char *const scales[][8] = {{"i", "ɪ", "e", "ɛ", "æ", "a"}, {"ɨ", "ɘ", "ɜ", "ɐ"},
                                            {"ɯ", "ɤ", "ʌ", "ɑ"},           {"u", "ʊ", "o", "ɔ", "ɒ"},
                                            {"y", "ʏ", "ø", "œ", "ɶ"},      {"ʉ", "ɵ", "ɞ"}};
    for (size_t i = 0; i < sizeof scales / sizeof *scales; i++)
        for (size_t k = 1; scales[i][k]; k++)
            if (mean(pack, scales[i][k], PARAM_LI) <= mean(pack, scales[i][k - 1], PARAM_LI))
                fail_msg("%s is not opener than %s", scales[i][k], scales[i][k - 1]);
    /* rounded beside unrounded of the same height */
    static const char *const pairs[][2] = {{"y", "i"}, {"ʏ", "ɪ"}, {"ø", "e"}, {"œ", "ɛ"}, {"ɶ", "a"},
                                           {"ʉ", "ɨ"}, {"ɵ", "ɘ"}, {"ɞ", "ɜ"}, {"u", "ɯ"}, {"o", "ɤ"},
                                           {"ɔ", "ʌ"}, {"ɒ", "ɑ"}, {"ɥ", "j"}, {"w", "ɰ"}, {"ʃ", "ɕ"}};
    for (size_t i = 0; i < sizeof pairs / sizeof *pairs; i++)
        if (mean(pack, pairs[i][0], PARAM_AR) > mean(pack, pairs[i][1], PARAM_AR) - 1 ||
            mean(pack, pairs[i][0], PARAM_PS) < mean(pack, pairs[i][1], PARAM_PS) + 0.4)
            fail_msg("%s is not rounder than %s", pairs[i][0], pairs[i][1]);
    static const struct {
        enum contact_kind kind;
        const char *phones;
    } contacts[] = {{CONTACT_LIPS, "p b m ɓ ʙ ʘ kp ɡb ŋm"},
                    {CONTACT_TEETH, "f v ʋ ɱ ⱱ"},
                    {CONTACT_NONE, "ɸ β t k q ǃ ǁ ʈ ʔ ħ w ɥ ʍ θ"}};
    for (size_t i = 0; i < sizeof contacts / sizeof *contacts; i++) {
        char list[64];
        snprintf(list, sizeof list, "%s", contacts[i].phones);
        for (char *ipa = strtok(list, " "); ipa; ipa = strtok(NULL, " "))
            if (only(pack, ipa)->contact.kind != contacts[i].kind)
                fail_msg("%s touches what it should not, or does not what it should", ipa);
    }
    /* nearly: less than half as far open as the closest vowel */
    assert_true(mean(pack, "ɸ", PARAM_LI) > 0 && mean(pack, "ɸ", PARAM_LI) < mean(pack, "u", PARAM_LI) / 2);
    speech_pack_free(pack);
}

static void stands_in_for_other_languages(void **state) {
    (void)state;
    struct speech_packs packs;
    struct error e = {0};
    assert_int_equal(speech_packs_load(&packs, PACKS, &e), 0);
    assert_string_equal(speech_pack_lang(speech_packs_find(&packs, "fr-FR")), "und");
    assert_string_equal(speech_pack_lang(speech_packs_find(&packs, "pt")), "pt-BR");
    assert_string_equal(speech_pack_lang(speech_packs_find(&packs, "trv")), "und");
    assert_false(speech_pack_is_general(speech_packs_find(&packs, "it-CH")));
    speech_packs_free(&packs);
}

static void finds_the_nearest_of_unknown_letters(void **state) {
    (void)state;
    struct speech_pack *it = load(PACKS "it.json");
    static const char *const pairs[][2] = {{"ɸ", "p b m"}, {"ʋ", "v ɱ f"}, {"ɯ", "i ɪ ʊ"}, {"ʈ", "ʃ ʒ"},
                                           {"ø", "o y"},   {"ʁ", "x k ɡ"}, {"ɥ", "w"},     {"ɑ", "a"}};
    for (size_t i = 0; i < sizeof pairs / sizeof *pairs; i++) {
        struct phone_matches found;
        phone_match_find(it, pairs[i][0], &found);
        assert_true(found.unknown != 0);
        assert_int_equal(found.count, 1);
        if (!strstr(pairs[i][1], found.stand_in->ipa))
            fail_msg("%s is shown like %s, not one of %s", pairs[i][0], found.stand_in->ipa, pairs[i][1]);
    }
    struct phone_matches found;
    phone_match_find(it, "§", &found);
    assert_int_equal(found.unknown, 0xA7);
    assert_int_equal(found.count, 0);
    assert_null(found.stand_in);
    speech_pack_free(it);
}

/* A folder with copies of the packs, one of them modified. */
struct workshop {
    char folder[64];
};

static void write_file(const char *path, const char *text, size_t n) {
    FILE *f = fopen(path, "wb");
    assert_non_null(f);
    assert_int_equal(fwrite(text, 1, n, f), n);
    fclose(f);
}

static void copy(const char *from, const char *to) {
    FILE *f = fopen(from, "rb");
    assert_non_null(f);
    static char text[1 << 20];
    size_t n = fread(text, 1, sizeof text, f);
    fclose(f);
    write_file(to, text, n);
}

static int open_workshop(void **state) {
    struct workshop *w = calloc(1, sizeof *w);
    char path[256];
    strcpy(w->folder, "/tmp/test_speech.XXXXXX");
    if (!w || !mkdtemp(w->folder))
        return -1;
    snprintf(path, sizeof path, "%s/alphabets", w->folder);
    mkdir(path, 0700);
    snprintf(path, sizeof path, "%s/alphabets/ipa.json", w->folder);
    copy(PACKS "alphabets/ipa.json", path);
    *state = w;
    return 0;
}

static int close_workshop(void **state) {
    struct workshop *w = *state;
    static const char *const files[] = {"it.json", "heir.json", "a.json", "b.json", "c.json",
                                        "d.json",  "e.json",    "f.json", "z.json", "alphabets/ipa.json",
                                        NULL};
    char path[256];
    for (size_t i = 0; files[i]; i++) {
        snprintf(path, sizeof path, "%s/%s", w->folder, files[i]);
        unlink(path);
    }
    snprintf(path, sizeof path, "%s/alphabets", w->folder);
    rmdir(path);
    rmdir(w->folder);
    free(w);
    return 0;
}

/* Sets path ("a/b/c") of the Italian pack to a value (JSON text; NULL = removed), loads it, and expects an
 * error at field. */
static void check_broken(struct workshop *w, const char *path, const char *value, const char *field) {
    json_error_t bad;
    json_t *root = json_load_file(PACKS "it.json", 0, &bad), *at = root;
    char names[128], file[256], *save;
    snprintf(names, sizeof names, "%s", path);
    char *name = strtok_r(names, "/", &save), *next;
    for (; (next = strtok_r(NULL, "/", &save)); name = next)
        at = json_object_get(at, name);
    assert_non_null(at);
    if (value)
        json_object_set_new(at, name, json_loads(value, JSON_DECODE_ANY, &bad));
    else
        json_object_del(at, name);
    snprintf(file, sizeof file, "%s/it.json", w->folder);
    json_dump_file(root, file, 0);
    json_decref(root);
    struct error e = {0};
    assert_null(speech_pack_load(file, &e));
    assert_string_equal(error_name(e.code), !strcmp(field, "alphabet") ? "bad-alphabet" : "bad-speech-pack");
    assert_int_equal(e.place, PLACE_FIELD);
    if (strcmp(e.field, field) != 0)
        fail_msg("expected \"%s\", got \"%s\": %s", field, e.field, e.message);
}

static void names_the_place_of_an_error(void **state) {
    struct workshop *w = *state;
    check_broken(w, "name", NULL, "name");
    check_broken(w, "name", "\"\"", "name");
    check_broken(w, "colour", "1", "colour");
    check_broken(w, "voices", "[\"espeak:it\", 3]", "voices[1]");
    check_broken(w, "alphabet", "\"runes\"", "alphabet");
    check_broken(w, "fapu/MNS", "0", "fapu.MNS");
    check_broken(w, "rest/reach", "\"soon\"", "rest.reach");
    check_broken(w, "undershoot/AR", "-1", "undershoot.AR");
    check_broken(w, "trough", "1.5", "trough");
    check_broken(w, "contexts/vowels", "[]", "contexts.vowels");
    check_broken(w, "groups/pbm/viseme", "15", "groups.pbm.viseme");
    check_broken(w, "groups/pbm/context", "\"a\"", "groups.pbm.context");
    check_broken(w, "groups/pbm/coefficients/LS/k", NULL, "groups.pbm.coefficients.LS.k");
    check_broken(w, "groups/pbm/coefficients/LS/t", "0.5", "groups.pbm.coefficients.LS.t");
    check_broken(w, "groups/pbm/coefficients/LI/alpha", "1.5", "groups.pbm.coefficients.LI.alpha");
    check_broken(w, "phones/p/targets/LI/a/T", "\"-2\"", "phones.p.targets.LI.a.T");
    check_broken(w, "phones/p/targets/LI/a", NULL, "phones.p.targets.LI");
    check_broken(w, "phones/p/targets/LI/q", "{}", "phones.p.targets.LI.q");
    check_broken(w, "phones/p/targets/XX", "{}", "phones.p.targets.XX");
    check_broken(w, "phones/t/targets/TH", NULL, "phones.t.targets.TH");
    check_broken(w, "phones/p/targets", NULL, "phones.p.targets");
    check_broken(w, "phones/p/group", "\"lips\"", "phones.p.group");
    check_broken(w, "phones/p/stressed", "{}", "phones.p.stressed");
    check_broken(w, "phones/p/contact/kind", "\"nose\"", "phones.p.contact.kind");
    check_broken(w, "phones/p/contact/reach", "1", "phones.p.contact.reach");
    check_broken(w, "phones/a/stressed/LI/pause/t", "2", "phones.a.stressed.LI.pause.t");
    check_broken(w, "phones/ð/like", "\"nobody\"", "phones.ð.like");
    check_broken(w, "phones/ɪ/like", "{\"i\": 0.7, \"p\": 0.3}", "phones.ɪ.like");
    check_broken(w, "phones/θ", "{\"sampa\": \"T\", \"like\": \"ð\"}", "phones.θ");
    check_broken(w, "phones/ð/like", "\"ð\"", "phones.ð.like");
    check_broken(w, "phones/ð/source", "7", "phones.ð.source");
    check_broken(w, "phones/ð/gain", "{\"LI\": 1e9}", "phones.ð.gain.LI");
    check_broken(w, "phones/ai", "{\"sampa\": \"ai\", \"parts\": []}", "phones.ai.parts");
    check_broken(w, "phones/ai", "{\"sampa\": \"ai\", \"parts\": [{\"phone\": \"a\"}]}",
                 "phones.ai.parts[0].share");
}

static void check_text(struct workshop *w, const char *name, const char *text, struct error *e) {
    char file[256];
    snprintf(file, sizeof file, "%s/%s", w->folder, name);
    write_file(file, text, strlen(text));
    *e = (struct error){0};
    assert_null(speech_pack_load(file, e));
    assert_string_equal(error_name(e->code), "bad-speech-pack");
}

static void refuses_what_is_no_pack(void **state) {
    struct workshop *w = *state;
    struct error e;
    check_text(w, "it.json", "{\n  \"tag\": }", &e);
    assert_int_equal(e.place, PLACE_LINE);
    assert_int_equal(e.line, 2);
    check_text(w, "it.json", "{\"tag\": \"it\", \"tag\": \"it\"}", &e);
    assert_int_equal(e.place, PLACE_LINE);
    check_text(w, "it.json", "[]", &e);
    check_text(
        w, "heir.json",
        "{\"tag\": \"it-x-a\", \"name\": \"x\", \"inherits\": \"heir\", \"sources\": [], \"voices\": [],"
        " \"abbreviations\": [], \"phones\": {}}",
        &e);
    assert_string_equal(e.field, "inherits");
    assert_null(speech_pack_load("/nowhere/it.json", &e));
    assert_string_equal(error_name(e.code), "bad-speech-pack");
}

static void describes_phones_by_others(void **state) {
    struct workshop *w = *state;
    char file[256];
    snprintf(file, sizeof file, "%s/it.json", w->folder);
    copy(PACKS "it.json", file);
    static const char heir[] =
        "{\"tag\": \"it-x-a\", \"name\": \"x\", \"inherits\": \"it\", \"sources\": [], "
        "\"voices\": [], \"abbreviations\": [],"
        " \"phones\": {\"ʌ\": {\"sampa\": \"V\", \"like\": {\"a\": 0.75, \"e\": "
        "0.25}, \"gain\": {\"LI\": 2}, \"shift\": {\"AR\": 1}},"
        "   \"a\": {\"sampa\": \"a\", \"like\": \"a\", \"coefficients\": {\"LI\": "
        "{\"alpha\": 0.5}}, \"viseme\": 3}}}";
    snprintf(file, sizeof file, "%s/heir.json", w->folder);
    write_file(file, heir, sizeof heir - 1);
    struct speech_pack *pack = load(file);
    const struct speech_phone *mixed = speech_pack_phone(pack, "ʌ", strlen("ʌ")),
                              *own = speech_pack_phone(pack, "a", 1),
                              *a = speech_pack_phone(pack->base, "a", 1),
                              *e = speech_pack_phone(pack->base, "e", 1);
    assert_ptr_not_equal(own, a);
    assert_true(own->plain[PARAM_LI].alpha == 0.5 && own->plain[PARAM_LI].T == a->plain[PARAM_LI].T &&
                own->viseme == 3);
    assert_true(own->plain[PARAM_LS].alpha == a->plain[PARAM_LS].alpha);
    double expected = 2 * (0.75 * a->stressed[PARAM_LI].T + 0.25 * e->stressed[PARAM_LI].T);
    assert_true(mixed->stressed[PARAM_LI].T > expected - 1e-9 &&
                mixed->stressed[PARAM_LI].T < expected + 1e-9);
    expected = 1 + 0.75 * a->plain[PARAM_AR].T + 0.25 * e->plain[PARAM_AR].T;
    assert_true(mixed->plain[PARAM_AR].T > expected - 1e-9 && mixed->plain[PARAM_AR].T < expected + 1e-9);
    assert_string_equal(mixed->group->name, "a");
    /* Phones missing in the pack come from its base. */
    assert_ptr_equal(speech_pack_phone(pack, "p", 1), speech_pack_phone(pack->base, "p", 1));
    speech_pack_free(pack);
}

static void write_heir(struct workshop *w, char name, const char *of) {
    char file[256], text[256];
    snprintf(file, sizeof file, "%s/%c.json", w->folder, name);
    snprintf(text, sizeof text,
             "{\"tag\": \"it-x-%c\", \"name\": \"x\", \"inherits\": \"%s\", \"sources\": [], \"voices\": [],"
             " \"abbreviations\": [], \"phones\": {}}",
             name, of);
    write_file(file, text, strlen(text));
}

static void shares_what_several_inherit(void **state) {
    struct workshop *w = *state;
    struct speech_packs packs;
    struct error e = {0};
    char file[256];
    snprintf(file, sizeof file, "%s/heir.json", w->folder);
    unlink(file);
    snprintf(file, sizeof file, "%s/it.json", w->folder);
    copy(PACKS "it.json", file);
    write_heir(w, 'a', "it");
    write_heir(w, 'z', "it");
    assert_int_equal(speech_packs_load(&packs, w->folder, &e), 0);
    assert_int_equal(packs.count, 3);
    assert_ptr_equal(packs.packs[0]->base, packs.packs[1]);
    assert_ptr_equal(packs.packs[2]->base, packs.packs[1]);
    speech_packs_free(&packs);
    /* the length of a chain does not depend on which of its packs were read before */
    for (char name = 'b'; name < 'g'; name++)
        write_heir(w, name, (char[]){(char)(name - 1), '\0'});
    assert_int_equal(speech_packs_load(&packs, w->folder, &e), -1);
    assert_non_null(strstr(e.message, "goes on for more than 4 packs"));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(loads_all_packs),
        cmocka_unit_test(has_the_printed_coefficients),
        cmocka_unit_test(maps_every_phone_of_the_voices),
        cmocka_unit_test(cuts_phones_at_the_longest_keys),
        cmocka_unit_test(knows_the_whole_alphabet),
        cmocka_unit_test(shows_what_the_features_say),
        cmocka_unit_test(stands_in_for_other_languages),
        cmocka_unit_test(finds_the_nearest_of_unknown_letters),
        cmocka_unit_test(names_the_place_of_an_error),
        cmocka_unit_test(refuses_what_is_no_pack),
        cmocka_unit_test(describes_phones_by_others),
        cmocka_unit_test(shares_what_several_inherit),
    };
    return cmocka_run_group_tests(tests, open_workshop, close_workshop);
}
