/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/voice/inserted_sound.h"
#include "server/base/mem.h"
#include "server/base/sound_reader.h"
#include "server/voice/assembly.h"
#include "server/voice/sentence_audio_edit.h"
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

/* A path of names alone: nothing that leads upwards, to the root or to another host. */
static bool is_plain(const char *src) {
    if (!*src || *src == '/' || strchr(src, ':') || strchr(src, '\\') || strlen(src) > 1024)
        return false;
    for (const char *name = src; *name;) {
        size_t length = strcspn(name, "/");
        if (!length || (length == 1 && *name == '.') || (length == 2 && !memcmp(name, "..", 2)))
            return false;
        name += length + (name[length] == '/');
    }
    return true;
}

char *sound_find(const char *folder, const char *src, struct error *e) {
    char root[PATH_MAX], file[PATH_MAX], path[PATH_MAX];
    struct stat status;
    if (!folder || !*folder) {
        error_set(e, ERROR_NO_SOUND, "no folder of sounds is set up: \"%.80s\" is left out", src);
        return NULL;
    }
    if (!is_plain(src)) {
        error_set(e, ERROR_NO_SOUND, "\"%.80s\" is no path below the folder of sounds", src);
        return NULL;
    }
    /* where links lead must lie in the folder too */
    bool found = (size_t)snprintf(path, sizeof path, "%s/%s", folder, src) < sizeof path &&
                 realpath(folder, root) && realpath(path, file) && !strncmp(file, root, strlen(root)) &&
                 file[strlen(root)] == '/' && !stat(file, &status) && S_ISREG(status.st_mode);
    if (!found || status.st_size > SOUND_BYTES_MAX) {
        error_set(e, ERROR_NO_SOUND,
                  found ? "the sound \"%.80s\" is too large" : "there is no sound \"%.80s\"", src);
        return NULL;
    }
    return mem_strdup(file);
}

/* Block by block, so that memory is bounded whatever the header says. */
static void read_mono(struct sound_reader *sound, double volume, struct sentence_audio *u, size_t limit) {
    enum { BLOCK = 4096 };
    float block[BLOCK];
    size_t cap = 0, got;
    while (u->samples < limit && (got = sound_reader_read(sound, block, BLOCK)) > 0) {
        u->pcm = mem_grow(u->pcm, &cap, u->samples + got, sizeof *u->pcm);
        for (size_t i = 0; i < got; i++) {
            double value = (double)block[i] * volume * 32767;
            u->pcm[u->samples++] = (int16_t)(value > 32767 ? 32767 : value > -32768 ? lrint(value) : -32768);
        }
    }
}

struct sentence_audio *sound_read(const struct reader *reader, const char *path, double volume,
                                  uint32_t sample_rate, const atomic_bool *given_up, struct error *e) {
    char message[SOUND_MESSAGE_BYTES];
    const char *name = strrchr(path, '/') ? strrchr(path, '/') + 1 : path;
    int fd = open(path, O_RDONLY | O_NONBLOCK | O_CLOEXEC);
    if (fd < 0)
        snprintf(message, sizeof message, "%s", strerror(errno));
    struct sound_reader *sound =
        fd < 0 ? NULL : sound_reader_open(reader, fd, path, SOUND_CHANNELS_MAX, given_up, message);
    if (!sound) {
        error_set(e, ERROR_NO_SOUND, "the sound \"%.80s\" cannot be read: %s", name, message);
        return NULL;
    }
    struct sentence_audio *u = mem_alloc(sizeof *u);
    u->sample_rate = sound_reader_rate(sound);
    size_t limit = (size_t)SOUND_SECONDS * u->sample_rate;
    read_mono(sound, volume, u, limit);
    if (sound_reader_wrong(sound)) {
        snprintf(message, sizeof message, "the sound \"%.50s\" is not whole: %.100s", name,
                 sound_reader_wrong(sound));
        sentence_audio_warn(u, message);
    }
    sound_reader_close(sound);
    u->phones = mem_alloc(sizeof *u->phones);
    if (u->samples)
        u->phones[u->phone_count++] = (struct phone){.sampa = "_", .end = u->samples};
    if (u->samples >= limit) {
        snprintf(message, sizeof message, "the sound \"%.80s\" is cut after %d s", name, SOUND_SECONDS);
        sentence_audio_cut(u, 0, (uint32_t)limit);
        sentence_audio_warn(u, message);
    }
    sentence_audio_resample(u, sample_rate);
    return u;
}
