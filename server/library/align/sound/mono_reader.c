/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/library/align/sound/mono_reader.h"
#include <math.h>

void mono_reader_begin(struct mono_reader *r, SNDFILE *file, int channels) {
    r->file = file;
    r->channels = (unsigned)channels;
    r->next = 0;
    r->mixdown = (struct mixdown){0};
}

size_t mono_reader_read(struct mono_reader *r, uint64_t from, int16_t *out, size_t count) {
    size_t done = 0;
    if (from != r->next && sf_seek(r->file, (sf_count_t)from, SEEK_SET) < 0)
        return 0;
    r->next = from;
    while (done < count) {
        size_t want = count - done < MONO_READER_FRAMES ? count - done : MONO_READER_FRAMES;
        /* reading floats as shorts would first scan the whole file to scale them */
        sf_count_t got = sf_readf_float(r->file, r->frames, (sf_count_t)want);
        for (sf_count_t i = 0; i < got; i++) {
            const float *frame = r->frames + (size_t)i * r->channels;
            double mono = 32768 * mixdown_frame(&r->mixdown, frame, r->channels);
            out[done++] = (int16_t)lrint(fmax(-32768, fmin(32767, mono)));
        }
        r->next += got > 0 ? (uint64_t)got : 0;
        if (got < (sf_count_t)want)
            break;
    }
    return done;
}
