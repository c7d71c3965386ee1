/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/bridges/speechd/speechd_module.h"
#include "server/base/log.h"
#include "server/base/mem.h"
#include "server/base/utf8.h"
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

void reader_say(const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    vprintf(format, arguments);
    va_end(arguments);
    putchar('\n');
    fflush(stdout);
}

void reader_list(int code, const char *first, const char *second, const char *third) {
    const char *const texts[] = {first, second, third};
    printf("%d-", code);
    for (size_t i = 0; i < 3 && texts[i]; i++) {
        if (i)
            putchar('\t');
        for (const char *c = texts[i]; *c; c++)
            putchar((unsigned char)*c < ' ' || *c == 0x7F ? ' ' : *c);
    }
    putchar('\n');
}

void reader_mark(const char *name) {
    reader_list(700, name, NULL, NULL);
    reader_say("700 INDEX MARK");
}

void reader_sound(const int16_t *samples, size_t count, unsigned rate) {
    enum { ESCAPE = 0x7d, TURN = 0x20 };
    printf("705-bits=16\n705-num_channels=1\n705-sample_rate=%u\n705-num_samples=%zu\n705-big_endian=0\n705-"
           "AUDIO",
           rate, count);
    putchar(0);
    for (size_t i = 0; i < 2 * count; i++) {
        unsigned char byte = (unsigned char)((uint16_t)samples[i / 2] >> 8 * (i & 1));
        bool escaped = byte == ESCAPE || byte == '\n';
        if (escaped)
            putchar(ESCAPE);
        putchar(escaped ? byte ^ TURN : byte);
    }
    printf("\n705 AUDIO\n");
    fflush(stdout);
}

static void begin_message(struct reader_protocol *p, enum reader_kind kind) {
    p->state = READER_MESSAGE;
    p->kind = kind;
    p->text.size = p->lines = 0;
    reader_say("202 OK RECEIVING MESSAGE");
}

static void begin_settings(struct reader_protocol *p, const char *receiving, const char *received,
                           bool count) {
    p->state = READER_SETTINGS;
    p->received = received;
    p->settings_count = count;
    p->wrong = false;
    reader_say("%s", receiving);
}

static void command(struct reader_protocol *p, const char *line) {
    if (!strcmp(line, "SPEAK"))
        begin_message(p, READER_TEXT);
    else if (!strcmp(line, "CHAR"))
        begin_message(p, READER_CHAR);
    else if (!strcmp(line, "KEY"))
        begin_message(p, READER_KEY);
    else if (!strcmp(line, "SOUND_ICON"))
        begin_message(p, READER_SOUND_ICON);
    else if (!strcmp(line, "STOP"))
        p->calls.stop(p->ctx);
    else if (!strcmp(line, "PAUSE"))
        p->calls.pause(p->ctx);
    else if (!strcmp(line, "LIST VOICES"))
        p->calls.list_voices(p->ctx);
    else if (!strcmp(line, "INIT"))
        reader_say("299-faccia: ready\n299 OK LOADED SUCCESSFULLY");
    else if (!strcmp(line, "SET"))
        begin_settings(p, "203 OK RECEIVING SETTINGS", "203 OK SETTINGS RECEIVED", true);
    else if (!strcmp(line, "AUDIO"))
        begin_settings(p, "207 OK RECEIVING AUDIO SETTINGS", "203 OK AUDIO INITIALIZED", false);
    else if (!strcmp(line, "LOGLEVEL"))
        begin_settings(p, "207 OK RECEIVING LOGLEVEL SETTINGS", "203 OK LOG LEVEL SET", false);
    else if (!strncmp(line, "DEBUG", 5))
        reader_say("200 OK DEBUGGING %s", strstr(line, "ON") ? "ON" : "OFF");
    else if (!strcmp(line, "QUIT"))
        p->calls.quit(p->ctx);
    else
        reader_say("300 ERR UNKNOWN COMMAND");
}

static void end_message(struct reader_protocol *p) {
    p->state = READER_COMMANDS;
    buf_add(&p->text, "", 1);
    bool whole =
        p->text.size > 1 && p->text.size <= READER_TEXT_MOST && !memchr(p->text.data, 0, p->text.size - 1);
    if (p->kind != READER_TEXT && p->lines > 1)
        reader_say("305 DATA MORE THAN ONE LINE");
    else if (whole && p->calls.speak(p->ctx, p->kind, (char *)p->text.data))
        return; /* already answered */
    else
        reader_say("301 ERROR CANT SPEAK");
}

static void message_line(struct reader_protocol *p, const char *line, size_t size) {
    if (size == 1 && *line == '.') {
        end_message(p);
        return;
    }
    if (p->lines++)
        buf_add(&p->text, "\n", 1);
    size_t dots = *line == '.';
    if (p->text.size + size <= READER_LINE_MOST)
        buf_add(&p->text, line + dots, size - dots);
}

static void settings_line(struct reader_protocol *p, char *line) {
    char *value = strchr(line, '=');
    if (!strcmp(line, ".")) {
        p->state = READER_COMMANDS;
        reader_say("%s", p->wrong ? "303 ERROR INVALID PARAMETER OR VALUE" : p->received);
        return;
    }
    if (value)
        *value++ = '\0';
    p->wrong |= !value || (p->settings_count && !p->calls.set(p->ctx, line, value));
}

void reader_take(struct reader_protocol *p, const char *bytes, size_t size) {
    size_t at = 0;
    buf_add(&p->come, bytes, size);
    for (char *end; p->come.size > at && (end = memchr(p->come.data + at, '\n', p->come.size - at));) {
        char *line = (char *)p->come.data + at;
        size_t length = (size_t)(end - line);
        *end = '\0';
        at += length + 1;
        if (p->state == READER_MESSAGE)
            message_line(p, line, length);
        else if (p->state == READER_SETTINGS)
            settings_line(p, line);
        else
            command(p, line);
    }
    buf_consume(&p->come, at);
    if (p->come.size > READER_LINE_MOST)
        p->come.size = 0;
}

void reader_free(struct reader_protocol *p) {
    buf_free(&p->come);
    buf_free(&p->text);
}

enum { USUAL_RATE = 160 /* words per minute at 0 */ };

/* -100 to 100. */
static bool read_step(const char *value, double *step) {
    char *end;
    *step = strtod(value, &end);
    return end != value && !*end && *step >= -100 && *step <= 100;
}

static bool set_number(char text[16], const char *value, double middle, double factor) {
    double step;
    if (!read_step(value, &step))
        return false;
    snprintf(text, 16, "%.3f", middle * pow(factor, step / 100));
    return true;
}

/* 100 is the loudest. */
static bool set_volume(char text[16], const char *value) {
    double step;
    if (!read_step(value, &step))
        return false;
    snprintf(text, 16, "%.3f", fmax(0.25, (step + 100) / 200));
    return true;
}

/* Ignores invalid and overlong values: a wrong setting must not silence the screen reader. */
static void set_text(char *text, size_t cap, const char *value) {
    bool none = !strcmp(value, "none") || !strcmp(value, "NULL") || strlen(value) >= cap;
    snprintf(text, cap, "%s", none ? "" : value);
}

/* Accepts a tag (it-IT) or a locale as in $LANG (it_IT.UTF-8); C and POSIX are not languages. */
static void set_language(char *lang, size_t cap, const char *value) {
    char name[64];
    snprintf(name, sizeof name, "%.*s", (int)strcspn(value, ".@"), value);
    for (char *c = name; *c; c++)
        *c = *c == '_' ? '-' : *c;
    set_text(lang, cap, strcasecmp(name, "c") && strcasecmp(name, "posix") ? name : "");
}

bool manner_set(struct reader_manner *m, const char *name, const char *value) {
    if (!strcmp(name, "rate"))
        return set_number(m->rate, value, USUAL_RATE, 3);
    if (!strcmp(name, "pitch"))
        return set_number(m->pitch, value, 1, 2);
    if (!strcmp(name, "volume"))
        return set_volume(m->volume, value);
    if (!strcmp(name, "language"))
        set_language(m->lang, sizeof m->lang, value);
    if (!strcmp(name, "synthesis_voice"))
        set_text(m->voice, sizeof m->voice, value);
    if (!strcmp(name, "spelling_mode"))
        m->spells = !strcmp(value, "on");
    if (!strcmp(name, "voice") || !strcmp(name, "voice_type")) /* female1, male2, child_male... */
        set_text(m->gender, sizeof m->gender,
                 strstr(value, "female") || strstr(value, "FEMALE") ? "female"
                 : strstr(value, "male") || strstr(value, "MALE")   ? "male"
                                                                    : "");
    return true; /* the language determines punctuation and capitals */
}

static const char *or_none(const char *text) {
    return *text ? text : NULL;
}

void manner_members(const struct reader_manner *m, struct remote_member members[READER_MEMBERS + 1]) {
    const struct remote_member all[READER_MEMBERS + 1] = {{"markup", "ssml"},
                                                          {"voice", or_none(m->voice)},
                                                          {"lang", *m->voice ? NULL : or_none(m->lang)},
                                                          {"gender", *m->voice ? NULL : or_none(m->gender)},
                                                          {"rate", or_none(m->rate)},
                                                          {"pitch", or_none(m->pitch)},
                                                          {"volume", or_none(m->volume)},
                                                          {NULL, NULL}};
    memcpy(members, all, sizeof all);
}

/* The name of the space in the language of the settings; NULL: not known. */
static const char *space_name(const struct reader_manner *m) {
    static const char *const names[][2] = {
        {"en", "space"}, {"it", "spazio"}, {"pt", "espaço"}, {"tr", "boşluk"}};
    const char *colon = strchr(m->voice, ':'), *lang = colon ? colon + 1 : m->lang;
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        if (!strncasecmp(lang, names[i][0], 2) && (!lang[2] || lang[2] == '-'))
            return names[i][1];
    return NULL;
}

static void escape(struct buf *out, const char *text) {
    for (; *text; text++) {
        const char *entity = *text == '&' ? "&amp;" : *text == '<' ? "&lt;" : *text == '"' ? "&quot;" : NULL;
        buf_add(out, entity ? entity : text, entity ? strlen(entity) : 1);
    }
}

/* Appends the content of <speak>, or the whole text. */
static void add_inside(struct buf *out, const char *text) {
    const char *begin = !strncmp(text, "<speak", 6) ? strchr(text, '>') : NULL,
               *end = strstr(text, "</speak>");
    if (begin && end > begin)
        buf_add(out, begin + 1, (size_t)(end - begin - 1));
    else
        escape(out, text);
}

/* Length of a known reference such as "&amp;" at the start; 0: none. */
static size_t reference(const char *text) {
    static const char *const known[] = {"&amp;", "&lt;", "&gt;", "&quot;", "&apos;"};
    for (size_t i = 0; i < sizeof known / sizeof *known; i++)
        if (!strncmp(text, known[i], strlen(known[i])))
            return strlen(known[i]);
    return 0;
}

/* Reduces SSML to its words, for a text that the daemon refused. Modifies ssml. Free the result. */
static char *manner_words(char *ssml) {
    struct buf out = {0};
    utf8_mend(ssml);
    buf_printf(&out, "<speak>");
    for (const char *at = ssml; *at;) {
        const char *end = *at == '<' ? strchr(at, '>') : NULL;
        size_t kept = *at == '&' ? reference(at) : *at == '<' ? 0 : 1;
        if (end)
            buf_add(&out, " ", 1);
        else if (kept)
            buf_add(&out, at, kept);
        else
            buf_printf(&out, *at == '&' ? "&amp;" : "&lt;");
        at = end ? end + 1 : at + (kept ? kept : 1);
    }
    buf_add(&out, "</speak>", 9);
    return (char *)out.data;
}

char *manner_text(const struct reader_manner *m, enum reader_kind kind, const char *text) {
    static const char spelt[] = "<say-as interpret-as=\"characters\">";
    struct buf out = {0};
    buf_printf(&out, "<speak>");
    const bool space = kind == READER_CHAR && (!strcmp(text, "space") || !strcmp(text, " "));
    if (space && space_name(m)) {
        buf_printf(&out, "%s", space_name(m));
    } else if (kind == READER_CHAR || (kind == READER_TEXT && m->spells)) {
        buf_printf(&out, "%s", spelt);
        if (kind == READER_CHAR)
            escape(&out, space ? " " : text);
        else
            add_inside(&out, text);
        buf_printf(&out, "</say-as>");
    } else if (kind == READER_SOUND_ICON) {
        buf_printf(&out, "<audio src=\"");
        escape(&out, text);
        buf_printf(&out, ".wav\">");
        escape(&out, text);
        buf_printf(&out, "</audio>");
    } else if (kind == READER_KEY) {
        char *words = mem_strdup(text);
        for (char *c = words; *c; c++)
            *c = *c == '_' ? ' ' : *c;
        escape(&out, words);
        free(words);
    } else {
        add_inside(&out, text);
    }
    buf_add(&out, "</speak>", 9);
    return (char *)out.data;
}

void module_drop_sound(struct reader_module *m) {
    if (m->fetch)
        remote_give_up(m->fetch);
    m->fetch = NULL;
    while (m->mark_count)
        free(m->marks[--m->mark_count].name);
    m->sound.size = 0;
    m->ended = NULL;
}

void module_finish(struct reader_module *m, const char *event) {
    if (!m->text)
        return;
    module_drop_sound(m);
    if (m->rooms)
        remote_give_up(m->rooms);
    m->rooms = NULL;
    free(m->text);
    m->text = NULL;
    *m->id = '\0';
    if (!m->begun)
        reader_say("701 BEGIN");
    reader_say("%s", event);
}

void module_ask(struct reader_module *m, const char *path, const struct remote_member *members,
                remote_bytes *bytes, remote_answered *answered) {
    m->fetch = remote_fetch(m->remote, path, members, "application/ssml+xml", m->text, bytes, answered, m);
    remote_speak_anyway(m->fetch, *m->manner.lang ? m->manner.lang : NULL);
}

bool module_give_up_markup(struct reader_module *m, const struct remote_answer *answer) {
    if (answer->status != 400 || m->plain)
        return false;
    log_warn("its markup is removed: %s", answer->why);
    char *words = manner_words(m->text);
    free(m->text);
    m->text = words;
    m->plain = true;
    return true;
}

void module_begin(struct reader_module *m) {
    if (!m->begun)
        reader_say("701 BEGIN");
    m->begun = true;
}
