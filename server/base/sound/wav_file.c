/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/sound/wav_file.h"
#include <errno.h>
#include <fcntl.h>
#include <stdbool.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* The header is searched within the first HEAD_BYTES, as metadata may precede the sound. */
enum { HEAD_BYTES = 65536, UNKNOWN = 0xFFFFFFFFu, FORMAT_BYTES = 16, EXTENSIBLE_BYTES = 26 };

/* A WAV file whose header lacks the length of the sound. */
struct unclosed {
    int format; /* of libsndfile */
    int rate, channels, frame_bytes;
    size_t data; /* byte at which the sound begins */
};

static uint32_t get_u16(const uint8_t *at) {
    return at[0] | (uint32_t)at[1] << 8;
}

static uint32_t get_u32(const uint8_t *at) {
    return get_u16(at) | get_u16(at + 2) << 16;
}

static void put_u32(uint8_t *at, uint64_t value) {
    for (int i = 0; i < 4; i++)
        at[i] = (uint8_t)(value >> 8 * i);
}

/* 0 = compressed, which cannot be read to the end of the file. */
static int format_of(const uint8_t *chunk, size_t size) {
    uint32_t tag = get_u16(chunk), bits = get_u16(chunk + 14);
    if (tag == 0xFFFE && size >= EXTENSIBLE_BYTES)
        tag = get_u16(chunk + 24);
    if (tag == 1)
        return bits == 8    ? SF_FORMAT_PCM_U8
               : bits == 16 ? SF_FORMAT_PCM_16
               : bits == 24 ? SF_FORMAT_PCM_24
               : bits == 32 ? SF_FORMAT_PCM_32
                            : 0;
    if (tag == 3)
        return bits == 32 ? SF_FORMAT_FLOAT : bits == 64 ? SF_FORMAT_DOUBLE : 0;
    return tag == 6 ? SF_FORMAT_ALAW : tag == 7 ? SF_FORMAT_ULAW : 0;
}

/* A length of 0 is true if the RIFF length matches the file. */
static bool is_missing(uint32_t length, uint32_t riff, uint64_t file_size) {
    return length == UNKNOWN || (!length && (uint64_t)riff + 8 != file_size);
}

/* Offset of the data chunk's length in the head; 0: not a WAV file, or an intact one. */
static size_t find_missing(const uint8_t *head, size_t size, uint64_t file_size, size_t *format,
                           size_t *format_size) {
    *format = *format_size = 0;
    if (size < 12 || memcmp(head, "RIFF", 4) != 0 || memcmp(head + 8, "WAVE", 4) != 0)
        return 0;
    for (size_t at = 12; size - at > 8;) {
        uint32_t length = get_u32(head + at + 4);
        if (!memcmp(head + at, "data", 4))
            return is_missing(length, get_u32(head + 4), file_size) ? at + 4 : 0;
        if (length > size - at - 8)
            return 0;
        if (!memcmp(head + at, "fmt ", 4) && length >= FORMAT_BYTES) {
            *format = at + 8;
            *format_size = length;
        }
        at += 8 + length + length % 2;
        if (at > size)
            return 0;
    }
    return 0;
}

static bool is_unclosed(int fd, struct unclosed *u, uint64_t *file_size) {
    static const int widths[] = {
        [SF_FORMAT_PCM_U8] = 1, [SF_FORMAT_PCM_16] = 2, [SF_FORMAT_PCM_24] = 3, [SF_FORMAT_PCM_32] = 4,
        [SF_FORMAT_FLOAT] = 4,  [SF_FORMAT_DOUBLE] = 8, [SF_FORMAT_ALAW] = 1,   [SF_FORMAT_ULAW] = 1};
    uint8_t head[HEAD_BYTES];
    struct stat status;
    size_t size = 0, format, format_size;
    if (fstat(fd, &status) || !S_ISREG(status.st_mode))
        return false;
    for (ssize_t got; size < sizeof head && (got = read(fd, head + size, sizeof head - size)) > 0;)
        size += (size_t)got;
    *file_size = (uint64_t)status.st_size;
    size_t length = lseek(fd, 0, SEEK_SET) ? 0 : find_missing(head, size, *file_size, &format, &format_size);
    if (!length || !format_size)
        return false;
    *u = (struct unclosed){.format = format_of(head + format, format_size),
                           .channels = (int)get_u16(head + format + 2),
                           .rate = (int)(get_u32(head + format + 4) & 0x7FFFFFFF),
                           .data = length + 4};
    u->frame_bytes = u->format ? widths[u->format] * u->channels : 0;
    return u->frame_bytes > 0;
}

SNDFILE *wav_file_open_fd(int fd, int close_it, SF_INFO *info) {
    struct unclosed u;
    uint64_t size;
    if (!is_unclosed(fd, &u, &size))
        return sf_open_fd(fd, SFM_READ, info, close_it);
    *info = (SF_INFO){
        .samplerate = u.rate, .channels = u.channels, .format = SF_FORMAT_RAW | u.format | SF_ENDIAN_LITTLE};
    SNDFILE *file = sf_open_fd(fd, SFM_READ, info, close_it);
    sf_count_t begin = (sf_count_t)u.data;
    if (file) {
        sf_command(file, SFC_SET_RAW_START_OFFSET, &begin, sizeof begin);
        sf_seek(file, 0, SEEK_SET);
        info->frames = (sf_count_t)((size - u.data) / (unsigned)u.frame_bytes);
    }
    return file;
}

/* Opens by descriptor only if necessary: libsndfile also uses the path's ending to detect the format. */
SNDFILE *wav_file_open(const char *path, SF_INFO *info) {
    struct unclosed u;
    uint64_t size;
    int fd = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    bool unclosed = fd >= 0 && is_unclosed(fd, &u, &size);
    if (unclosed)
        return wav_file_open_fd(fd, SF_TRUE, info);
    if (fd >= 0)
        close(fd);
    return sf_open(path, SFM_READ, info);
}

void wav_file_mend(uint8_t *data, size_t size) {
    size_t format, format_size, length = find_missing(data, size, size, &format, &format_size);
    if (!length || size - 8 > UINT32_MAX)
        return;
    put_u32(data + length, size - length - 4);
    put_u32(data + 4, size - 8);
}

const char *wav_file_error(void) {
    int why = sf_error(NULL), system = errno;
    return why == SF_ERR_UNRECOGNISED_FORMAT    ? "not a sound file of a known format"
           : why == SF_ERR_SYSTEM && system > 0 ? strerror(system)
                                                : sf_strerror(NULL);
}
