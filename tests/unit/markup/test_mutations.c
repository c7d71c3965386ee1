/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads the documents of tests/documents with reproducible random damage by every reader: each gives a valid
 * score or an error with its place. */
#include "server/base/buf.h"
#include "server/markup/markup.h"
#include "server/markup/markup_reader.h"
#include "server/markup/score.h"
#include <dirent.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { ROUNDS = 60, DOCUMENTS = 200, DOCUMENT_BYTES = 20000 };

static struct buf documents[DOCUMENTS];
static size_t document_count;

static uint32_t next_random(uint64_t *seed) {
    *seed = *seed * 6364136223846793005u + 1442695040888963407u;
    return (uint32_t)(*seed >> 33);
}

static int load(void **state) {
    (void)state;
    DIR *folder = opendir(SOURCE_ROOT "/tests/documents");
    for (struct dirent *entry; folder && (entry = readdir(folder)) && document_count < DOCUMENTS;) {
        char path[512];
        const char *dot = strrchr(entry->d_name, '.');
        if (!dot || (strcmp(dot, ".xml") != 0 && strcmp(dot, ".txt") != 0))
            continue;
        snprintf(path, sizeof path, SOURCE_ROOT "/tests/documents/%s", entry->d_name);
        FILE *file = fopen(path, "rb");
        struct buf *d = &documents[document_count++];
        d->size = fread(buf_reserve(d, DOCUMENT_BYTES), 1, DOCUMENT_BYTES, file);
        fclose(file);
    }
    if (folder)
        closedir(folder);
    return document_count < 40;
}

static int unload(void **state) {
    (void)state;
    for (size_t i = 0; i < document_count; i++)
        buf_free(&documents[i]);
    return 0;
}

/* Changes one to four bytes, removes or duplicates parts, or inserts parts of another document. */
static void damage(struct buf *text, const struct buf *from, uint64_t *seed) {
    static const char signs[] = "<>&\"'/=;! \n-[]?aZ09.%\x80\xC3";
    const struct buf *other = &documents[next_random(seed) % document_count];
    buf_add(text, from->data, from->size);
    for (uint32_t n = 1 + next_random(seed) % 4; n && text->size > 1; n--) {
        size_t at = next_random(seed) % text->size, rest = text->size - at,
               some = 1 + next_random(seed) % rest;
        some = some < 40 ? some : 40;
        some = some < rest ? some : rest;
        switch (next_random(seed) % 4) {
        case 0:
            text->data[at] = (uint8_t)signs[next_random(seed) % (sizeof signs - 1)];
            break;
        case 1:
            memmove(text->data + at, text->data + at + some, rest - some);
            text->size -= some;
            break;
        case 2:
            buf_reserve(text, some);
            memmove(text->data + at + some, text->data + at, rest);
            text->size += some;
            break;
        default:
            some = some < other->size ? some : other->size;
            memcpy(text->data + at, other->data + next_random(seed) % (other->size - some + 1), some);
        }
    }
}

static void check_items(const struct score *score, const char *text, size_t size) {
    size_t item = 0, place = 0, bytes = 0;
    for (size_t i = 0; i < score->sentence_count; i++) {
        const struct score_sentence *s = &score->sentences[i];
        assert_int_equal(s->first, item);
        assert_true(s->count > 0);
        item += s->count;
        for (size_t k = s->first; k < item; k++) {
            const struct score_item *it = &score->items[k];
            assert_true(it->start <= it->end && it->end <= size);
            assert_non_null(it->style);
            assert_true(it->kind == SCORE_MARK || it->start >= place);
            place = it->kind == SCORE_MARK ? place : it->start;
            assert_true(it->kind == SCORE_BREAK || it->text);
            bytes += it->text ? strlen(it->text) : 0;
            assert_true(it->seconds >= 0 && it->seconds <= READER_SECONDS);
            assert_true(it->fallback < item - k);
            if (it->verbatim) {
                assert_int_equal(strlen(it->text), it->end - it->start);
                assert_memory_equal(it->text, text + it->start, it->end - it->start);
            }
        }
    }
    assert_int_equal(item, score->item_count);
    assert_true(bytes <= size && score->item_count <= size && score->cue_count <= size);
}

static void check_cues(const struct score *score, size_t size) {
    size_t first = 0;
    for (size_t i = 0; i < score->cue_count; i++) {
        const struct score_cue *cue = &score->cues[i];
        assert_true(cue->first >= first && cue->first <= cue->last && cue->last <= score->item_count);
        assert_true(cue->at < size);
        assert_true(cue->intensity >= 0 && cue->intensity <= 1 && cue->weight <= 1);
        assert_true(fabs(cue->duration.seconds) < 1e7 && fabs(cue->delay.seconds) < 1e7);
        assert_true(cue->around <= i);
        first = cue->first;
    }
    for (size_t i = 0; i < score->timed_count; i++) {
        const struct score_cue *cue = &score->timed[i];
        assert_true(cue->clock >= (i ? score->timed[i - 1].clock : 0) && cue->clock < 1e7);
        assert_true(fabs(cue->duration.seconds) < 1e7 && cue->at < size);
        assert_true(cue->intensity >= 0 && cue->intensity <= 1);
    }
    for (size_t i = 0; i < score->warning_count; i++) {
        assert_true(score->warnings[i].code);
        assert_int_equal(score->warnings[i].place, PLACE_LINE);
        assert_true(score->warnings[i].line >= 1 && score->warnings[i].column >= 1);
    }
}

static void read_one(const struct markup_kind *kind, struct buf *text) {
    struct error e = {0};
    char *utf8 = NULL;
    size_t size = text->size;
    if (markup_decode((char *)text->data, text->size, &utf8, &size, &e)) {
        assert_int_equal(e.place, PLACE_LINE);
        return;
    }
    char *exact = malloc(size ? size : 1); /* the sanitizer detects overruns */
    memcpy(exact, utf8 ? utf8 : (char *)text->data, utf8 ? size : (size = text->size));
    struct score *score = markup_read(kind, exact, size, NULL, &e);
    if (score) {
        struct buf dump = {0};
        check_items(score, exact, size);
        check_cues(score, size);
        score_dump(score, &dump);
        assert_true(dump.size > 0);
        buf_free(&dump);
    } else {
        assert_true(e.code);
        assert_true(*e.message);
        assert_true(e.place != PLACE_NONE || e.code == ERROR_EMPTY_TEXT);
    }
    score_free(score);
    free(exact);
    free(utf8);
}

static void survives(void **state) {
    (void)state;
    uint64_t seed = 20040101;
    for (size_t i = 0; i < document_count; i++)
        for (int round = 0; round < ROUNDS; round++) {
            struct buf text = {0};
            damage(&text, &documents[i], &seed);
            read_one(&markup_kinds[round % 2 ? 0 : next_random(&seed) % 6], &text);
            buf_free(&text);
        }
}

static void survives_every_truncation(void **state) {
    (void)state;
    for (size_t i = 0; i < document_count; i++)
        for (size_t size = 0; size < documents[i].size && size < 700; size += 3) {
            struct buf text = {documents[i].data, size, size};
            read_one(markup_by_name("auto"), &text);
        }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(survives),
                                       cmocka_unit_test(survives_every_truncation)};
    return cmocka_run_group_tests(tests, load, unload);
}
