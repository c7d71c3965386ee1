/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/cluster/redis_notes.h"
#include "server/base/mem.h"
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <utlist.h>

static struct note *note_new(const char *name, bool is_mark) {
    size_t size = strlen(name) + 1;
    struct note *note = mem_alloc(sizeof *note + size);
    memcpy(note->name, name, size);
    note->is_mark = is_mark;
    return note;
}

static void want(struct notes *all, struct note *note) {
    if (!note->dirty)
        DL_APPEND(all->dirty, note);
    note->dirty = true;
}

static void stay(struct notes *all, struct note *note) {
    if (note->leaves)
        DL_DELETE2(all->leaving, note, leaving_prev, leaving_next);
    note->leaves = 0;
}

void notes_write(struct notes *all, const char *name, const char *text) {
    struct note *note;
    HASH_FIND_STR(all->notes, name, note);
    if (!note && !*text)
        return;
    if (!note) {
        note = note_new(name, false);
        HASH_ADD_STR(all->notes, name, note);
    }
    if (!strcmp(note->text, text))
        return;
    snprintf(note->text, sizeof note->text, "%s", text);
    stay(all, note);
    want(all, note);
}

bool notes_mark(struct notes *all, const char *name, uint64_t until, bool known) {
    struct note *mark;
    HASH_FIND_STR(all->marks, name, mark);
    if (mark)
        return false;
    if (known && HASH_COUNT(all->marks) >= BOARD_MARKS_MOST)
        return true;
    mark = note_new(name, true);
    mark->until = until;
    if (until)
        snprintf(mark->text, sizeof mark->text, "%" PRIu64, until);
    HASH_ADD_STR(all->marks, name, mark);
    if (!known)
        want(all, mark);
    return true;
}

void notes_end(struct notes *all, uint64_t clock) {
    struct note *mark, *next;
    HASH_ITER(hh, all->marks, mark, next) {
        if (!mark->until || mark->until > clock)
            continue;
        if (mark->dirty)
            DL_DELETE(all->dirty, mark);
        HASH_DEL(all->marks, mark);
        free(mark);
    }
}

/* Those that were taken away long ago come first: they stay in their list until the words have been sent. */
int notes_batch(struct notes *all, struct link_text *words, int most, uint64_t now) {
    int count = 0;
    for (struct note *n = all->leaving; n && n->leaves <= now && !n->dirty && count < most;
         n = n->leaving_next, count++) {
        words[3 * count] = link_text_of("f");
        words[3 * count + 1] = link_text_of(n->name);
        words[3 * count + 2] = link_text_of("");
        n->leaves = 1;
    }
    while (all->dirty && count < most) {
        struct note *n = all->dirty;
        DL_DELETE(all->dirty, n);
        n->dirty = false;
        words[3 * count] = link_text_of(n->is_mark ? "m" : "n");
        words[3 * count + 1] = link_text_of(n->name);
        words[3 * count++ + 2] = link_text_of(n->text);
        if (n->is_mark)
            continue;
        all->written += !n->written;
        n->written = true;
        stay(all, n);
        if (!*n->text) {
            n->leaves = now + NOTE_LEAVES_MS;
            DL_APPEND2(all->leaving, n, leaving_prev, leaving_next);
        }
    }
    return count;
}

void notes_sent(struct notes *all) {
    while (all->leaving && all->leaving->leaves == 1) {
        struct note *n = all->leaving;
        DL_DELETE2(all->leaving, n, leaving_prev, leaving_next);
        HASH_DEL(all->notes, n);
        all->written -= n->written;
        free(n);
    }
}

void notes_again(struct notes *all) {
    for (struct note *n = all->notes; n; n = n->hh.next) {
        n->written = false;
        want(all, n);
    }
    for (struct note *n = all->marks; n; n = n->hh.next)
        want(all, n);
    all->written = 0;
}

static void free_notes(struct note *notes) {
    struct note *n, *next;
    HASH_ITER(hh, notes, n, next) {
        HASH_DEL(notes, n);
        free(n);
    }
}

void notes_free(struct notes *all) {
    free_notes(all->notes);
    free_notes(all->marks);
    *all = (struct notes){0};
}
