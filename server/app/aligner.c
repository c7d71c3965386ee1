/* SPDX-License-Identifier: GPL-3.0-or-later */
/* faccia-align: aligns one recording for the daemon's library (server/library/recordings), confined, behind
 * all that anybody else does, and by no more than its share of a processor. It reads what library_voices.h
 * prepared and keeps times and report beside it. On its standard output it says how far it is, a share of the
 * sound in each line; the last line is "done", "failed: WHY" (which is kept, too) or "later: WHY". */
#include "server/app/aligner_pace.h"
#include "server/app/aligner_report.h"
#include "server/base/buf.h"
#include "server/base/mem.h"
#include "server/base/program.h"
#include "server/library/library_files.h"
#include "server/library/recordings/alignments.h"
#include "server/library/recordings/library_voices.h"
#include "server/voice/faccia-voice.h"
#include "server/voice/sandbox.h"
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define TIMES_ENDING ".timing.json"

enum { FOLDER = 1, WORK, SOUND, PERCENT, MEGABYTES, WORKER, PLUGIN, SANDBOX, ARGUMENTS };
enum { TEXT_BYTES_MAX = 256 << 20 };

struct aligner_run {
    const char *folder, *work, *sound;
    struct reference_slot reference;
    struct pace pace;
    struct buf text; /* with its NUL */
    json_t *places, *report;
};

static int later(const char *why) {
    printf("later: %s\n", why);
    return 1;
}

static int later_as(const struct error *e) {
    char text[400];
    return later(error_text(e, text, sizeof text));
}

/* A message that begins with the sound's path: where the library lies is nobody's business. */
static const char *without_folder(const struct aligner_run *a, const char *why) {
    const char *slash = strrchr(a->sound, '/');
    size_t folder = slash ? (size_t)(slash + 1 - a->sound) : 0;
    return why && !strncmp(why, a->sound, folder) ? why + folder : why;
}

/* The state of the report says what it is. */
static int keep(struct aligner_run *a, const char *message) {
    struct error e;
    const char *why = without_folder(a, message);
    json_object_set_new(a->report, "state",
                        json_string(alignment_states[why ? ALIGNMENT_FAILED : ALIGNMENT_ALIGNED]));
    if (why)
        json_object_set_new(a->report, "why", json_string(why));
    if (kept_set_json(a->folder, a->work, ALIGNMENT_ENDING, a->report, &e))
        return later_as(&e);
    printf(why ? "failed: %s\n" : "done\n", why);
    return why ? 1 : 0;
}

static void path_of(const struct aligner_run *a, const char *ending, char path[PATH_MAX]) {
    snprintf(path, PATH_MAX, "%s/%s%s", a->folder, a->work, ending);
}

static int read_file(const char *path, struct buf *out) {
    FILE *file = fopen(path, "rb");
    size_t got = 1;
    while (file && got && out->size < TEXT_BYTES_MAX) {
        got = fread(buf_reserve(out, 65536), 1, 65536, file);
        out->size += got;
    }
    bool well = file && !ferror(file) && out->size < TEXT_BYTES_MAX;
    if (file)
        fclose(file);
    return well ? 0 : -1;
}

/* What it is made of, before that is read: what changes meanwhile is seen to be another. */
static int stamp(struct aligner_run *a, const char *member, const char *path) {
    char hash[65];
    json_t *of = alignment_stamp(path);
    if (!of || !library_file_hash(NULL, path, hash)) {
        json_decref(of);
        return -1;
    }
    json_object_set_new(of, "hash", json_string(hash));
    json_object_set_new(a->report, member, of);
    return 0;
}

static bool is_hash_of(const json_t *old, const json_t *now, const char *member) {
    const char *a = json_string_value(json_object_get(json_object_get(old, member), "hash"));
    const char *b = json_string_value(json_object_get(json_object_get(now, member), "hash"));
    return a && b && !strcmp(a, b);
}

/* Files that were only touched have what they had. True when that was all; *status is the exit's. */
static bool is_known(struct aligner_run *a, int *status) {
    json_t *old = kept_json(a->folder, a->work, ALIGNMENT_ENDING);
    const char *state = json_string_value(json_object_get(old, "state"));
    bool sound = is_hash_of(old, a->report, "sound"), text = is_hash_of(old, a->report, "text");
    char times[PATH_MAX];
    path_of(a, TIMES_ENDING, times);
    bool aligned = state && !strcmp(state, alignment_states[ALIGNMENT_ALIGNED]);
    bool known = sound && text && state && (!aligned || !access(times, R_OK));
    if (known) {
        json_object_update_missing(a->report, old);
        *status = keep(a, aligned ? NULL : json_string_value(json_object_get(old, "why")));
    } else if (json_object_get(json_object_get(old, "sound"), "hash") && !sound) {
        unlink(times); /* of another sound, perhaps of the same length */
    }
    json_decref(old);
    return known;
}

/* Times that the voice has found, when it was asked before this came to it. */
static bool take_kept(struct aligner_run *a, uint64_t samples) {
    char path[PATH_MAX];
    struct buf data = {0};
    size_t size = a->text.size - 1;
    path_of(a, TIMES_ENDING, path);
    struct aligner_sentences sentences = {0};
    struct aligned_recording_sentence *list = NULL;
    if (!read_file(path, &data) &&
        aligned_recording_is_of((char *)data.data, data.size, (char *)a->text.data, size, samples)) {
        json_t *times = json_loadb((char *)data.data, data.size, 0, NULL);
        list = aligner_sentences_kept(times, size, &sentences.count);
        json_decref(times);
    }
    sentences.list = list;
    if (list)
        aligner_report(a->report, &sentences, (char *)a->text.data, a->work, a->places);
    free(list);
    buf_free(&data);
    return list;
}

static int align(struct aligner_run *a, struct aligned_recording *r) {
    struct error e;
    char times[PATH_MAX], why[400];
    int found = 1;
    while (found > 0 && (found = aligned_recording_advance(r, &e)) > 0) {
        printf("%.4f\n", fmin(1, r->until * r->sound->rate / fmax(1, (double)r->sound->samples)));
        pace_keep(&a->pace, a->reference.reference ? reference_process(a->reference.reference) : 0);
    }
    if (found < 0)
        return e.code == ERROR_NO_REFERENCE ? later_as(&e) : keep(a, error_text(&e, why, sizeof why));
    path_of(a, TIMES_ENDING, times);
    if (aligned_recording_save(r, times, &e))
        return later_as(&e);
    const struct aligner_sentences sentences = {r->sentences, r->sentence_count, r->rest};
    aligner_report(a->report, &sentences, (char *)a->text.data, a->work, a->places);
    return keep(a, NULL);
}

static int open_and_align(struct aligner_run *a, const char *lang) {
    struct error e;
    char why[400];
    const struct aligned_recording_options options = {.sound = a->sound,
                                                      .text = (char *)a->text.data,
                                                      .text_size = a->text.size - 1,
                                                      .lang = lang,
                                                      .reference = &a->reference};
    struct aligned_recording *r = aligned_recording_open(&options, &e);
    int status = 0;
    if (!r)
        status = keep(a, error_text(&e, why, sizeof why));
    else if (!r->tokens.count)
        status = keep(a, "there are no words in the text");
    else if (!r->sound->samples)
        status = keep(a, "there is no sound in the recording");
    else if (take_kept(a, r->sound->samples))
        status = keep(a, NULL);
    else
        status = align(a, r);
    aligned_recording_free(r);
    return status;
}

static int run(struct aligner_run *a) {
    char text[PATH_MAX];
    int status;
    path_of(a, ".txt", text);
    json_t *about = kept_json(a->folder, a->work, ".json");
    const char *lang = json_string_value(json_object_get(about, "lang"));
    json_t *kept = kept_json(a->folder, a->work, ".places");
    a->places = json_object_get(kept, "places");
    if (!lang || !a->places || stamp(a, "text", text) || read_file(text, &a->text)) {
        status = later("the text cannot be read");
    } else if (stamp(a, "sound", a->sound)) {
        status = later("the recording cannot be read");
    } else if (!is_known(a, &status)) {
        buf_add(&a->text, "", 1);
        status = open_and_align(a, lang);
    }
    json_decref(kept);
    json_decref(about);
    return status;
}

/* Its folder it may write to, its sound read; nothing else, and no programs. */
static void confine(const struct aligner_run *a, const char *plugin) {
    const struct needs needs = {.capabilities = FACCIA_VOICE_FILES};
    const struct sandbox_path paths[] = {{a->folder, true}, {a->sound, false}};
    const struct sandbox sandbox = {plugin, &needs, paths, 2, getppid()};
    struct sandbox_gaps gaps;
    sandbox_enter(&sandbox, &gaps);
}

int main(int argc, char **argv) {
    struct error e;
    program_begin();
    if (argc != ARGUMENTS) {
        fputs("usage: faccia-align FOLDER WORK SOUND PERCENT MEGABYTES WORKER PLUGIN on|off\nAligns a "
              "recording "
              "of the library for facciad, which starts this program by itself.\n",
              stderr);
        return argc == 2 && !strcmp(argv[1], "--help") ? 0 : 2;
    }
    struct aligner_run a = {
        .folder = argv[FOLDER], .work = argv[WORK], .sound = argv[SOUND], .report = json_object()};
    const double percent = atof(argv[PERCENT]);
    pace_give_way((unsigned)atoi(argv[MEGABYTES]));
    setvbuf(stdout, NULL, _IOLBF, 0);
    pace_begin(&a.pace, percent > 0 ? percent : 100);
    a.reference.unconfined = !strcmp(argv[SANDBOX], "off");
    snprintf(a.reference.worker, sizeof a.reference.worker, "%s", argv[WORKER]);
    snprintf(a.reference.path, sizeof a.reference.path, "%s", argv[PLUGIN]);
    int status;
    if (!reference_get(&a.reference, &e)) {
        status = later_as(&e);
    } else {
        if (!a.reference.unconfined)
            confine(&a, argv[PLUGIN]);
        status = run(&a);
    }
    reference_close(a.reference.reference);
    json_decref(a.report);
    buf_free(&a.text);
    return status;
}
