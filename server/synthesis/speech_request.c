/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/synthesis/speech_request.h"
#include "server/base/mem.h"
#include <stdlib.h>
#include <string.h>

#include "protocol/speak_fields.h" /* generated from protocol/messages.json */

/* Member types of the field types. */
typedef char *field_of_TEXT, *field_of_STRING, *field_of_TAG;
typedef double field_of_NUMBER, field_of_INTEGER;
typedef bool field_of_FLAG;
typedef unsigned field_of_CHOICE; /* GCC and Clang: an enum without negative members */

/* Offset of the member with the field's name. Does not compile if the member has another type. */
#define MEMBER(name, type)                                                                                   \
    _Generic(((struct speech_request *)0)->name, type : offsetof(struct speech_request, name))
#define ROW(name, type, least, most, words)                                                                  \
    {{#name, FIELD_##type, least, most, words, false}, MEMBER(name, field_of_##type)},

/* The fields that clients may set. */
static const struct {
    struct field field;
    size_t offset;
} rows[] = {SPEAK_FIELDS(ROW)};

enum { ROWS = sizeof rows / sizeof *rows };

static void *member_of(const struct speech_request *request, size_t i) {
    return (char *)request + rows[i].offset;
}

void request_init(struct speech_request *request) {
    *request = (struct speech_request){SPEAK_INITIAL};
}

void request_free(struct speech_request *request) {
    for (size_t i = 0; i < ROWS; i++)
        if (field_is_string(&rows[i].field))
            free(*(char **)member_of(request, i));
    *request = (struct speech_request){0};
}

void request_copy(struct speech_request *to, const struct speech_request *from) {
    *to = *from;
    to->around = NULL;
    for (size_t i = 0; i < ROWS; i++) {
        char **string = member_of(to, i);
        if (field_is_string(&rows[i].field) && rows[i].field.type != FIELD_TEXT && *string)
            *string = mem_strdup(*string);
    }
    if (from->text) {
        to->text = mem_alloc(from->text_size + 1);
        memcpy(to->text, from->text, from->text_size);
    }
}

const char *request_gender(const struct speech_request *request) {
    return request->gender == GENDER_ANY ? NULL : speak_gender_words[request->gender];
}

const char *request_field(size_t i) {
    return i < ROWS ? rows[i].field.name : NULL;
}

/* A number that is not given is outside its range. */
bool request_get(const struct speech_request *request, size_t i, struct request_value *value) {
    const struct field *f = &rows[i].field;
    const void *member = member_of(request, i);
    double number;
    const char *string;
    switch (f->type) {
    case FIELD_NUMBER:
    case FIELD_INTEGER:
        number = *(const double *)member;
        *value = (struct request_value){REQUEST_NUMBER, NULL, 0, number};
        return number >= f->least && number <= f->most;
    case FIELD_FLAG:
        *value = (struct request_value){REQUEST_BOOL, NULL, 0, *(const bool *)member};
        return true;
    default:
        string = f->type == FIELD_CHOICE ? f->words[*(const unsigned *)member] : *(char *const *)member;
        *value = (struct request_value){REQUEST_STRING, string,
                                        f->type == FIELD_TEXT ? request->text_size
                                        : string              ? strlen(string)
                                                              : 0,
                                        0};
        return string != NULL;
    }
}

int request_set(struct speech_request *request, const char *name, struct request_value value,
                struct error *e) {
    for (size_t i = 0; i < ROWS; i++) {
        if (strcmp(rows[i].field.name, name))
            continue;
        if (field_set(&rows[i].field, member_of(request, i), &value, e))
            return -1;
        if (rows[i].field.type == FIELD_TEXT)
            request->text_size = value.size;
        return 0;
    }
    return 1;
}
