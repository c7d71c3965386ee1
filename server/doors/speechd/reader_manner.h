/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How a screen reader wants its texts spoken: its settings, as members of a request. */
#ifndef FACCIA_DOORS_READER_MANNER_H
#define FACCIA_DOORS_READER_MANNER_H

#include "server/doors/remote.h"
#include "server/doors/speechd/reader_protocol.h"

struct reader_manner {
    char lang[36], voice[129], gender[8]; /* empty: none */
    char rate[16], pitch[16], volume[16];
    bool spells;
};

enum { READER_MEMBERS = 8 };

/* As a setting of speech-dispatcher (SSIP) says. False: no such value. Any language and voice is taken: what
 * the daemon does not know is left out when it is spoken. */
bool manner_set(struct reader_manner *manner, const char *name, const char *value);

/* The members, up to one with the name NULL; they point into the manner. */
void manner_members(const struct reader_manner *manner, struct remote_member members[READER_MEMBERS + 1]);

/* The message as SSML, to be freed. */
char *manner_text(const struct reader_manner *manner, enum reader_kind kind, const char *text);

/* Its words without its markup, as SSML again, to be freed: for a text that the daemon refuses. ssml is
 * mended. */
char *manner_words(char *ssml);

#endif
