/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/stream/request.h"
#include "server/base/mem.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

/* The fields that anyone may set, with the limits that protocol/README.md states. */
static const struct field {
    const char *name;
    enum { TEXT, STRING, NUMBER, INTEGER, FLAG, BLEND } type;
    size_t offset;
    double min, max; /* of a number; of a string: max = its longest, in bytes */
} fields[] = {
    {"text", TEXT, offsetof(struct speech_request, text), 0, 0},
    {"id", STRING, offsetof(struct speech_request, id), 0, 64},
    {"lang", STRING, offsetof(struct speech_request, lang), 1, 35},
    {"voice", STRING, offsetof(struct speech_request, voice), 1, 128},
    {"engine", STRING, offsetof(struct speech_request, engine), 1, 64},
    {"markup", STRING, offsetof(struct speech_request, markup), 1, 64},
    {"rate", NUMBER, offsetof(struct speech_request, rate), 40, 500},
    {"pitch", NUMBER, offsetof(struct speech_request, pitch), 0.25, 4},
    {"volume", NUMBER, offsetof(struct speech_request, volume), 0.25, 4},
    {"fps", NUMBER, offsetof(struct speech_request, fps), 1, 120},
    {"seed", INTEGER, offsetof(struct speech_request, seed), 0, 9007199254740992.0},
    {"life", NUMBER, offsetof(struct speech_request, life), 0, 2},
    {"blend", BLEND, offsetof(struct speech_request, blend), 0, 0},
    {"still", FLAG, offsetof(struct speech_request, still), 0, 1},
};

void request_init(struct speech_request *request) {
    *request = (struct speech_request){.pitch = 1, .volume = 1, .fps = 25, .seed = -1, .life = -1};
}

void request_free(struct speech_request *request) {
    for (size_t i = 0; i < sizeof fields / sizeof *fields; i++)
        if (fields[i].type == TEXT || fields[i].type == STRING)
            free(*(char **)((char *)request + fields[i].offset));
    *request = (struct speech_request){0};
}

void request_copy(struct speech_request *to, const struct speech_request *from) {
    *to = *from;
    for (size_t i = 0; i < sizeof fields / sizeof *fields; i++) {
        char **string = (char **)((char *)to + fields[i].offset);
        if (fields[i].type == STRING && *string)
            *string = mem_strdup(*string);
    }
    if (from->text) {
        to->text = mem_alloc(from->text_size + 1);
        memcpy(to->text, from->text, from->text_size);
    }
}

static int set_string(char **string, const struct field *f, const struct request_value *v, struct error *e) {
    if (v->type != REQUEST_STRING && v->type != REQUEST_WORD)
        return error_in_field(e, "bad-field", f->name, "must be a string");
    if (f->type == STRING &&
        ((double)v->size < f->min || (double)v->size > f->max || memchr(v->string, 0, v->size)))
        return error_in_field(e, "bad-field", f->name, "must have %.0f to %.0f bytes", f->min, f->max);
    free(*string);
    *string = mem_alloc(v->size + 1);
    memcpy(*string, v->string, v->size);
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
        return error_in_field(e, "bad-field", f->name, "must be an integer");
    if (!(value >= f->min && value <= f->max))
        return error_in_field(e, "bad-field", f->name, "must be a number from %g to %.16g", f->min, f->max);
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
    return error_in_field(e, "bad-field", f->name, "must be true or false");
}

static int set_blend(enum face_blend *blend, const struct field *f, const struct request_value *v,
                     struct error *e) {
    static const char *const words[] = {[BLEND_REGIONS] = "regions", [BLEND_WEIGHTED] = "weighted"};
    bool word = v->type == REQUEST_STRING || v->type == REQUEST_WORD;
    for (int i = 0; word && i < 2; i++)
        if (strlen(words[i]) == v->size && !memcmp(words[i], v->string, v->size)) {
            *blend = (enum face_blend)i;
            return 0;
        }
    return error_in_field(e, "bad-field", f->name, "must be regions or weighted");
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
            return set_string(member, f, &value, e);
        case NUMBER:
        case INTEGER:
            return set_number(member, f, &value, e);
        case FLAG:
            return set_flag(member, f, &value, e);
        case BLEND:
            return set_blend(member, f, &value, e);
        }
    }
    return 1;
}
