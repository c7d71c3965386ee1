/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/research/fit_read.h"
#include "server/base/buf.h"
#include "server/base/mem.h"
#include "server/base/sampa.h"
#include "server/library/align/times.h"
#include "server/research/measured_speech.h"
#include <ctype.h>
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* Accepted headings of the phone's name. */
static const char *const phone_columns[] = {"start", "end",     "ipa",   "phone", "label",
                                            "name",  "arpabet", "sampa", NULL};
enum { START, END, NAME, NAMES_END = 8 };
/* Markers in mm follow the parameters: _x forward, _z up. The rear tongue marker represents the tongue
 * body best (with two speakers the packs' TB correlates by .75 with tr and by .54 with tb). */
static const char *const curve_columns[] = {"time",
                                            "t",
                                            "LI",
                                            "LS",
                                            "AR",
                                            "PI",
                                            "PS",
                                            "EM",
                                            "TH",
                                            "TA",
                                            "TB",
                                            "ll_z",
                                            "ul_z",
                                            "ll_x",
                                            "ul_x",
                                            "jaw_z",
                                            "tt_z",
                                            "tt_x",
                                            "tb_z",
                                            "tr_z",
                                            "confidence",
                                            "LI_confidence",
                                            "LS_confidence",
                                            "AR_confidence",
                                            "PI_confidence",
                                            "PS_confidence",
                                            "EM_confidence",
                                            "TH_confidence",
                                            "TA_confidence",
                                            "TB_confidence",
                                            NULL};
enum { TIME, T, PARAMETERS, MARKERS = PARAMETERS + PARAM_COUNT };
static const struct {
    enum speech_param param;
    double sign;
} markers[] = {{PARAM_LI, -1}, {PARAM_LS, 1}, {PARAM_PI, 1}, {PARAM_PS, 1}, {PARAM_EM, -1},
               {PARAM_TH, 1},  {PARAM_TA, 1}, {PARAM_TB, 1}, {PARAM_TB, 1}};
enum {
    MARKER_COUNT = sizeof markers / sizeof *markers,
    CONFIDENCE = MARKERS + MARKER_COUNT, /* of the frame; those of the parameters follow */
    MAX_WANTED = 32,
    NO_COLUMN = 1 << 20
};
/* Values with less confidence count as missing. */
#define LEAST_CONFIDENCE 0.25
_Static_assert(sizeof curve_columns / sizeof *curve_columns == CONFIDENCE + 1 + PARAM_COUNT + 1,
               "the columns are the time, the parameters, the markers and their confidence");
_Static_assert(CONFIDENCE + 1 + PARAM_COUNT < MAX_WANTED, "a line has room for all columns");

/* A CSV table, read line by line. */
struct table {
    FILE *file;
    const char *const *wanted;
    size_t column[MAX_WANTED]; /* by wanted name; NO_COLUMN if absent */
    char *line;
    size_t capacity, number;
    const char *field[MAX_WANTED]; /* of the current line; "" if absent */
    struct error *error;
};

/* Unquotes "A" with "" for a quote. A single leading quote is X-SAMPA's stress mark. */
static void unquote(char **field) {
    size_t length = strlen(*field);
    if (length < 2 || **field != '"' || (*field)[length - 1] != '"')
        return;
    (*field)[length - 1] = '\0';
    char *to = ++*field;
    for (const char *from = to; (*to++ = *from); from++)
        from += from[0] == '"' && from[1] == '"';
}

/* Splits off the first field, without surrounding blanks and quotes. */
static char *next_field(char **rest) {
    char *field = *rest, *end = field + strcspn(field, ",;\t\r\n");
    *rest = *end && strchr(",;\t", *end) ? end + 1 : NULL;
    while (end > field && end[-1] == ' ')
        end--;
    *end = '\0';
    field += strspn(field, " ");
    unquote(&field);
    return field;
}

/* Reads the next line that is not empty. */
static bool next_line(struct table *t) {
    while (getline(&t->line, &t->capacity, t->file) >= 0) {
        t->number++;
        if (t->line[strspn(t->line, " \r\n")])
            return true;
    }
    return false;
}

static int table_open(struct table *t, const char *path, const char *const *wanted, struct error *e) {
    *t = (struct table){.file = fopen(path, "r"), .wanted = wanted, .error = e};
    if (!t->file)
        return error_set(e, ERROR_BAD_CURVES, "%s", strerror(errno));
    for (size_t i = 0; wanted[i]; i++)
        t->column[i] = NO_COLUMN;
    if (!next_line(t))
        return error_set(e, ERROR_BAD_CURVES, "is empty");
    char *rest = t->line + (!strncmp(t->line, "\xef\xbb\xbf", 3) ? 3 : 0);
    for (size_t n = 0; rest; n++) {
        const char *name = next_field(&rest);
        for (size_t i = 0; wanted[i]; i++)
            if (!strcmp(name, wanted[i]))
                t->column[i] = n;
    }
    return 0;
}

static void table_close(struct table *t) {
    if (t->file)
        fclose(t->file);
    free(t->line);
}

static bool table_next(struct table *t) {
    if (!next_line(t))
        return false;
    for (size_t i = 0; t->wanted[i]; i++)
        t->field[i] = "";
    char *rest = t->line;
    for (size_t n = 0; rest; n++) {
        const char *field = next_field(&rest);
        for (size_t i = 0; t->wanted[i]; i++)
            if (t->column[i] == n)
                t->field[i] = field;
    }
    return true;
}

static int table_real(struct table *t, size_t wanted, double *out) {
    char *end;
    *out = strtod(t->field[wanted], &end);
    if (end == t->field[wanted] || *end || !isfinite(*out))
        return error_at_line(t->error, ERROR_BAD_CURVES, t->number, 1, "%s: '%.40s' is not a number",
                             t->wanted[wanted], t->field[wanted]);
    return 0;
}

static int needs(struct table *t, size_t wanted) {
    return t->column[wanted] == NO_COLUMN ? error_at_line(t->error, ERROR_BAD_CURVES, t->number, 1,
                                                          "there is no column '%s'", t->wanted[wanted])
                                          : 0;
}

/* Finds the column of each parameter: its own, or its marker's. */
static size_t find_sources(const struct table *t, size_t source[PARAM_COUNT], double sign[PARAM_COUNT]) {
    size_t found = 0;
    for (size_t p = 0; p < PARAM_COUNT; p++) {
        source[p] = PARAMETERS + p;
        sign[p] = 1;
    }
    for (size_t m = 0; m < MARKER_COUNT; m++)
        if (t->column[PARAMETERS + markers[m].param] == NO_COLUMN && t->column[MARKERS + m] != NO_COLUMN) {
            source[markers[m].param] = MARKERS + m;
            sign[markers[m].param] = markers[m].sign;
        }
    for (size_t p = 0; p < PARAM_COUNT; p++)
        found += t->column[source[p]] != NO_COLUMN;
    return found;
}

/* Finds each parameter's confidence column: its own, or the frame's. */
static void find_confidences(const struct table *t, size_t of[PARAM_COUNT]) {
    for (size_t p = 0; p < PARAM_COUNT; p++)
        of[p] = t->column[CONFIDENCE + 1 + p] != NO_COLUMN ? CONFIDENCE + 1 + p : CONFIDENCE;
}

/* Reads the confidences of frame n. */
static int read_confidences(struct table *t, struct measured_speech *r, const size_t of[PARAM_COUNT],
                            size_t n) {
    for (size_t p = 0; p < PARAM_COUNT; p++) {
        double confidence;
        if (!r->unseen[p])
            continue;
        if (table_real(t, of[p], &confidence))
            return -1;
        r->unseen[p][n] = confidence < LEAST_CONFIDENCE;
    }
    return 0;
}

static int read_frames(struct table *t, struct measured_speech *r) {
    size_t capacity = 0, sure[PARAM_COUNT], source[PARAM_COUNT],
           time = t->column[TIME] == NO_COLUMN ? T : TIME;
    double sign[PARAM_COUNT];
    if (needs(t, time))
        return -1;
    if (!find_sources(t, source, sign))
        return error_at_line(
            t->error, ERROR_BAD_CURVES, t->number, 1,
            "no column is named LI, LS, AR, PI, PS, EM, TH, TA, TB or like a marker (ll_z, ul_z, "
            "ll_x, ul_x, jaw_z, tt_z, tt_x, tb_z, tr_z)");
    find_confidences(t, sure);
    while (table_next(t)) {
        size_t n = r->frame_count;
        if (n == capacity) {
            capacity = 2 * capacity + 256;
            r->times = mem_resize(r->times, capacity * sizeof(double));
            for (int p = 0; p < PARAM_COUNT; p++)
                if (t->column[source[p]] != NO_COLUMN) {
                    r->curves[p] = mem_resize(r->curves[p], capacity * sizeof(double));
                    if (t->column[sure[p]] != NO_COLUMN)
                        r->unseen[p] = mem_resize(r->unseen[p], capacity * sizeof(bool));
                }
        }
        if (table_real(t, time, &r->times[n]))
            return -1;
        if (n && !(r->times[n] > r->times[n - 1]))
            return error_at_line(t->error, ERROR_BAD_CURVES, t->number, 1, "time: must increase");
        for (int p = 0; p < PARAM_COUNT; p++) {
            if (!r->curves[p])
                continue;
            if (table_real(t, source[p], &r->curves[p][n]))
                return -1;
            r->curves[p][n] *= sign[p];
        }
        if (read_confidences(t, r, sure, n))
            return -1;
        r->frame_count++;
    }
    return r->frame_count ? 0
                          : error_at_line(t->error, ERROR_BAD_CURVES, t->number, 1, "there are no frames");
}

int fit_read_curves(const char *path, struct measured_speech *r, struct error *e) {
    struct table t;
    int result = table_open(&t, path, curve_columns, e) || read_frames(&t, r) ? -1 : 0;
    r->repetitions = 1;
    table_close(&t);
    return result;
}

static int read_phone_table(struct table *t, struct measured_speech *r) {
    size_t name = NAME;
    while (name + 1 < NAMES_END && t->column[name] == NO_COLUMN)
        name++;
    if (needs(t, START) || needs(t, END) || (t->column[name] == NO_COLUMN && needs(t, NAME)))
        return -1;
    while (table_next(t)) {
        struct recorded_phone phone = {0};
        struct error inner;
        if (table_real(t, START, &phone.start) || table_real(t, END, &phone.end))
            return -1;
        if (strlen(t->field[name]) >= sizeof phone.ipa)
            return error_at_line(t->error, ERROR_BAD_CURVES, t->number, 1, "'%.40s' is too long for a phone",
                                 t->field[name]);
        snprintf(phone.ipa, sizeof phone.ipa, "%s", t->field[name]);
        if (measured_speech_add(r, &phone, &inner))
            return error_at_line(t->error, ERROR_BAD_CURVES, t->number, 1, "%s", inner.message);
    }
    return 0;
}

/* CSV with a heading: "start", "end" (s) and the name as "ipa", "phone", "label", "name", "arpabet" or
 * "sampa". Errors as above. */
static int fit_read_phones(const char *path, struct measured_speech *r, struct error *e) {
    struct table t;
    int result = table_open(&t, path, phone_columns, e) || read_phone_table(&t, r) ? -1 : 0;
    table_close(&t);
    return result;
}

static bool is_pause(const char *name) {
    return !*name || !strcmp(name, "_") || !strcmp(name, "sil") || !strcmp(name, "sp");
}

static bool is_arpabet(const struct measured_speech *r) {
    bool telling = false;
    for (size_t i = 0; i < r->phone_count; i++) {
        uint8_t stress;
        const char *name = r->phones[i].ipa;
        if (is_pause(name))
            continue;
        if (!arpabet_ipa(name, &stress))
            return false;
        telling |= arpabet_is_telling(name);
    }
    return telling;
}

/* True for X-SAMPA: ASCII with capitals, digits or signs that IPA lacks. */
static bool is_sampa(const struct measured_speech *r) {
    bool telling = false;
    for (size_t i = 0; i < r->phone_count; i++)
        for (const char *c = is_pause(r->phones[i].ipa) ? "" : r->phones[i].ipa; *c; c++) {
            if (*c & 0x80)
                return false;
            telling |= isupper((unsigned char)*c) || strchr("@{}0123456789\\&?=~", *c);
        }
    return telling;
}

/* Removes a stress mark from the start of the name. */
static void take_stress(struct recorded_phone *phone) {
    static const char *const marks[] = {"ˌ", "ˈ"};
    for (uint8_t i = 0; i < 2; i++)
        if (!strncmp(phone->ipa, marks[i], strlen(marks[i]))) {
            phone->stress = i + 1;
            memmove(phone->ipa, phone->ipa + strlen(marks[i]), strlen(phone->ipa + strlen(marks[i])) + 1);
        }
}

static void to_ipa(struct measured_speech *r) {
    bool arpabet = is_arpabet(r), sampa = !arpabet && is_sampa(r);
    for (size_t i = 0; i < r->phone_count; i++) {
        struct recorded_phone *phone = &r->phones[i];
        char name[PHONE_NAME_BYTES];
        snprintf(name, sizeof name, "%s", is_pause(phone->ipa) ? "" : phone->ipa);
        snprintf(phone->ipa, sizeof phone->ipa, "%s", name);
        if (!*name)
            continue;
        if (arpabet) {
            snprintf(phone->ipa, sizeof phone->ipa, "%s", arpabet_ipa(name, &phone->stress));
        } else if (sampa) {
            bool marked = *name == '"' || *name == '%';
            if (marked)
                phone->stress = *name == '"' ? 2 : 1;
            sampa_to_ipa(name + marked, phone->ipa, sizeof phone->ipa);
        }
        take_stress(phone);
    }
}

static int read_file(const char *path, struct buf *out, struct error *e) {
    FILE *file = fopen(path, "rb");
    char block[65536];
    size_t n;
    if (!file)
        return error_set(e, ERROR_BAD_CURVES, "%s", strerror(errno));
    while ((n = fread(block, 1, sizeof block, file)) > 0 && out->size < 100 << 20)
        buf_add(out, block, n);
    int result = ferror(file) ? error_set(e, ERROR_BAD_CURVES, "%s", strerror(errno)) : 0;
    fclose(file);
    return result;
}

static int read_times(const struct buf *text, struct measured_speech *r, struct error *e) {
    const struct times_options options = {.format = TIMES_GUESS};
    struct times times;
    int result = times_read(&times, &options, (const char *)text->data, text->size, e);
    for (size_t i = 0; !result && i < times.phone_count; i++) {
        const struct times_phone *from = &times.phones[i];
        struct recorded_phone phone = {.start = from->start, .end = from->end, .stress = from->stress};
        if (strlen(from->ipa) >= sizeof phone.ipa) {
            result = error_set(e, ERROR_BAD_CURVES, "'%.31s' is too long for a phone", from->ipa);
            break;
        }
        memcpy(phone.ipa, from->ipa, strlen(from->ipa) + 1);
        result = measured_speech_add(r, &phone, e);
    }
    if (result)
        e->code = ERROR_BAD_CURVES;
    times_free(&times);
    return result;
}

/* True when the first line names start and end, with a separator between them. */
static bool is_table(const struct buf *text) {
    size_t length = 0;
    char line[256];
    while (length < text->size && length + 1 < sizeof line && text->data[length] != '\n')
        length++;
    memcpy(line, text->data, length);
    line[length] = '\0';
    return line[strspn(line, " \t\r")] != '{' && strstr(line, "start") && strstr(line, "end") &&
           strpbrk(line, ",;\t");
}

int phone_times_read(const char *path, struct measured_speech *r, struct error *e) {
    struct buf text = {0};
    int result = read_file(path, &text, e);
    if (!result)
        result = text.size && is_table(&text) ? fit_read_phones(path, r, e) : read_times(&text, r, e);
    buf_free(&text);
    if (!result)
        to_ipa(r);
    return result;
}

/* Replaces the last `length` bytes of the path by the suffix. */
static char *renamed(const char *path, size_t length, const char *suffix) {
    size_t kept = strlen(path) - length, size = kept + strlen(suffix) + 1;
    char *out = mem_alloc(size);
    snprintf(out, size, "%.*s%s", (int)kept, path, suffix);
    return out;
}

static bool ends_with(const char *text, const char *end) {
    size_t length = strlen(text), tail = strlen(end);
    return length > tail && !strcmp(text + length - tail, end);
}

bool recording_is_phones(const char *path) {
    return ends_with(path, ".phones.csv");
}

int recording_read(const char *path, const struct speech_rest *rest, struct measured_speech *r, char **at,
                   struct error *e) {
    static const char *const endings[] = {".phones.csv", ".TextGrid", ".json", ".lab", ".mlf", NULL};
    char *phones = NULL;
    *at = mem_strdup(path);
    if (!ends_with(path, ".csv"))
        return error_set(e, ERROR_BAD_CURVES, "not a .csv file");
    if (fit_read_curves(path, r, e))
        return -1;
    for (size_t i = 0; endings[i] && (!phones || access(phones, F_OK)); i++) {
        free(phones);
        phones = renamed(path, strlen(".csv"), endings[i]);
    }
    if (access(phones, F_OK)) { /* the message names the first candidate */
        free(phones);
        phones = renamed(path, strlen(".csv"), endings[0]);
    }
    int result = phone_times_read(phones, r, e);
    if (result) {
        free(*at);
        *at = mem_strdup(phones);
    } else {
        result = rest ? measured_speech_subtract_rest(r, rest, e) : measured_speech_check(r, e);
    }
    free(phones);
    return result;
}
