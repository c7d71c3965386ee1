/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/library/recordings/alignment_job.h"
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

extern char **environ;

/* With nothing to read, and its output to the pipe; signals as a program expects them. */
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
    posix_spawnattr_setpgroup(&how, 0); /* killed as a group, and not by what its parent's group is sent */
    posix_spawnattr_setflags(&how, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETPGROUP);
    int result = posix_spawn(pid, args[0], &files, &how, args, environ);
    posix_spawn_file_actions_destroy(&files);
    posix_spawnattr_destroy(&how);
    return result;
}

bool alignment_job_start(struct alignment_job *job, const struct aligner *a, const char *folder,
                         const char *work, const char *sound) {
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

/* Its output has ended: it has said its last word, or died without one. */
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
        job->length = 0; /* no line of its own */
    return ALIGNMENT_GOES_ON;
}

void alignment_job_stop(struct alignment_job *job) {
    if (!job->pid)
        return;
    kill(-job->pid, SIGKILL);
    kill(job->pid, SIGKILL);
    end(job);
}
