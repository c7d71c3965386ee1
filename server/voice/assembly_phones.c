/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/mem.h"
#include "server/voice/assembly_said.h"
#include "server/voice/sampa.h"
#include <string.h>

static bool is_pause(const struct phone *p) {
    return !*p->ipa;
}

/* Silence that nobody claimed: the pause before it grows, or there is a new one. */
static void add_pause(struct sentence_audio *u, uint32_t start, uint32_t end) {
    if (start == end)
        return;
    if (u->phone_count && is_pause(&u->phones[u->phone_count - 1])) {
        u->phones[u->phone_count - 1].end = end;
        return;
    }
    u->phones[u->phone_count++] = (struct phone){.sampa = "_", .start = start, .end = end};
}

static void add_phone(struct assembly *a, const struct said_phone *said, uint32_t start, uint32_t end) {
    struct phone *p = &a->u->phones[a->u->phone_count];
    *p = (struct phone){.start = start, .end = end, .stress = said->stress};
    memcpy(p->ipa, said->ipa, sizeof p->ipa);
    memcpy(p->symbol, said->symbol, sizeof p->symbol);
    if (sampa_from_ipa(p->ipa, p->sampa, sizeof p->sampa))
        assembly_warn(a, "X-SAMPA has no symbol for a part of the phone \"%s\"", p->ipa);
    if (!is_pause(p) || start < end)
        a->u->phone_count++;
}

void assembly_tidy_phones(struct assembly *a) {
    struct sentence_audio *u = a->u;
    uint32_t end = 0; /* of the phone before */
    /* at most a pause before each and one at the end */
    u->phones = mem_alloc((2 * a->phone_count + 1) * sizeof *u->phones);
    for (size_t i = 0; i < a->phone_count; i++) {
        const struct said_phone *said = &a->phones[i];
        struct phone *last = u->phone_count ? &u->phones[u->phone_count - 1] : NULL;
        uint32_t start = assembly_time(a, said->start, last ? last->start : 0, "phone");
        if (last && start < end) {
            assembly_warn(a, "the voice let phones overlap");
            last->end = start;
        } else {
            add_pause(u, end, start);
        }
        end = assembly_time(a, said->end, start, "phone's end");
        add_phone(a, said, start, end);
    }
    add_pause(u, end, u->samples);
}
