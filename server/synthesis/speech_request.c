/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/synthesis/speech_request.h"
#include "server/base/lang.h"
#include "server/base/mem.h"
#include "server/markup/language_runs.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

static const char *const blends[] = {[SPEAK_BLEND_AUTO] = "auto",
                                     [SPEAK_BLEND_REGIONS] = "regions",
                                     [SPEAK_BLEND_WEIGHTED] = "weighted",
                                     NULL};
static const char *const contacts[] = {
    [CONTACTS_ENGINE] = "engine", [CONTACTS_ON] = "on", [CONTACTS_OFF] = "off", NULL};
static const char *const normalize[] = {[NORMALIZE_ON] = "on", [NORMALIZE_OFF] = "off", NULL};
static const char *const genders[] = {
    [GENDER_ANY] = "any", [GENDER_FEMALE] = "female", [GENDER_MALE] = "male", NULL};
static const char *const modes[] = {[SPEAK_QUEUE] = "queue",
                                    [SPEAK_REPLACE] = "replace",
                                    [SPEAK_INTERRUPT] = "interrupt",
                                    [SPEAK_QUIET] = "quiet",
                                    NULL};
static const char *const priorities[] = {
    [PRIORITY_BACKGROUND] = "background", [PRIORITY_CHAT] = "chat", [PRIORITY_ALARM] = "alarm", NULL};

/* The fields that anyone may set, with the limits that protocol/README.md states. */
static const struct field {
    const char *name;
    enum { TEXT, STRING, TAG, NUMBER, INTEGER, FLAG, CHOICE } type;
    size_t offset;
    double min, max;          /* of a number; of a string: max = its longest, in bytes */
    const char *const *words; /* of a choice: in the order of its enum, NULL-terminated */
} fields[] = {
    {"text", TEXT, offsetof(struct speech_request, text), 0, 0, NULL},
    {"passage", STRING, offsetof(struct speech_request, passage), 1, 128, NULL},
    {"from", INTEGER, offsetof(struct speech_request, from), 0, 100 << 20, NULL},
    {"languages", STRING, offsetof(struct speech_request, languages), 1, LANGUAGE_RUNS_BYTES_MAX, NULL},
    {"id", STRING, offsetof(struct speech_request, id), 0, 64, NULL},
    {"lang", TAG, offsetof(struct speech_request, lang), 1, 35, NULL},
    {"voice", STRING, offsetof(struct speech_request, voice), 1, 128, NULL},
    {"gender", CHOICE, offsetof(struct speech_request, gender), 0, 0, genders},
    {"engine", STRING, offsetof(struct speech_request, engine), 1, 64, NULL},
    {"markup", STRING, offsetof(struct speech_request, markup), 1, 64, NULL},
    {"rate", NUMBER, offsetof(struct speech_request, rate), REQUEST_RATE_MIN, REQUEST_RATE_MAX, NULL},
    {"pitch", NUMBER, offsetof(struct speech_request, pitch), 0.25, 4, NULL},
    {"volume", NUMBER, offsetof(struct speech_request, volume), 0.25, 4, NULL},
    {"fps", NUMBER, offsetof(struct speech_request, fps), 1, 120, NULL},
    {"seed", INTEGER, offsetof(struct speech_request, seed), 0, 9007199254740991.0, NULL},
    {"life", NUMBER, offsetof(struct speech_request, life), 0, 2, NULL},
    {"blend", CHOICE, offsetof(struct speech_request, blend), 0, 0, blends},
    {"contacts", CHOICE, offsetof(struct speech_request, contacts), 0, 0, contacts},
    {"normalize", CHOICE, offsetof(struct speech_request, normalize), 0, 0, normalize},
    {"mode", CHOICE, offsetof(struct speech_request, mode), 0, 0, modes},
    {"priority", CHOICE, offsetof(struct speech_request, priority), 0, 0, priorities},
    {"topic", STRING, offsetof(struct speech_request, topic), 1, 64, NULL},
    {"open", FLAG, offsetof(struct speech_request, open), 0, 1, NULL},
    {"again", FLAG, offsetof(struct speech_request, again), 0, 1, NULL},
    {"phones", FLAG, offsetof(struct speech_request, phones), 0, 1, NULL},
    {"still", FLAG, offsetof(struct speech_request, still), 0, 1, NULL},
};

static bool is_string(const struct field *f) {
    return f->type == STRING || f->type == TAG;
}

void request_init(struct speech_request *request) {
    *request = (struct speech_request){
        .pitch = 1, .volume = 1, .fps = 25, .seed = -1, .life = -1, .priority = PRIORITY_CHAT};
}

void request_free(struct speech_request *request) {
    for (size_t i = 0; i < sizeof fields / sizeof *fields; i++)
        if (fields[i].type == TEXT || is_string(&fields[i]))
            free(*(char **)((char *)request + fields[i].offset));
    *request = (struct speech_request){0};
}

void request_copy(struct speech_request *to, const struct speech_request *from) {
    *to = *from;
    for (size_t i = 0; i < sizeof fields / sizeof *fields; i++) {
        char **string = (char **)((char *)to + fields[i].offset);
        if (is_string(&fields[i]) && *string)
            *string = mem_strdup(*string);
    }
    if (from->text) {
        to->text = mem_alloc(from->text_size + 1);
        memcpy(to->text, from->text, from->text_size);
    }
}

static int set_string(char **string, const struct field *f, const struct request_value *v, struct error *e) {
    if (v->type != REQUEST_STRING && v->type != REQUEST_WORD)
        return error_in_field(e, ERROR_BAD_FIELD, f->name, "must be a string");
    size_t bad, size = v->size;
    char tag[LANG_BYTES + 1];
    const char *value = v->string;
    if (is_string(f) &&
        ((double)v->size < f->min || (double)v->size > f->max || memchr(v->string, 0, v->size)))
        return error_in_field(e, ERROR_BAD_FIELD, f->name, "must have %.0f to %.0f bytes", f->min, f->max);
    if (f->type == TAG) {
        if (!lang_read(value, size, tag, &bad))
            return error_in_field(
                e, ERROR_BAD_FIELD, f->name,
                "is no language tag (BCP 47, such as pt-BR): byte %zu does not belong there", bad);
        value = tag;
        size = strlen(tag);
    }
    free(*string);
    *string = mem_alloc(size + 1);
    memcpy(*string, value, size);
    return 0;
}

static int set_number(double *number, const struct field *f, const struct request_value *v, struct error *e) {
    double value = v->number;
    if (v->type == REQUEST_WORD) {
        char *end;
        value = strtod(v->string, &end);
        if (end == v->string || *end)
            value = NAN;
    } else if (v->type != REQUEST_NUMBER) {
        value = NAN;
    }
    if (f->type == INTEGER && value != floor(value))
        return error_in_field(e, ERROR_BAD_FIELD, f->name, "must be an integer");
    if (!(value >= f->min && value <= f->max))
        return error_in_field(e, ERROR_BAD_FIELD, f->name, "must be a number from %g to %.16g", f->min,
                              f->max);
    *number = value;
    return 0;
}

static int set_flag(bool *flag, const struct field *f, const struct request_value *v, struct error *e) {
    static const char *const words[2][4] = {{"0", "false", "no", "off"}, {"1", "true", "yes", "on"}};
    if (v->type == REQUEST_BOOL) {
        *flag = v->number != 0;
        return 0;
    }
    for (int i = 0; v->type == REQUEST_WORD && i < 8; i++)
        if (!strcasecmp(v->string, words[i / 4][i % 4])) {
            *flag = i / 4;
            return 0;
        }
    return error_in_field(e, ERROR_BAD_FIELD, f->name, "must be true or false");
}

/* An enum without negative members is an unsigned int to GCC and Clang. */
_Static_assert(sizeof(enum speech_blend) == sizeof(unsigned) &&
                   sizeof(enum speech_mode) == sizeof(unsigned) &&
                   sizeof(enum speech_priority) == sizeof(unsigned) &&
                   sizeof(enum face_contacts) == sizeof(unsigned) &&
                   sizeof(enum speech_normalize) == sizeof(unsigned) &&
                   sizeof(enum voice_gender) == sizeof(unsigned),
               "choices are set as unsigned");

static int set_choice(unsigned *choice, const struct field *f, const struct request_value *v,
                      struct error *e) {
    char all[64] = "";
    bool word = v->type == REQUEST_STRING || v->type == REQUEST_WORD;
    for (int i = 0; f->words[i]; i++) {
        if (word && strlen(f->words[i]) == v->size && !memcmp(f->words[i], v->string, v->size)) {
            *choice = (unsigned)i;
            return 0;
        }
        snprintf(all + strlen(all), sizeof all - strlen(all), "%s%s", i ? ", " : "", f->words[i]);
    }
    return error_in_field(e, ERROR_BAD_FIELD, f->name, "must be one of %s", all);
}

const char *request_gender(const struct speech_request *request) {
    return request->gender == GENDER_ANY ? NULL : genders[request->gender];
}

const char *request_field(size_t i) {
    return i < sizeof fields / sizeof *fields ? fields[i].name : NULL;
}

/* A number that is not given is outside its range. */
bool request_get(const struct speech_request *request, size_t i, struct request_value *value) {
    const struct field *f = &fields[i];
    const void *member = (const char *)request + f->offset;
    double number = f->type == NUMBER || f->type == INTEGER ? *(const double *)member : 0;
    const char *string = f->type == TEXT || is_string(f) ? *(char *const *)member
                         : f->type == CHOICE             ? f->words[*(const unsigned *)member]
                                                         : NULL;
    switch (f->type) {
    case NUMBER:
    case INTEGER:
        *value = (struct request_value){REQUEST_NUMBER, NULL, 0, number};
        return number >= f->min && number <= f->max;
    case FLAG:
        *value = (struct request_value){REQUEST_BOOL, NULL, 0, *(const bool *)member};
        return true;
    default:
        *value = (struct request_value){REQUEST_STRING, string,
                                        f->type == TEXT ? request->text_size
                                        : string        ? strlen(string)
                                                        : 0,
                                        0};
        return string != NULL;
    }
}

int request_set(struct speech_request *request, const char *name, struct request_value value,
                struct error *e) {
    for (size_t i = 0; i < sizeof fields / sizeof *fields; i++) {
        const struct field *f = &fields[i];
        void *member = (char *)request + f->offset;
        if (strcmp(f->name, name))
            continue;
        switch (f->type) {
        case TEXT:
            if (set_string(member, f, &value, e))
                return -1;
            request->text_size = value.size;
            return 0;
        case STRING:
        case TAG:
            return set_string(member, f, &value, e);
        case NUMBER:
        case INTEGER:
            return set_number(member, f, &value, e);
        case FLAG:
            return set_flag(member, f, &value, e);
        case CHOICE:
            return set_choice(member, f, &value, e);
        }
    }
    return 1;
}
