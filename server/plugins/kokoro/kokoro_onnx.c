/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/plugins/kokoro/kokoro_internal.h"
#include <limits.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

bool ko_data_complete(const char *folder) {
    char path[PATH_MAX];
    int length = snprintf(path, sizeof path, "%s/.faccia-lock", folder);
    return length < (int)sizeof path && access(path, R_OK) == 0;
}

const char *ko_data_choose(const char *stated, const char *beside, const char *built) {
    if (stated)
        return stated;
    return ko_data_complete(beside) ? beside : built;
}

/* Wire types of Protocol Buffers. */
enum { VARINT = 0, FIXED64 = 1, BYTES = 2, FIXED32 = 5 };

enum { MODEL_GRAPH = 7, GRAPH_OUTPUT = 12, GRAPH_VALUE_INFO = 13, VALUE_NAME = 1 };

struct bytes {
    const uint8_t *data;
    size_t size;
};

struct field {
    uint64_t number;
    size_t start;        /* offset of the field with its tag */
    struct bytes inside; /* for BYTES, else empty */
};

static bool read_varint(struct bytes m, size_t *at, uint64_t *value) {
    *value = 0;
    for (unsigned shift = 0; shift < 64 && *at < m.size; shift += 7) {
        uint8_t byte = m.data[(*at)++];
        *value |= (uint64_t)(byte & 0x7F) << shift;
        if (byte < 0x80)
            return true;
    }
    return false;
}

static size_t write_varint(uint8_t out[10], uint64_t value) {
    size_t size = 0;
    for (; value >= 0x80; value >>= 7)
        out[size++] = (uint8_t)(value | 0x80);
    out[size++] = (uint8_t)value;
    return size;
}

/* Reads the field at *at and advances past it. */
static bool read_field(struct bytes m, size_t *at, struct field *f) {
    uint64_t key, value;
    *f = (struct field){.start = *at};
    if (!read_varint(m, at, &key))
        return false;
    f->number = key >> 3;
    if ((key & 7) == VARINT)
        return read_varint(m, at, &value);
    size_t size = (key & 7) == FIXED64 ? 8 : 4;
    if ((key & 7) == BYTES) {
        if (!read_varint(m, at, &value) || value > m.size - *at)
            return false;
        size = (size_t)value;
        f->inside = (struct bytes){m.data + *at, size};
    } else if ((key & 7) != FIXED64 && (key & 7) != FIXED32) {
        return false;
    }
    if (size > m.size - *at)
        return false;
    *at += size;
    return true;
}

static bool has_name(struct bytes value_info, const char *name) {
    struct field f;
    for (size_t at = 0; at < value_info.size && read_field(value_info, &at, &f);)
        if (f.number == VALUE_NAME)
            return f.inside.size == strlen(name) && !memcmp(f.inside.data, name, f.inside.size);
    return false;
}

static bool find_value(struct bytes graph, const char *name, struct bytes *value_info) {
    struct field f;
    bool found = false;
    for (size_t at = 0; at < graph.size;) {
        if (!read_field(graph, &at, &f))
            return false;
        if (f.number == GRAPH_VALUE_INFO && has_name(f.inside, name)) {
            *value_info = f.inside;
            found = true;
        }
    }
    return found;
}

bool ko_onnx_expose(struct buf *model, const char *tensor) {
    struct bytes all = {model->data, model->size}, value_info;
    struct field f, graph = {0};
    for (size_t at = 0; at < all.size;) {
        if (!read_field(all, &at, &f) || (f.number == MODEL_GRAPH && graph.number))
            return false;
        if (f.number == MODEL_GRAPH)
            graph = f;
    }
    if (!graph.inside.data || !find_value(graph.inside, tensor, &value_info))
        return false;

    uint8_t output[21], head[11] = {MODEL_GRAPH << 3 | BYTES};
    output[0] = GRAPH_OUTPUT << 3 | BYTES;
    size_t output_head = 1 + write_varint(output + 1, value_info.size), added = output_head + value_info.size;
    size_t head_size = 1 + write_varint(head + 1, graph.inside.size + added);
    size_t graph_at = (size_t)(graph.inside.data - all.data), graph_end = graph_at + graph.inside.size;
    size_t value_at = (size_t)(value_info.data - all.data), moved = graph.start + head_size - graph_at;

    /* Edits in place, because the model is large: data after the graph moves further than the graph's. */
    buf_reserve(model, added + sizeof head);
    memmove(model->data + graph_end + moved + added, model->data + graph_end, model->size - graph_end);
    memmove(model->data + graph_at + moved, model->data + graph_at, graph.inside.size);
    memcpy(model->data + graph.start, head, head_size);
    memcpy(model->data + graph_end + moved, output, output_head);
    memcpy(model->data + graph_end + moved + output_head, model->data + value_at + moved, value_info.size);
    model->size += moved + added;
    return true;
}
