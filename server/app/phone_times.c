/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/app/phone_times.h"
#include "server/align/times.h"
#include "server/app/fit_read.h"
#include "server/base/buf.h"
#include "server/fit/arpabet.h"
#include "server/voice/sampa.h"
#include <ctype.h>
#include <errno.h>
#include <stdio.h>
#include <string.h>

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

/* X-SAMPA is ASCII, and has capitals, digits or signs that IPA does not have. */
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

/* A mark of stress before the name. */
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
        return error_set(e, "bad-recording", "%s", strerror(errno));
    while ((n = fread(block, 1, sizeof block, file)) > 0 && out->size < 100 << 20)
        buf_add(out, block, n);
    int result = ferror(file) ? error_set(e, "bad-recording", "%s", strerror(errno)) : 0;
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
            result = error_set(e, "bad-recording", "'%.31s' is too long for a phone", from->ipa);
            break;
        }
        memcpy(phone.ipa, from->ipa, strlen(from->ipa) + 1);
        result = measured_speech_add(r, &phone, e);
    }
    if (result)
        e->code = "bad-recording";
    times_free(&times);
    return result;
}

/* The first line names a start and an end, with a separator between them. */
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
