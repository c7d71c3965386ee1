/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/library/publish/audiobook.h"
#include "server/base/mem.h"
#include "server/base/program.h"
#include "server/library/publish/temp_file.h"
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

enum { SOUND_FD = 3, CHAPTERS_FD = 4, OUTPUT_FD = 5 }; /* of ffmpeg */
enum { NOT_FOUND = 127, KILLED = 128 };                /* exit statuses */

struct chapter {
    char *title;
    uint64_t start, end; /* samples */
};

struct audiobook {
    struct temp_file sound, chapters_file;
    struct chapter *chapters;
    size_t count, cap;
    uint64_t samples, begun; /* begun: of the open chapter */
    uint32_t rate;           /* Hz; 0: no sound yet */
};

struct given {
    int ours, as;
};

/* Runs in the child. */
_Noreturn static void become(char *const *args, pid_t parent, const struct given *given, size_t count) {
    int nowhere = open("/dev/null", O_RDWR), spare[4];
    program_end_with(parent);
    program_give_back_signals();
    dup2(nowhere, STDIN_FILENO);
    dup2(nowhere, STDOUT_FILENO);
    for (size_t i = 0; i < count; i++) /* first beyond the wanted numbers, so that none is overwritten */
        spare[i] = fcntl(given[i].ours, F_DUPFD_CLOEXEC, OUTPUT_FD + 1);
    for (size_t i = 0; i < count; i++)
        dup2(spare[i], given[i].as);
    execvp(args[0], args);
    _exit(NOT_FOUND);
}

/* Runs a program from PATH with these descriptors; it ends with this process. Returns its exit status, or -1
 * with errno. */
static int run(char *const *args, const struct given *given, size_t count) {
    const pid_t parent = getpid(), child = fork();
    int status;
    if (child == 0)
        become(args, parent, given, count);
    if (child < 0)
        return -1;
    while (waitpid(child, &status, 0) < 0)
        if (errno != EINTR)
            return -1;
    if (!WIFEXITED(status))
        return KILLED;
    if (WEXITSTATUS(status) != NOT_FOUND)
        return WEXITSTATUS(status);
    errno = ENOENT;
    return -1;
}

bool audiobook_possible(void) {
    char *args[] = {"ffmpeg", "-version", NULL};
    return !run(args, NULL, 0);
}

struct audiobook *audiobook_open(const char *beside) {
    struct audiobook *b = mem_alloc(sizeof *b);
    b->sound.file = b->chapters_file.file = -1;
    if (!temp_file_open(&b->sound, beside) && !temp_file_open(&b->chapters_file, beside))
        return b;
    int why = errno;
    audiobook_free(b);
    errno = why;
    return NULL;
}

int audiobook_sound(struct audiobook *b, const struct sentence_audio *audio) {
    struct temp_piece piece;
    struct buf samples = {0};
    if (!b->rate)
        b->rate = audio->sample_rate;
    if (audio->pcm) {
        buf_add(&samples, audio->pcm, audio->samples * sizeof *audio->pcm);
    } else {
        static const int16_t none[4096];
        for (size_t left = audio->samples, n; left; left -= n)
            buf_add(&samples, none, (n = left < 4096 ? left : 4096) * sizeof *none);
    }
    b->samples += audio->samples;
    int result = temp_file_add(&b->sound, &samples, &piece);
    int why = errno;
    buf_free(&samples);
    errno = why;
    return result;
}

void audiobook_chapter(struct audiobook *b, const char *title) {
    bool titled = title && *title;
    if (b->samples == b->begun)
        return; /* nothing of it was spoken */
    if (titled || !b->count) {
        b->chapters = mem_grow(b->chapters, &b->cap, b->count + 1, sizeof *b->chapters);
        b->chapters[b->count++] =
            (struct chapter){.title = mem_strdup(titled ? title : ""), .start = b->begun};
    }
    b->chapters[b->count - 1].end = b->begun = b->samples;
}

/* Writes a value of ffmpeg's metadata files, whose signs are escaped. */
static void put(struct buf *out, const char *key, const char *value) {
    if (!value || !*value)
        return;
    buf_printf(out, "%s=", key);
    for (const char *c = value; *c; c++) {
        if (strchr("=;#\\", *c))
            buf_add(out, "\\", 1);
        buf_add(out, *c == '\n' || *c == '\r' ? " " : c, 1);
    }
    buf_add(out, "\n", 1);
}

static int put_metadata(struct audiobook *b, const struct work_meta *meta) {
    struct buf out = {0};
    struct temp_piece piece;
    buf_printf(&out, ";FFMETADATA1\n");
    put(&out, "title", meta->title);
    put(&out, "album", meta->title);
    put(&out, "artist", meta->author);
    put(&out, "date", meta->date);
    put(&out, "publisher", meta->publisher);
    put(&out, "copyright", meta->licence);
    put(&out, "genre", "Audiobook");
    for (size_t i = 0; i < b->count; i++) {
        buf_printf(&out, "[CHAPTER]\nTIMEBASE=1/%u\nSTART=%llu\nEND=%llu\n", b->rate,
                   (unsigned long long)b->chapters[i].start, (unsigned long long)b->chapters[i].end);
        put(&out, "title", *b->chapters[i].title ? b->chapters[i].title : meta->title);
    }
    int result = ftruncate(b->chapters_file.file, 0);
    b->chapters_file.end = 0;
    result = result ? result : temp_file_add(&b->chapters_file, &out, &piece);
    buf_free(&out);
    return result;
}

int audiobook_write(struct audiobook *b, enum audiobook_form form, const struct work_meta *meta, int file) {
    char rate[16];
    if (put_metadata(b, meta))
        return -1;
    snprintf(rate, sizeof rate, "%u", b->rate);
    char *args[40] = {"ffmpeg",     "-nostdin",
                      "-v",         "error",
                      "-y",         "-f",
                      "s16le",      "-ar",
                      rate,         "-ac",
                      "1",          "-i",
                      "/dev/fd/3",  "-f",
                      "ffmetadata", "-i",
                      "/dev/fd/4",  "-map",
                      "0:a",        "-map_metadata",
                      "1",          "-map_chapters",
                      "1"};
    static char *const m4b[] = {"-c:a",       "aac", "-b:a", "64k",       "-movflags",
                                "+faststart", "-f",  "ipod", "/dev/fd/5", NULL};
    static char *const mp3[] = {"-c:a", "libmp3lame", "-q:a", "5",         "-id3v2_version",
                                "3",    "-f",         "mp3",  "/dev/fd/5", NULL};
    size_t count = 0;
    while (args[count])
        count++;
    for (char *const *more = form == AUDIOBOOK_M4B ? m4b : mp3; *more; more++)
        args[count++] = *more;
    const struct given given[] = {
        {b->sound.file, SOUND_FD}, {b->chapters_file.file, CHAPTERS_FD}, {file, OUTPUT_FD}};
    int status = run(args, given, sizeof given / sizeof *given);
    return status > 0 ? 1 : status;
}

void audiobook_free(struct audiobook *b) {
    if (!b)
        return;
    temp_file_close(&b->sound);
    temp_file_close(&b->chapters_file);
    for (size_t i = 0; i < b->count; i++)
        free(b->chapters[i].title);
    free(b->chapters);
    free(b);
}
