/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/library/align/sound/mp4_track.h"
#include "server/base/mem.h"
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#define CODE ERROR_BAD_SOUND

enum { HEADER = 8, TRACKS_MAX = 64, DESCRIPTOR_BYTES_MAX = 4 };

struct range {
    const uint8_t *at, *end;
};

static size_t left(struct range r) {
    return (size_t)(r.end - r.at);
}

static uint64_t number(const uint8_t *at, unsigned bytes) {
    uint64_t value = 0;
    for (unsigned i = 0; i < bytes; i++)
        value = value << 8 | at[i];
    return value;
}

/* Takes a number off the range; 0 beyond its end. */
static uint64_t take(struct range *r, unsigned bytes) {
    if (left(*r) < bytes) {
        r->at = r->end;
        return 0;
    }
    r->at += bytes;
    return number(r->at - bytes, bytes);
}

static void skip(struct range *r, size_t bytes) {
    r->at += bytes < left(*r) ? bytes : left(*r);
}

/* Takes the next box off the range. Returns false at its end. */
static bool next_box(struct range *r, uint32_t *type, struct range *box) {
    if (left(*r) < HEADER)
        return false;
    uint64_t size = take(r, 4), head = HEADER;
    *type = (uint32_t)take(r, 4);
    if (size == 1) {
        size = take(r, 8);
        head += 8;
    }
    uint64_t inner = size ? size - head : left(*r);
    if ((size && size < head) || inner > left(*r))
        return false;
    *box = (struct range){r->at, r->at + inner};
    r->at += inner;
    return true;
}

#define TYPE(name) ((uint32_t)number((const uint8_t *)(name), 4))

/* The first box of that type in the range. */
static bool find_box(struct range in, uint32_t type, struct range *box) {
    uint32_t found;
    while (next_box(&in, &found, box))
        if (found == type)
            return true;
    return false;
}

/* Follows a path such as "minfstbl". */
static bool find_path(struct range in, const char *path, struct range *box) {
    for (*box = in; *path; path += 4)
        if (!find_box(*box, TYPE(path), box))
            return false;
    return true;
}

/* Takes the tag and the length of an MPEG-4 descriptor. */
static bool next_descriptor(struct range *r, unsigned *tag, struct range *body) {
    if (left(*r) < 2)
        return false;
    *tag = (unsigned)take(r, 1);
    size_t size = 0;
    for (int i = 0; i < DESCRIPTOR_BYTES_MAX; i++) {
        unsigned byte = (unsigned)take(r, 1);
        size = size << 7 | (byte & 0x7F);
        if (!(byte & 0x80))
            break;
    }
    size = size < left(*r) ? size : left(*r);
    *body = (struct range){r->at, r->at + size};
    r->at += size;
    return true;
}

/* esds: the decoder's configuration, if its object type is AAC. */
static bool read_esds(struct mp4_track *t, struct range r) {
    enum { ES = 3, DECODER = 4, SPECIFIC = 5, AAC = 0x40, AAC_MPEG2 = 0x66, AAC_MPEG2_LAST = 0x68 };
    unsigned tag;
    struct range body;
    skip(&r, 4); /* version */
    if (!next_descriptor(&r, &tag, &body) || tag != ES)
        return false;
    skip(&body, 2); /* its id */
    unsigned flags = (unsigned)take(&body, 1);
    skip(&body, flags & 0x80 ? 2 : 0);
    skip(&body, flags & 0x40 ? (size_t)take(&body, 1) : 0);
    skip(&body, flags & 0x20 ? 2 : 0);
    r = body;
    if (!next_descriptor(&r, &tag, &body) || tag != DECODER || left(body) < 13)
        return false;
    unsigned object = body.at[0];
    skip(&body, 13);
    r = body;
    while (next_descriptor(&r, &tag, &body))
        if (tag == SPECIFIC && left(body) >= 2) {
            t->config = body.at;
            t->config_size = left(body);
            return object == AAC || (object >= AAC_MPEG2 && object <= AAC_MPEG2_LAST);
        }
    return false;
}

/* stsd: the first description must be mp4a. */
static bool read_description(struct mp4_track *t, struct range stsd) {
    struct range entry, esds, wave;
    uint32_t type;
    skip(&stsd, 8); /* version, count */
    if (!next_box(&stsd, &type, &entry) || type != TYPE("mp4a") || left(entry) < 28)
        return false;
    unsigned version = (unsigned)number(entry.at + 8, 2);
    skip(&entry, 28 + (version == 1 ? 16 : version == 2 ? 36 : 0)); /* QuickTime's longer ones */
    if (find_box(entry, TYPE("wave"), &wave))
        entry = wave;
    return find_box(entry, TYPE("esds"), &esds) && read_esds(t, esds);
}

/* Sizes of the frames. */
static int read_sizes(struct mp4_track *t, struct range r, size_t most, struct error *e) {
    skip(&r, 4);
    uint32_t size = (uint32_t)take(&r, 4);
    uint64_t count = take(&r, 4);
    if (!count || count > most || (!size && count > left(r) / 4))
        return error_set(e, CODE, "the MP4 file has no frames, or more than it can hold");
    t->frames = mem_alloc(count * sizeof *t->frames);
    t->count = count;
    for (size_t i = 0; i < count; i++)
        t->frames[i].size = size ? size : (uint32_t)take(&r, 4);
    return 0;
}

/* Computes the positions of the frames from those of the chunks. */
static int read_places(struct mp4_track *t, struct range stsc, struct range offsets, unsigned width,
                       size_t data_size, struct error *e) {
    skip(&stsc, 4);
    skip(&offsets, 4);
    uint64_t runs = take(&stsc, 4), chunks = take(&offsets, 4);
    uint64_t first = take(&stsc, 4), per_chunk = take(&stsc, 4);
    size_t frame = 0;
    skip(&stsc, 4);
    uint64_t next = runs > 1 ? take(&stsc, 4) : UINT64_MAX;
    if (first != 1 || chunks > left(offsets) / width)
        return error_set(e, CODE, "the MP4 file does not say where its sound is");
    for (uint64_t chunk = 1; chunk <= chunks && frame < t->count; chunk++) {
        if (chunk == next) {
            per_chunk = take(&stsc, 4);
            skip(&stsc, 4);
            runs--;
            next = runs > 1 ? take(&stsc, 4) : UINT64_MAX;
        }
        uint64_t at = take(&offsets, width);
        for (uint64_t i = 0; i < per_chunk && frame < t->count; i++, frame++) {
            if (at > data_size || t->frames[frame].size > data_size - at)
                break; /* the file is cut off */
            t->frames[frame].at = at;
            at += t->frames[frame].size;
        }
        if (at > data_size)
            break;
    }
    t->count = frame;
    return frame ? 0 : error_set(e, CODE, "the MP4 file does not say where its sound is");
}

static void read_header(struct mp4_track *t, struct range mdhd) {
    unsigned version = (unsigned)take(&mdhd, 1);
    skip(&mdhd, 3 + (version ? 16 : 8));
    t->timescale = (uint32_t)take(&mdhd, 4);
}

/* The edit list: the first edit that is not empty says where the sound begins. */
static void read_edits(struct mp4_track *t, struct range elst, uint32_t movie_scale) {
    unsigned version = (unsigned)take(&elst, 1), width = version ? 8 : 4;
    skip(&elst, 3);
    for (uint64_t left_over = take(&elst, 4); left_over-- && left(elst) >= 2 * width + 4;) {
        uint64_t length = take(&elst, width), from = take(&elst, width);
        skip(&elst, 4);
        if (from == (version ? UINT64_MAX : UINT32_MAX))
            continue;
        t->skip = from;
        t->length = movie_scale ? (uint64_t)((double)length * t->timescale / movie_scale) : 0;
        return;
    }
}

static int read_track(struct mp4_track *t, struct range trak, struct range moov, size_t size,
                      struct error *e) {
    struct range mdhd, stbl, box, sizes, stsc, offsets, mvhd;
    if (!find_path(trak, "mdiahdlr", &box) || left(box) < 12 || number(box.at + 8, 4) != TYPE("soun") ||
        !find_path(trak, "mdiamdhd", &mdhd) || !find_path(trak, "mdiaminfstbl", &stbl) ||
        !find_box(stbl, TYPE("stsd"), &box) || !read_description(t, box))
        return 1;
    read_header(t, mdhd);
    bool wide = !find_box(stbl, TYPE("stco"), &offsets);
    if (!t->timescale || !find_box(stbl, TYPE("stsz"), &sizes) || !find_box(stbl, TYPE("stsc"), &stsc) ||
        (wide && !find_box(stbl, TYPE("co64"), &offsets)))
        return error_set(e, CODE, "the MP4 file lacks the tables of its sound");
    if (read_sizes(t, sizes, size, e) || read_places(t, stsc, offsets, wide ? 8 : 4, size, e))
        return -1;
    uint32_t scale = 0;
    if (find_box(moov, TYPE("mvhd"), &mvhd)) {
        unsigned version = (unsigned)take(&mvhd, 1);
        skip(&mvhd, 3 + (version ? 16 : 8));
        scale = (uint32_t)take(&mvhd, 4);
    }
    if (find_path(trak, "edtselst", &box))
        read_edits(t, box, scale);
    return 0;
}

int mp4_track_read(struct mp4_track *t, const uint8_t *data, size_t size, struct error *e) {
    struct range whole = {data, data + size}, moov, trak;
    uint32_t type;
    *t = (struct mp4_track){0};
    if (!find_box(whole, TYPE("moov"), &moov))
        return error_set(e, CODE, "the MP4 file has no index (moov)");
    struct range rest = moov;
    for (int tracks = 0; tracks < TRACKS_MAX && next_box(&rest, &type, &trak);) {
        if (type != TYPE("trak"))
            continue;
        tracks++;
        int result = read_track(t, trak, moov, size, e);
        if (result < 0)
            mp4_track_free(t);
        if (result <= 0)
            return result;
        *t = (struct mp4_track){0};
    }
    return error_set(e, CODE, "the MP4 file has no sound in AAC");
}

void mp4_track_free(struct mp4_track *t) {
    free(t->frames);
    *t = (struct mp4_track){0};
}
