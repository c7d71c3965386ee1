/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/mem.h"
#include "server/base/open_below.h"
#include "server/base/sound_reader.h"
#include "server/synthesis/recording_internal.h"
#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { CHANNELS_MAX = 8, BLOCK = 4096 };

const char *const recording_sounds[] = {"wav",  "flac", "ogg", "opus", "oga", "mp3",
                                        "aiff", "aif",  "au",  "caf",  "w64", NULL};

int recording_sound_beside(const char *folder, const char *fap_path) {
    size_t stem = strlen(fap_path);
    int fd = -1;
    if (stem > 4 && !strcmp(fap_path + stem - 4, ".fap"))
        stem -= 4;
    for (const char *const *ending = recording_sounds; fd < 0 && *ending; ending++) {
        size_t size = stem + strlen(*ending) + 2;
        char *path = mem_alloc(size);
        snprintf(path, size, "%.*s.%s", (int)stem, fap_path, *ending);
        fd = folder ? open_below(folder, path, O_RDONLY) : open(path, O_RDONLY | O_NONBLOCK | O_CLOEXEC);
        free(path);
    }
    return fd;
}

/* The source's sound as a file, or -1: it has none, or it cannot be opened, as errno says (0: it has none).
 */
static int open_file(struct recording_source *source) {
    int fd = -1;
    errno = 0;
    if (source->sound_path) {
        fd = open(source->sound_path, O_RDONLY | O_NONBLOCK | O_CLOEXEC);
    } else if (source->sound.size) {
        fd = reader_input(source->sound.data, source->sound.size);
        buf_free(&source->sound);
    } else if (source->fap_path) {
        fd = recording_sound_beside(source->folder, source->fap_path);
        errno = 0;
    }
    return fd;
}

int recording_sound_open(struct sound_reader **sound, struct recording_source *source,
                         const struct reader *reader, const atomic_bool *given_up, struct error *e) {
    char message[SOUND_MESSAGE_BYTES];
    int fd = open_file(source);
    *sound = NULL;
    if (fd < 0)
        return errno ? error_set(e, ERROR_BAD_SOUND, "%s", strerror(errno)) : 0;
    *sound = sound_reader_open(reader, fd, source->sound_path, CHANNELS_MAX, given_up, message);
    return *sound ? 0 : error_set(e, ERROR_BAD_SOUND, "%s", message);
}

uint32_t recording_sound_read(struct sound_reader *s, int16_t *pcm, uint32_t count) {
    float block[BLOCK];
    uint32_t done = 0;
    while (done < count) {
        size_t want = count - done < BLOCK ? count - done : BLOCK, got = sound_reader_read(s, block, want);
        for (size_t i = 0; i < got; i++) {
            double value = 32768.0 * block[i];
            pcm[done++] = (int16_t)(value >= 32767 ? 32767 : value <= -32768 ? -32768 : lrint(value));
        }
        if (got < want)
            break;
    }
    return done;
}
