/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Resolves names of BML, FML and Greta's own files: an affect, a direction, or else a signal, which the
 * expressions file knows by its usual name (models/expressions.json). */
#include "server/markup/bml.h"
#include <string.h>
#include <strings.h>

void bml_plain_name(const char *name, char out[BML_NAME]) {
    size_t n = 0;
    while (*name == ' ' || (*name >= '\t' && *name <= '\r'))
        name++;
    for (; *name && n < BML_NAME - 1; name++)
        out[n++] = *name == '_' || *name == ' '   ? '-'
                   : *name >= 'A' && *name <= 'Z' ? (char)(*name | 32)
                                                  : *name;
    while (n && (out[n - 1] == '-' || (out[n - 1] >= '\t' && out[n - 1] <= '\r')))
        n--;
    while (*name && n && ((unsigned char)out[n - 1] & 0x80)) /* the cut may be inside a character */
        n--;
    out[n] = '\0';
}

/* A name may include its strength: "joyStrong", "anger_weak". */
static double cut_strength(char *name) {
    static const struct choice endings[] = {{"strong", 1}, {"medium", 0.7}, {"weak", 0.4}, {"light", 0.4}};
    size_t length = strlen(name);
    for (size_t i = 0; i < sizeof endings / sizeof *endings; i++) {
        size_t n = strlen(endings[i].name);
        if (length > n && !strcmp(name + length - n, endings[i].name)) {
            length -= n + (name[length - n - 1] == '-');
            name[length] = '\0';
            return endings[i].value;
        }
    }
    return 1;
}

void bml_show(struct bml_behaviour *b, const char *kind, const char *name, double intensity) {
    if (b->sign_count < BML_SIGNS)
        b->signs[b->sign_count++] = (struct bml_sign){kind, name, intensity};
}

static bool knows_affect(const struct markup_reader *r, const char *name) {
    return r->rules && affect_find(r->rules->affects, name);
}

void bml_show_affect(struct bml_behaviour *b, struct markup_reader *r, const char *name) {
    char plain[BML_NAME];
    bml_plain_name(name, plain);
    double strength = cut_strength(plain);
    char *variant = strchr(plain, '-'); /* "joy-open" */
    if (variant && !knows_affect(r, plain)) {
        *variant = '\0';
        if (!knows_affect(r, plain))
            *variant = '-';
    }
    bml_show(b, "affect", reader_keep(r, reader_affect(r, plain)), strength);
}

void bml_show_lexeme(struct bml_behaviour *b, struct markup_reader *r, const char *name) {
    char plain[BML_NAME], bare[BML_NAME];
    bml_plain_name(name, plain);
    strcpy(bare, plain);
    cut_strength(bare);
    if (knows_affect(r, bare))
        bml_show_affect(b, r, plain);
    else
        bml_show(b, "signal", reader_keep(r, plain), 1);
}

/* Returns the direction that the text begins with, or NULL. */
static const char *direction_at(const char *text) {
    static const char *const directions[] = {"left", "right", "up", "down"};
    for (size_t i = 0; i < sizeof directions / sizeof *directions; i++)
        if (!strncmp(text, directions[i], strlen(directions[i])))
            return directions[i];
    return NULL;
}

bool bml_show_gaze(struct bml_behaviour *b, const char *name) {
    static const char *const listeners[] = {"at",    "camera", "user",  "listener", "viewer", "partner",
                                            "front", "person", "human", "audience", "you",    "interlocutor"};
    char plain[BML_NAME];
    const char *at = plain, *direction;
    bml_plain_name(name, plain);
    if (!strncmp(at, "look-", 5))
        at += 5;
    if (!strcmp(at, "away")) {
        bml_show(b, "signal", "look-away", 1);
        return true;
    }
    for (size_t i = 0; i < sizeof listeners / sizeof *listeners; i++)
        if (!strcmp(at, listeners[i])) {
            bml_show(b, "signal", "look-at", 1);
            return true;
        }
    while ((direction = direction_at(at))) { /* "upright" means up and right */
        at += strlen(direction);
        at += *at == '-';
        bml_show(b, "deictic", direction, 1);
    }
    return b->sign_count && !*at;
}
