/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/normalize/script_runs.h"
#include "server/base/utf8.h"
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <unicode/uloc.h>
#include <unicode/uscript.h>

enum { SCRIPTS = 8, LATIN_LAST = 0x24F };

/* Scripts that a language is written in. Returns their number, 0 if unknown. */
static int scripts_of(const char *lang, UScriptCode scripts[SCRIPTS]) {
    UErrorCode e = U_ZERO_ERROR;
    int count = uscript_getCode(lang, scripts, SCRIPTS, &e);
    return U_SUCCESS(e) ? count : 0;
}

/* Kana and Chinese characters stand side by side in Japanese. */
static UScriptCode family(UScriptCode script) {
    return script == USCRIPT_KATAKANA || script == USCRIPT_HIRAGANA ? USCRIPT_HAN : script;
}

static UScriptCode script_of(uint32_t cp) {
    UErrorCode e = U_ZERO_ERROR;
    UScriptCode script = uscript_getScript((UChar32)cp, &e);
    bool known = U_SUCCESS(e) && script >= 0 && (int)script < SCRIPT_RUN_SCRIPTS && script != USCRIPT_UNKNOWN;
    return known ? script : USCRIPT_COMMON;
}

static bool is_shared(UScriptCode script) {
    return script == USCRIPT_COMMON || script == USCRIPT_INHERITED;
}

static bool is_own(UScriptCode script, const UScriptCode *own, int count) {
    for (int i = 0; i < count; i++)
        if (family(own[i]) == family(script))
            return true;
    return script == USCRIPT_LATIN || is_shared(script);
}

/* Extends a run whose first letter lies at run->from. Returns the byte after what was read. */
static size_t extend(const char *text, size_t size, struct script_run *run) {
    UScriptCode of = family((UScriptCode)run->script);
    size_t at = run->from, length;
    for (uint32_t cp = 0; at < size; at += length) {
        length = utf8_next(text + at, size - at, &cp);
        UScriptCode script = length ? script_of(cp) : USCRIPT_LATIN;
        if (is_shared(script)) { /* a mark on the last letter, or punctuation of that script */
            if (run->to == at && (script == USCRIPT_INHERITED || uscript_hasScript((UChar32)cp, of) ||
                                  uscript_hasScript((UChar32)cp, (UScriptCode)run->script)))
                run->to = at + length;
            continue;
        }
        if (family(script) != of)
            break;
        if (script != USCRIPT_HAN)
            run->script = script;
        run->to = at + length;
        run->letters++;
    }
    return at;
}

bool script_run_next(const char *text, size_t size, const char *lang, size_t at, struct script_run *run) {
    UScriptCode own[SCRIPTS];
    int count = -1;
    while ((at = utf8_skip_latin(text, size, at)) < size) {
        uint32_t cp = 0;
        size_t length = (unsigned char)text[at] < 0x80 ? 1 : utf8_next(text + at, size - at, &cp);
        if (!length || cp <= LATIN_LAST) {
            at += length ? length : 1;
            continue;
        }
        if (count < 0 && !(count = scripts_of(lang, own)))
            return false;
        UScriptCode script = script_of(cp);
        if (is_own(script, own, count)) {
            at += length;
            continue;
        }
        *run = (struct script_run){.from = at, .to = at, .script = script};
        at = extend(text, size, run);
        if (script != USCRIPT_GREEK || run->letters > 1)
            return true;
    }
    return false;
}

void script_run_lang(int script, char lang[SCRIPT_LANG_BYTES]) {
    char locale[32], full[ULOC_FULLNAME_CAPACITY];
    UErrorCode e = U_ZERO_ERROR;
    snprintf(locale, sizeof locale, "und_%s", uscript_getShortName((UScriptCode)script));
    uloc_addLikelySubtags(locale, full, sizeof full, &e);
    snprintf(lang, SCRIPT_LANG_BYTES, "%.*s", (int)strcspn(full, "_"), U_SUCCESS(e) ? full : "und");
}

const char *script_run_name(int script) {
    const char *name = uscript_getName((UScriptCode)script);
    return name ? name : "that script";
}
