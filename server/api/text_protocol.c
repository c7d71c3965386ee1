/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The sub-protocol for typing: a line is spoken, /word is a command, and events arrive as lines. Input is
 * translated to messages of the main protocol. */
#include "server/api/client_internal.h"
#include "server/base/suggest.h"
#include <stdlib.h>
#include <string.h>

static const char help[] =
    "help type a line to have it spoken; /stop, /pause, /resume, /jump MARK, /play NAME, "
    "/interrupt TEXT, /replace TEXT, /join ROOM, /leave, /token TOKEN, /mood [AFFECT]..., and for "
    "the lines that follow /lang, /voice, /rate, /pitch, /volume, /engine, /markup, /phones";

/* Commands that become a message with at most one string. */
static const struct {
    const char *command, *type, *member, *mode;
} simple[] = {
    {"stop", "stop", NULL, NULL},
    {"pause", "pause", NULL, NULL},
    {"resume", "resume", NULL, NULL},
    {"leave", "leave", NULL, NULL},
    {"jump", "jump", "mark", NULL},
    {"play", "play", "name", NULL},
    {"join", "join", "room", NULL},
    {"token", "authorize", "token", NULL},
    {"replace", "speak", "text", "replace"},
    {"interrupt", "speak", "text", "interrupt"},
};

/* Members of speak that a command sets for all following lines. */
static const char *const settings[] = {"lang",   "voice",  "rate",   "pitch", "volume",
                                       "engine", "markup", "phones", NULL};

static bool is(const char *name, const char *word, size_t size) {
    return strlen(name) == size && !memcmp(name, word, size);
}

static void act(struct client *c, json_t *message) {
    client_act(c, message);
    json_decref(message);
}

static bool do_simple(struct client *c, const char *word, size_t size, const char *rest, size_t left) {
    for (size_t i = 0; i < sizeof simple / sizeof *simple; i++) {
        if (!is(simple[i].command, word, size))
            continue;
        json_t *message = json_pack("{ss}", "type", simple[i].type);
        if (simple[i].member && left)
            json_object_set_new(message, simple[i].member, json_stringn(rest, left));
        if (simple[i].mode)
            json_object_set_new(message, "mode", json_string(simple[i].mode));
        act(c, message);
        return true;
    }
    return false;
}

/* Applies a setting. A rate also affects current speech. */
static bool do_setting(struct client *c, const char *word, size_t size, const char *rest, size_t left) {
    char value[256] = "true", *end;
    struct error e;
    for (size_t i = 0; settings[i]; i++) {
        if (!is(settings[i], word, size))
            continue;
        if (left)
            snprintf(value, sizeof value, "%.*s", (int)(left < 255 ? left : 255), rest);
        if (request_set(&c->defaults, settings[i],
                        (struct request_value){REQUEST_WORD, value, strlen(value), 0}, &e))
            client_complain(c, &e);
        else if (!strcmp(settings[i], "rate"))
            act(c, json_pack("{ss sf}", "type", "rate", "rate", strtod(value, &end)));
        return true;
    }
    return false;
}

/* AFFECT [INTENSITY] ... */
static void do_mood(struct client *c, const char *rest, size_t left) {
    json_t *mix = json_array(), *part = NULL;
    for (size_t at = 0, size; at < left; at += size + 1) {
        char word[64], *end;
        const char *space = memchr(rest + at, ' ', left - at);
        size = space ? (size_t)(space - rest) - at : left - at;
        snprintf(word, sizeof word, "%.*s", (int)(size < 63 ? size : 63), rest + at);
        double intensity = strtod(word, &end);
        if (part && *word && !*end)
            json_object_set_new(part, "intensity", json_real(intensity));
        else if (*word && (part = json_pack("{ss}", "name", word)))
            json_array_append_new(mix, part);
    }
    act(c, json_pack("{ss so}", "type", "express", "mix", mix));
}

static void do_command(struct client *c, const char *line, size_t size) {
    struct error e;
    size_t word = 0;
    while (word < size && line[word] != ' ')
        word++;
    const char *rest = line + word;
    size_t left = size - word;
    for (; left && *rest == ' '; left--)
        rest++;
    if (do_simple(c, line, word, rest, left) || do_setting(c, line, word, rest, left))
        return;
    if (is("mood", line, word)) {
        do_mood(c, rest, left);
    } else if (is("help", line, word)) {
        client_say(c, json_pack("{ss ss}", "type", "help", "text", help));
    } else {
        char name[33], text[SUGGESTIONS_TEXT];
        snprintf(name, sizeof name, "%.*s", word < 32 ? (int)word : 32, line);
        struct suggestions near = suggestions_for(name);
        for (size_t i = 0; i < sizeof simple / sizeof *simple; i++)
            suggest_name(&near, simple[i].command, simple[i].command);
        suggest_names(&near, settings);
        error_set(&e, ERROR_UNKNOWN_COMMAND, "unknown command /%s; /help lists the commands%s", name,
                  suggestions_text(&near, text));
        client_complain(c, &e);
    }
}

static void hear_line(struct client *c, const char *line, size_t size) {
    while (size && (*line == ' ' || *line == '\t' || *line == '\r'))
        line++, size--;
    while (size && (line[size - 1] == ' ' || line[size - 1] == '\t' || line[size - 1] == '\r'))
        size--;
    if (!size)
        return;
    if (*line != '/')
        client_speak(c, line, size);
    else if (size > 1 && line[1] == '/')
        client_speak(c, line + 1, size - 1);
    else
        do_command(c, line + 1, size - 1);
}

void text_hear(struct client *c, const char *data, size_t size) {
    for (size_t at = 0; at < size;) {
        const char *end = memchr(data + at, '\n', size - at);
        size_t length = end ? (size_t)(end - data) - at : size - at;
        hear_line(c, data + at, length);
        at += length + 1;
    }
}
