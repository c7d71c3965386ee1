/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The parts of reading a speech pack; speech.c puts them together. All return 0, or -1 with the root's error
 * filled. */
#ifndef FACCIA_FACE_PACKS_SPEECH_PACK_READ_H
#define FACCIA_FACE_PACKS_SPEECH_PACK_READ_H

#include "server/base/json_place.h"
#include "server/face/packs/speech_pack_content.h"

/* Overwrites those coefficients that the object names; with_target allows t and T. */
int speech_read_coefficients(const struct json_place *at, bool with_target, struct coefficients *out);

/* An object from parameter names to coefficients: overwrites what it names. Nothing to do when it is missing.
 */
int speech_read_parameters(const struct json_place *at, struct coefficients out[PARAM_COUNT]);

/* What "gain" and "shift" beside at's other keys make of the targets of each parameter: gain T + shift. */
struct target_change {
    double gain, shift;
};
int speech_read_changes(const struct json_place *at, struct target_change out[PARAM_COUNT]);

int speech_read_groups(struct speech_pack *pack, const struct json_place *at);
const struct speech_group *speech_find_group(const struct speech_pack *pack, const char *name);

int speech_read_phones(struct speech_pack *pack, const struct json_place *at);
void speech_phone_free(struct speech_phone *phone);

/* Of the tables of a vowel or a consonant. */
size_t speech_context_count(const struct speech_pack *pack, bool vowel);

int speech_read_contact(const struct json_place *at, struct contact_rule *contact);

/* The group that is named there, its coefficients in the phone's tables, which have count entries. */
int speech_read_group_of(const struct speech_pack *pack, const struct json_place *at,
                         struct speech_phone *phone, size_t *count);

/* What the phone says of its own tables: coefficients, gain, shift, targets. is_like: they are filled
 * already. */
int speech_read_tables(const struct speech_pack *pack, const struct json_place *at,
                       struct speech_phone *phone, size_t count, bool is_like);

/* {"LI": {"a": {"t": ..., "T": ...}, "any": {...}}, ...} into table[context * PARAM_COUNT + param]; notes in
 * seen (may be NULL) which entries were given. */
int speech_read_targets(const struct json_place *at, char *const *contexts, struct coefficients *table,
                        bool *seen);

#endif
