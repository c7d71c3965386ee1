/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/buf.h"
#include "server/base/mem.h"
#include "server/base/program.h"
#include "server/base/utf8.h"
#include "server/library/align/aligned_recording.h"
#include "server/library/align/text_reading.h"
#include "server/library/library_files.h"
#include "server/library/recordings/alignments.h"
#include "server/library/recordings/library_voices.h"
#include "server/voice/faccia-voice.h"
#include "server/voice/sandbox.h"
#include <jansson.h>
#include <limits.h>
#include <math.h>
#include <sched.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/types.h>
#include <time.h>
#include <unistd.h>

/* ---- yielding the processor to everything else ---- */

struct pace {
    double percent; /* of one processor */
    double begun;   /* s of the monotonic clock */
};

/* ---- the report: sentences by passage of the work, see recordings/alignments.h ---- */

struct aligner_sentences {
    const struct aligned_recording_sentence *list;
    size_t count;
    double rest; /* s of sound after the last sentence */
};

enum { LOWEST = 19, STEP_SECONDS = 900 };

static double clock_of(clockid_t id) {
    struct timespec t;
    return clock_gettime(id, &t) ? 0 : (double)t.tv_sec + (double)t.tv_nsec / 1e9;
}

/* Lowers the priority of this process and of those it starts, limits its memory, and ends it with its
 * parent. */
static void pace_give_way(unsigned megabytes) {
    const struct sched_param none = {0};
    setpgid(0, 0);
    program_end_with_parent(STDOUT_FILENO, SIGKILL);
    setpriority(PRIO_PROCESS, 0, LOWEST);
    sched_setscheduler(0, SCHED_IDLE, &none);
    memory_limit(megabytes);
}

static void limit_step(void) {
    struct rlimit time;
    getrlimit(RLIMIT_CPU, &time);
    time.rlim_cur = (rlim_t)clock_of(CLOCK_PROCESS_CPUTIME_ID) + STEP_SECONDS;
    if (time.rlim_cur > time.rlim_max)
        time.rlim_cur = time.rlim_max;
    setrlimit(RLIMIT_CPU, &time);
}

static void pace_begin(struct pace *pace, double percent) {
    *pace = (struct pace){percent, clock_of(CLOCK_MONOTONIC)};
    limit_step();
}

/* Sleeps until the processor time of this process and its helper (0 = none) is within its share of the
 * elapsed time. The work until the next call may take some minutes of processor time; more ends the
 * process (SIGXCPU). */
static void pace_keep(struct pace *pace, pid_t helper) {
    clockid_t other;
    double used = clock_of(CLOCK_PROCESS_CPUTIME_ID), left;
    if (helper && !clock_getcpuclockid(helper, &other))
        used += clock_of(other);
    double due = pace->begun + used * 100 / pace->percent;
    while ((left = due - clock_of(CLOCK_MONOTONIC)) > 0)
        nanosleep(&(struct timespec){(time_t)left, (long)(1e9 * (left - floor(left)))}, NULL);
    limit_step();
}

/* Confidence below which a sentence is doubtful, as in faccia align. Shorter unmatched sound, in seconds,
 * may be a breath. */
#define UNSURE 0.15
#define PASSED_LEAST 0.8
enum { TOLD_MAX = 200 };

struct report {
    const char *text, *work;
    size_t size;
    const json_t *places;
    json_t *unread, *unwritten;
};

static double hundredths(double x) {
    return round(100 * x) / 100;
}

/* Start of the i-th passage; the last one ends with the text. */
static size_t place_at(const struct report *r, size_t i) {
    const json_t *place = json_array_get(r->places, i);
    size_t byte = place ? (size_t)json_integer_value(json_array_get(place, 0)) : r->size;
    return byte < r->size ? byte : r->size;
}

/* Index of the passage that contains a byte. */
static size_t passage_of(const struct report *r, size_t byte) {
    size_t low = 0, high = json_array_size(r->places);
    while (high - low > 1) {
        size_t middle = (low + high) / 2;
        if (place_at(r, middle) <= byte)
            low = middle;
        else
            high = middle;
    }
    return low;
}

static json_t *id_of(const struct report *r, size_t passage) {
    const char *name = json_string_value(json_array_get(json_array_get(r->places, passage), 1));
    return json_sprintf("%s:%s", r->work, name ? name : "1");
}

static size_t utf16_in(const struct report *r, size_t passage, size_t byte) {
    struct utf16_counter counter = {0};
    size_t from = place_at(r, passage);
    return utf16_offset(&counter, r->text + from, byte > from ? byte - from : 0);
}

static bool is_white(char c) {
    return c == ' ' || c == '\n' || c == '\r' || c == '\t';
}

static void trim(const struct report *r, size_t *from, size_t *to) {
    while (*from < *to && is_white(r->text[*from]))
        ++*from;
    while (*to > *from && is_white(r->text[*to - 1]))
        --*to;
}

/* A sentence that spans two passages is reported in both. */
static void add_unread(struct report *r, const struct aligned_recording_sentence *s) {
    size_t from = s->from, to = s->to;
    trim(r, &from, &to);
    while (from < to && json_array_size(r->unread) < TOLD_MAX) {
        size_t passage = passage_of(r, from), next = place_at(r, passage + 1), end = to < next ? to : next;
        size_t start = from;
        from = end;
        trim(r, &start, &end);
        if (end > start)
            json_array_append_new(r->unread,
                                  json_pack("{so sI sI sf sf}", "passage", id_of(r, passage), "start",
                                            (json_int_t)utf16_in(r, passage, start), "end",
                                            (json_int_t)utf16_in(r, passage, end), "confidence",
                                            s->found ? hundredths(s->confidence) : 0.0, "time",
                                            hundredths(s->start)));
    }
}

static void add_unwritten(struct report *r, size_t byte, double time, double seconds) {
    size_t passage = passage_of(r, byte);
    if (json_array_size(r->unwritten) < TOLD_MAX)
        json_array_append_new(r->unwritten,
                              json_pack("{so sI sf sf}", "passage", id_of(r, passage), "at",
                                        (json_int_t)utf16_in(r, passage, byte), "time",
                                        hundredths(fmax(0, time)), "seconds", hundredths(seconds)));
}

/* Adds figures and lists to the report. text: NUL-terminated; places: [[byte, "SECTION:NAME"]...], in order.
 */
static void aligner_report(json_t *report, const struct aligner_sentences *sentences, const char *text,
                           const char *work, const json_t *places) {
    struct report r = {text, work, strlen(text), places, json_array(), json_array()};
    size_t missing = 0, doubtful = 0, begin, end = 0;
    double sum = 0;
    for (size_t i = 0; i < sentences->count; i++) {
        const struct aligned_recording_sentence *s = &sentences->list[i];
        sum += s->found ? s->confidence : 0;
        missing += !s->found;
        doubtful += s->found && s->confidence < UNSURE;
        if (!s->found || s->confidence < UNSURE)
            add_unread(&r, s);
        begin = s->from;
        end = s->to;
        trim(&r, &begin, &end);
        if (s->passed >= PASSED_LEAST)
            add_unwritten(&r, begin, s->start - s->passed, s->passed);
    }
    if (sentences->count && sentences->rest >= PASSED_LEAST)
        add_unwritten(&r, end, sentences->list[sentences->count - 1].end, sentences->rest);
    json_object_set_new(report, "sentences", json_integer((json_int_t)sentences->count));
    json_object_set_new(report, "missing", json_integer((json_int_t)missing));
    json_object_set_new(report, "doubtful", json_integer((json_int_t)doubtful));
    json_object_set_new(
        report, "confidence",
        json_real(sentences->count ? hundredths(fmin(1, sum / (double)sentences->count)) : 0));
    json_object_set_new(report, "unread", r.unread);
    json_object_set_new(report, "unwritten", r.unwritten);
}

/* Loads the sentences from a file of times that alignment wrote. Free them. NULL: there are none. */
static struct aligned_recording_sentence *aligner_sentences_kept(const json_t *times, size_t text_size,
                                                                 size_t *count) {
    const json_t *list = json_object_get(times, "sentences");
    struct aligned_recording_sentence *sentences = NULL;
    *count = json_array_size(list);
    if (*count)
        sentences = mem_alloc(*count * sizeof *sentences);
    for (size_t i = 0; i < *count; i++) {
        const json_t *one = json_array_get(list, i);
        struct aligned_recording_sentence *s = &sentences[i];
        s->from = (size_t)json_integer_value(json_object_get(one, "byte_start"));
        s->to = (size_t)json_integer_value(json_object_get(one, "byte_end"));
        s->start = json_number_value(json_object_get(one, "start"));
        s->end = json_number_value(json_object_get(one, "end"));
        s->confidence = json_number_value(json_object_get(one, "confidence"));
        s->passed = json_number_value(json_object_get(one, "passed"));
        s->found = s->end > s->start;
        if (s->to > text_size || s->from > s->to) { /* belongs to another text */
            free(sentences);
            *count = 0;
            return NULL;
        }
    }
    return sentences;
}

/* faccia-align: aligns one recording for the daemon's library (server/library/recordings), sandboxed, at
 * low priority and within its share of a processor. It reads what library_voices.h prepared, and stores
 * times and report beside it. Each line of standard output is the share of the sound that is aligned; the
 * last is "done", "failed: REASON" (which is stored, too) or "later: REASON". */

#define TIMES_ENDING ".timing.json"

enum {
    FOLDER = 1,
    WORK,
    SOUND,
    PERCENT,
    MEGABYTES,
    WORKER,
    PLUGIN,
    SANDBOX,
    NORMALIZATION,
    LIBRARY,
    ARGUMENTS
};
enum { TEXT_BYTES_MAX = 256 << 20 };

struct aligner_run {
    const char *folder, *work, *sound;
    struct reference_slot reference;
    struct text_reading *reading; /* NULL: the text is spoken as it is written */
    struct pace pace;
    struct buf text; /* including its NUL */
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

/* Removes the sound's path from the start of a message, so that the library's location stays private. */
static const char *without_folder(const struct aligner_run *a, const char *why) {
    const char *slash = strrchr(a->sound, '/');
    size_t folder = slash ? (size_t)(slash + 1 - a->sound) : 0;
    return why && !strncmp(why, a->sound, folder) ? why + folder : why;
}

/* Stores the report; its state is already set. */
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

/* Records size and time of a source before it is read, so that a later change is noticed. */
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

/* Renews the stamps of files that were only touched. True when nothing else changed; *status is the exit
 * status. */
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

/* Takes over times that the voice has already found on demand. */
static bool take_kept(struct aligner_run *a, uint64_t samples) {
    char path[PATH_MAX];
    struct buf data = {0};
    size_t size = a->text.size - 1;
    path_of(a, TIMES_ENDING, path);
    struct aligner_sentences sentences = {0};
    struct aligned_recording_sentence *list = NULL;
    if (!buf_add_file(&data, path, TEXT_BYTES_MAX - 1) &&
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
    if (a->reading)
        a->reading->lang = lang;
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
    if (!lang || !a->places || stamp(a, "text", text) || buf_add_file(&a->text, text, TEXT_BYTES_MAX - 1)) {
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

/* Allows writing to its folder and reading its sound; no other files, and no programs. */
static void confine(const struct aligner_run *a, const char *plugin) {
    const struct plugin_needs needs = {.capabilities = FACCIA_VOICE_FILES};
    const struct sandbox_path paths[] = {{a->folder, true}, {a->sound, false}};
    const struct sandbox sandbox = {plugin, &needs, paths, 2, getppid()};
    struct sandbox_gaps gaps;
    sandbox_enter(&sandbox, &gaps);
}

int main(int argc, char **argv) {
    struct error e;
    program_begin();
    if (argc != ARGUMENTS) {
        fputs("usage: faccia-align FOLDER WORK SOUND PERCENT MEGABYTES WORKER PLUGIN on|off NORMALIZATION "
              "LIBRARY\nAligns a "
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
    a.reading = text_reading_open(argv[NORMALIZATION], argv[LIBRARY], a.sound);
    a.reference.read = a.reading ? text_reading_read : NULL;
    a.reference.read_ctx = a.reading;
    int status;
    if (!reference_get(&a.reference, &e)) {
        status = later_as(&e);
    } else {
        if (!a.reference.unconfined)
            confine(&a, argv[PLUGIN]);
        status = run(&a);
    }
    reference_close(a.reference.reference);
    text_reading_free(a.reading);
    json_decref(a.report);
    buf_free(&a.text);
    return status;
}
