/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/mem.h"
#include "server/library/recordings/alignments.h"
#include "server/library/recordings/library_voices.h"
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <signal.h>
#include <spawn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

const char *const alignment_states[ALIGNMENT_STATES] = {"waiting", "aligning", "aligned", "stale", "failed"};

json_t *alignment_stamp(const char *path) {
    struct stat info;
    return stat(path, &info) ? NULL
                             : json_pack("{sI sI}", "size", (json_int_t)info.st_size, "modified",
                                         (json_int_t)kept_time(&info));
}

/* True when the file still has the size and time of its stamp in the report. */
static bool alignment_is_of(const json_t *report, const char *member, const char *path) {
    const json_t *of = json_object_get(report, member);
    json_t *now = alignment_stamp(path);
    bool same = now && json_equal(json_object_get(of, "size"), json_object_get(now, "size")) &&
                json_equal(json_object_get(of, "modified"), json_object_get(now, "modified"));
    json_decref(now);
    return same;
}

static void text_path(char path[PATH_MAX], const char *folder, const char *work) {
    snprintf(path, PATH_MAX, "%s/%s.txt", folder, work);
}

enum alignment_state alignment_state_kept(const char *folder, const char *work, const char *sound,
                                          char **why) {
    json_t *report = kept_json(folder, work, ALIGNMENT_ENDING);
    const char *state = json_string_value(json_object_get(report, "state"));
    const char *told = json_string_value(json_object_get(report, "why"));
    char text[PATH_MAX];
    text_path(text, folder, work);
    enum alignment_state result = ALIGNMENT_WAITING;
    bool aligned = state && !strcmp(state, alignment_states[ALIGNMENT_ALIGNED]);
    *why = NULL;
    if (aligned || state) {
        bool current = alignment_is_of(report, "text", text) && alignment_is_of(report, "sound", sound);
        result = aligned ? (current ? ALIGNMENT_ALIGNED : ALIGNMENT_STALE)
                         : (current ? ALIGNMENT_FAILED : ALIGNMENT_WAITING);
    }
    if (result == ALIGNMENT_FAILED)
        *why = mem_strdup(told ? told : "");
    json_decref(report);
    return result;
}

int alignment_keep_failure(const char *folder, const char *work, const char *sound, const char *why,
                           struct error *e) {
    char text[PATH_MAX];
    text_path(text, folder, work);
    json_t *report =
        json_pack("{ss so* so* so*}", "state", alignment_states[ALIGNMENT_FAILED], "why", json_string(why),
                  "text", alignment_stamp(text), "sound", alignment_stamp(sound));
    int result = kept_set_json(folder, work, ALIGNMENT_ENDING, report, e);
    json_decref(report);
    return result;
}

/* Selects the entries with a passage of that section: "WORK:SECTION:NAME". */
static json_t *of_section(const json_t *list, const char *work, unsigned section) {
    json_t *some = json_array(), *each;
    char begin[112];
    size_t i;
    int length = snprintf(begin, sizeof begin, "%s:%u:", work, section);
    json_array_foreach((json_t *)list, i, each) {
        const char *passage = json_string_value(json_object_get(each, "passage"));
        if (passage && (!section || !strncmp(passage, begin, (size_t)length)))
            json_array_append(some, each);
    }
    return some;
}

void alignment_tell(const char *folder, const char *work, unsigned section, json_t *object) {
    static const char *const lists[] = {"unread", "unwritten"};
    static const char *const figures[] = {"sentences", "missing", "doubtful", "confidence"};
    json_t *report = kept_json(folder, work, ALIGNMENT_ENDING);
    for (size_t i = 0; i < 2; i++)
        json_object_set_new(object, lists[i], of_section(json_object_get(report, lists[i]), work, section));
    for (size_t i = 0; i < 4 && !section; i++) {
        json_t *figure = json_object_get(report, figures[i]);
        if (figure)
            json_object_set(object, figures[i], figure);
    }
    json_decref(report);
}

extern char **environ;

/* Starts the program with an empty input, its output to the pipe, and default signal handling. */
static int spawn(pid_t *pid, int out, char *const args[]) {
    posix_spawn_file_actions_t files;
    posix_spawnattr_t how;
    sigset_t none, usual;
    sigemptyset(&none);
    sigemptyset(&usual);
    sigaddset(&usual, SIGPIPE);
    sigaddset(&usual, SIGXFSZ);
    posix_spawn_file_actions_init(&files);
    posix_spawn_file_actions_addopen(&files, 0, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_adddup2(&files, out, 1);
    posix_spawnattr_init(&how);
    posix_spawnattr_setsigmask(&how, &none);
    posix_spawnattr_setsigdefault(&how, &usual);
    posix_spawnattr_setpgroup(
        &how,
        0); /* so that it can be killed as a group, and does not get the signals of the parent's group */
    posix_spawnattr_setflags(&how, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETPGROUP);
    int result = posix_spawn(pid, args[0], &files, &how, args, environ);
    posix_spawn_file_actions_destroy(&files);
    posix_spawnattr_destroy(&how);
    return result;
}

bool alignment_job_start(struct alignment_job *job, const struct aligner *a, const char *folder,
                         const char *work, const char *sound, const char *library) {
    char percent[16], megabytes[16];
    int ends[2];
    *job = (struct alignment_job){.fd = -1};
    snprintf(percent, sizeof percent, "%u", a->percent);
    snprintf(megabytes, sizeof megabytes, "%u", a->megabytes);
    char *args[] = {(char *)a->program,
                    (char *)folder,
                    (char *)work,
                    (char *)sound,
                    percent,
                    megabytes,
                    (char *)a->worker,
                    (char *)a->plugin,
                    a->unconfined ? "off" : "on",
                    (char *)a->normalization,
                    (char *)library,
                    NULL};
    int result = pipe2(ends, O_CLOEXEC) ? errno : 0;
    if (!result) {
        result = spawn(&job->pid, ends[1], args);
        close(ends[1]);
        if (result)
            close(ends[0]);
        else
            job->fd = ends[0];
    }
    if (result) {
        job->pid = 0;
        snprintf(job->result, sizeof job->result, "%.200s cannot be started: %s", a->program,
                 strerror(result));
    }
    return !result;
}

static int end(struct alignment_job *job) {
    int status = 0;
    if (job->fd >= 0)
        close(job->fd);
    /* changes nothing of an exit that has begun, and waits for no process that goes on */
    if (job->pid)
        kill(-job->pid, SIGKILL);
    while (job->pid && waitpid(job->pid, &status, 0) < 0 && errno == EINTR)
        continue;
    job->fd = -1;
    job->pid = 0;
    return status;
}

static bool begins(struct alignment_job *job, const char *word) {
    size_t length = strlen(word);
    if (strncmp(job->result, word, length) != 0)
        return false;
    memmove(job->result, job->result + length, strlen(job->result + length) + 1);
    return true;
}

/* Interprets the last line and the exit status after the output has ended. */
static enum alignment_end judge(struct alignment_job *job) {
    int status = end(job);
    if (WIFEXITED(status) && !WEXITSTATUS(status) && begins(job, "done"))
        return ALIGNMENT_DONE;
    if (WIFEXITED(status) && begins(job, "failed: "))
        return ALIGNMENT_REFUSED;
    if (WIFEXITED(status) && begins(job, "later: "))
        return ALIGNMENT_LATER;
    int signal = WIFSIGNALED(status) ? WTERMSIG(status) : 0;
    if (signal)
        snprintf(job->result, sizeof job->result, "the aligner was killed by signal %d (%s)", signal,
                 strsignal(signal));
    else
        snprintf(job->result, sizeof job->result, "the aligner exited with status %d", WEXITSTATUS(status));
    return signal == SIGKILL || signal == SIGTERM ? ALIGNMENT_LATER : ALIGNMENT_DIED;
}

static void hear(struct alignment_job *job, const char *line) {
    char *after;
    double share = strtod(line, &after);
    if (after != line && !*after)
        job->share = share < 0 ? 0 : share > 1 ? 1 : share;
    else
        snprintf(job->result, sizeof job->result, "%s", line);
}

enum alignment_end alignment_job_read(struct alignment_job *job) {
    ssize_t n = read(job->fd, job->line + job->length, sizeof job->line - 1 - job->length);
    if (n < 0 && errno == EINTR)
        return ALIGNMENT_GOES_ON;
    if (n <= 0)
        return judge(job);
    job->length += (size_t)n;
    for (char *newline; (newline = memchr(job->line, '\n', job->length));) {
        *newline = '\0';
        hear(job, job->line);
        job->length -= (size_t)(newline + 1 - job->line);
        memmove(job->line, newline + 1, job->length);
    }
    if (job->length == sizeof job->line - 1)
        job->length = 0; /* drops a line that is too long */
    return ALIGNMENT_GOES_ON;
}

void alignment_job_stop(struct alignment_job *job) {
    if (!job->pid)
        return;
    kill(-job->pid, SIGKILL);
    kill(job->pid, SIGKILL);
    end(job);
}
