/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/library/recordings/alignment_state.h"
#include "server/base/mem.h"
#include "server/library/recordings/kept_file.h"
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

const char *const alignment_states[ALIGNMENT_STATES] = {"waiting", "aligning", "aligned", "stale", "failed"};

json_t *alignment_stamp(const char *path) {
    struct stat info;
    return stat(path, &info) ? NULL
                             : json_pack("{sI sI}", "size", (json_int_t)info.st_size, "modified",
                                         (json_int_t)kept_time(&info));
}

bool alignment_is_of(const json_t *report, const char *member, const char *path) {
    const json_t *of = json_object_get(report, member);
    json_t *now = alignment_stamp(path);
    bool same = now && json_equal(json_object_get(of, "size"), json_object_get(now, "size")) &&
                json_equal(json_object_get(of, "modified"), json_object_get(now, "modified"));
    json_decref(now);
    return same;
}

static void text_path(char path[PATH_MAX], const char *folder, const char *work) {
    snprintf(path, PATH_MAX, "%s/%s.txt", folder, work);
}

enum alignment_state alignment_state_kept(const char *folder, const char *work, const char *sound,
                                          char **why) {
    json_t *report = kept_json(folder, work, ALIGNMENT_ENDING);
    const char *state = json_string_value(json_object_get(report, "state"));
    const char *told = json_string_value(json_object_get(report, "why"));
    char text[PATH_MAX];
    text_path(text, folder, work);
    enum alignment_state result = ALIGNMENT_WAITING;
    bool aligned = state && !strcmp(state, alignment_states[ALIGNMENT_ALIGNED]);
    *why = NULL;
    if (aligned || state) {
        bool current = alignment_is_of(report, "text", text) && alignment_is_of(report, "sound", sound);
        result = aligned ? (current ? ALIGNMENT_ALIGNED : ALIGNMENT_STALE)
                         : (current ? ALIGNMENT_FAILED : ALIGNMENT_WAITING);
    }
    if (result == ALIGNMENT_FAILED)
        *why = mem_strdup(told ? told : "");
    json_decref(report);
    return result;
}

int alignment_keep_failure(const char *folder, const char *work, const char *sound, const char *why,
                           struct error *e) {
    char text[PATH_MAX];
    text_path(text, folder, work);
    json_t *report =
        json_pack("{ss so* so* so*}", "state", alignment_states[ALIGNMENT_FAILED], "why", json_string(why),
                  "text", alignment_stamp(text), "sound", alignment_stamp(sound));
    int result = kept_set_json(folder, work, ALIGNMENT_ENDING, report, e);
    json_decref(report);
    return result;
}

/* Whose passages are of that section: "WORK:SECTION:NAME". */
static json_t *of_section(const json_t *list, const char *work, unsigned section) {
    json_t *some = json_array(), *each;
    char begin[112];
    size_t i;
    int length = snprintf(begin, sizeof begin, "%s:%u:", work, section);
    json_array_foreach((json_t *)list, i, each) {
        const char *passage = json_string_value(json_object_get(each, "passage"));
        if (passage && (!section || !strncmp(passage, begin, (size_t)length)))
            json_array_append(some, each);
    }
    return some;
}

void alignment_tell(const char *folder, const char *work, unsigned section, json_t *object) {
    static const char *const lists[] = {"unread", "unwritten"};
    static const char *const figures[] = {"sentences", "missing", "doubtful", "confidence"};
    json_t *report = kept_json(folder, work, ALIGNMENT_ENDING);
    for (size_t i = 0; i < 2; i++)
        json_object_set_new(object, lists[i], of_section(json_object_get(report, lists[i]), work, section));
    for (size_t i = 0; i < 4 && !section; i++) {
        json_t *figure = json_object_get(report, figures[i]);
        if (figure)
            json_object_set(object, figures[i], figure);
    }
    json_decref(report);
}
