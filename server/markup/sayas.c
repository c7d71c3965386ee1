/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/markup/sayas.h"
#include <stdio.h>
#include <string.h>
#include <strings.h>

static const char dates[] = " dmy mdy ymd ydm my ym md dm d m y ", times[] = " hms hm h hms12 hms24 ";

/* Name in a markup, canonical name, allowed formats. */
static const struct {
    const char *from, *to, *formats;
} forms[] = {
    {"characters", "characters", NULL},
    {"character", "characters", NULL},
    {"letters", "characters", NULL},
    {"spell", "characters", NULL},
    {"spell-out", "characters", NULL},
    {"verbatim", "characters", NULL},
    {"literal", "characters", NULL},
    {"acronym", "characters", NULL},
    {"digits", "digits", NULL},
    {"digit", "digits", NULL},
    {"number:digits", "digits", NULL},
    {"vxml:digits", "digits", NULL},
    {"number", "cardinal", NULL},
    {"number:cardinal", "cardinal", NULL},
    {"cardinal", "cardinal", NULL},
    {"vxml:number", "cardinal", NULL},
    {"number:ordinal", "ordinal", NULL},
    {"ordinal", "ordinal", NULL},
    {"fraction", "fraction", NULL},
    {"date", "date", dates},
    {"vxml:date", "date", dates},
    {"time", "time", times},
    {"vxml:time", "time", times},
    {"duration", "duration", NULL},
    {"telephone", "telephone", NULL},
    {"phone", "telephone", NULL},
    {"number:telephone", "telephone", NULL},
    {"vxml:phone", "telephone", NULL},
    {"currency", "currency", NULL},
    {"vxml:currency", "currency", NULL},
    {"measure", "measure", NULL},
    {"unit", "measure", NULL},
    {"name", "name", NULL},
    {"address", "address", NULL},
    {"net:email", "net:email", NULL},
    {"email", "net:email", NULL},
    {"net:url", "net:url", NULL},
    {"net:uri", "net:url", NULL},
    {"net", "net:url", NULL},
    {"url", "net:url", NULL},
    {"uri", "net:url", NULL},
};

static bool listed(const char *list, const char *word, size_t length) {
    for (const char *at = list; at && *at; at += strcspn(at, " ")) {
        at += strspn(at, " ");
        if (length && strcspn(at, " ") == length && !strncasecmp(at, word, length))
            return true;
    }
    return false;
}

static size_t find(const char *name, size_t length) {
    size_t i = 0, count = sizeof forms / sizeof *forms;
    while (i < count && (strlen(forms[i].from) != length || strncasecmp(forms[i].from, name, length) != 0))
        i++;
    return i;
}

/* "number" with the format "ordinal" is the class "number:ordinal". */
static bool joined(const char *class_name, const char *format, char out[SAYAS_BYTES]) {
    char both[64];
    size_t length = (size_t)snprintf(both, sizeof both, "%s:%s", class_name, format);
    size_t i = length < sizeof both ? find(both, length) : sizeof forms;
    if (i >= sizeof forms / sizeof *forms)
        return false;
    snprintf(out, SAYAS_BYTES, "%s", forms[i].to);
    return true;
}

bool sayas_form(const char *class_name, const char *format, char out[SAYAS_BYTES], bool *format_fits) {
    size_t length = strlen(class_name), count = sizeof forms / sizeof *forms, i = find(class_name, length);
    const char *colon = strchr(class_name, ':');
    *format_fits = true;
    if (format && *format && joined(class_name, format, out))
        return true;
    if (i == count && colon) {
        format = colon + 1;
        i = find(class_name, (size_t)(colon - class_name));
    }
    if (i == count)
        return false;
    snprintf(out, SAYAS_BYTES, "%s", forms[i].to);
    if (!format || !*format)
        return true;
    *format_fits = listed(forms[i].formats, format, strlen(format));
    if (*format_fits) {
        size_t at = strlen(out);
        snprintf(out + at, SAYAS_BYTES - at, ":%s", format);
        for (char *c = out + at; *c; c++)
            *c = *c >= 'A' && *c <= 'Z' ? (char)(*c | 32) : *c;
    }
    return true;
}
