/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A voice that does what its text says: the first word of a sentence is the name of a trick. Any other text
 * is spoken, 10 ms for each byte, one phone and one word for each word. */
#include "server/voice/faccia-voice.h"
#include <errno.h>
#include <pthread.h>
#include <sched.h>
#include <signal.h>
#include <spawn.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <time.h>
#include <unistd.h>

enum { RATE = 16000, BYTE = RATE / 100 };

static int puppet_open(const char *config, void **self, char *message, size_t cap) {
    (void)config, (void)message, (void)cap;
    *self = malloc(1);
    return 0;
}

static void puppet_close(void *self) {
    free(self);
}

static void puppet_list(void *self, void (*each)(void *ctx, const struct faccia_voice_info *voice),
                        void *ctx) {
    (void)self;
    const struct faccia_voice_info plain = {"plain",    "Puppet",           "it", "neutral",
                                            "recorded", "GPL-3.0-or-later", RATE, 100};
    struct faccia_voice_info other = plain;
    other.id = "gb";
    other.lang = "en-GB";
    each(ctx, &plain);
    each(ctx, &other);
    each(ctx, &plain); /* twice: the host must not mind */
}

static int speak_audio(const struct faccia_sink *sink, size_t samples) {
    int16_t block[BYTE];
    for (int i = 0; i < BYTE; i++)
        block[i] = 1000;
    for (size_t done = 0; done < samples; done += BYTE)
        if (sink->audio(sink->ctx, block, BYTE, RATE))
            return 1;
    return 0;
}

static int phone(const struct faccia_sink *sink, const char *ipa, uint64_t start, uint64_t end) {
    return sink->phone(sink->ctx, &(struct faccia_phone){ipa, "x", start, end, 0});
}

static int word(const struct faccia_sink *sink, size_t offset, size_t bytes, uint64_t start) {
    return sink->word(sink->ctx, &(struct faccia_word){0, offset, bytes, start, 0});
}

static void speak_plainly(const struct faccia_sentence *sentence, const struct faccia_sink *sink) {
    uint64_t at = 0;
    for (uint32_t s = 0; s < sentence->span_count; s++) {
        const char *text = sentence->spans[s].kind == FACCIA_SPAN_TEXT ? sentence->spans[s].text : "";
        for (size_t i = 0, n; text[i]; i += n) {
            n = strcspn(text + i, " ");
            if (n) {
                phone(sink, "a", at, at + n * BYTE);
                sink->word(sink->ctx, &(struct faccia_word){s, i, n, at, 0});
            }
            n += n == 0 || text[i + n] == ' ';
            at += n * BYTE;
        }
    }
    speak_audio(sink, at);
}

static void crash(const struct faccia_sink *sink) {
    speak_audio(sink, RATE * 5);
    signal(SIGABRT, SIG_DFL);
    abort();
}

static void hang(const struct faccia_sink *sink) {
    (void)sink;
    fprintf(stderr, "puppet %d hangs\n", (int)getpid());
    for (;;)
        pause();
}

static void slow(const struct faccia_sink *sink) {
    while (!speak_audio(sink, BYTE))
        usleep(1000);
}

static void backwards(const struct faccia_sink *sink) {
    speak_audio(sink, 10 * BYTE);
    phone(sink, "a", 5 * BYTE, 6 * BYTE);
    phone(sink, "b", 2 * BYTE, 8 * BYTE);
    phone(sink, "d", 7 * BYTE, BYTE);
    word(sink, 0, 4, 5 * BYTE);
    word(sink, 4, 5, 2 * BYTE);
}

static void beyond(const struct faccia_sink *sink) {
    phone(sink, "a", 0, UINT64_MAX);
    phone(sink, "b", UINT64_MAX - 1, UINT64_MAX);
    word(sink, 0, SIZE_MAX, 0);
    word(sink, SIZE_MAX, SIZE_MAX, 3);
    sink->word(sink->ctx, &(struct faccia_word){UINT32_MAX, 0, 1, 0, 0});
    sink->mark(sink->ctx, "unasked", UINT64_MAX);
    speak_audio(sink, 10 * BYTE);
}

static void names(const struct faccia_sink *sink) {
    phone(sink, "\xFF\xFE", 0, BYTE);
    phone(sink, "\u0251\u0251\u0251\u0251\u0251\u0251\u0251\u0251\u0251\u0251", BYTE, 2 * BYTE);
    sink->phone(sink->ctx, &(struct faccia_phone){NULL, NULL, 2 * BYTE, 3 * BYTE, 77});
    sink->warning(sink->ctx, "bad \xC3");
    speak_audio(sink, 3 * BYTE);
}

static void rates(const struct faccia_sink *sink) {
    int16_t sample = 0;
    sink->audio(sink->ctx, &sample, 1, RATE);
    sink->audio(sink->ctx, &sample, 1, RATE * 2);
}

static void pitchless(const struct faccia_sink *sink) {
    int16_t sample = 0;
    sink->audio(sink->ctx, &sample, 1, 1);
}

static void flood(const struct faccia_sink *sink) {
    while (!speak_audio(sink, RATE))
        continue;
}

static void chatter(const struct faccia_sink *sink) {
    while (!phone(sink, "a", 0, 1))
        continue;
}

static void garbage(const struct faccia_sink *sink) {
    (void)sink;
    char bytes[64];
    memset(bytes, 0xEE, sizeof bytes);
    if (write(3, bytes, sizeof bytes) < 0)
        abort();
}

static void leave(const struct faccia_sink *sink) {
    (void)sink;
    _exit(3);
}

static void print(const struct faccia_sink *sink) {
    printf("a plugin that prints\n");
    fflush(stdout);
    speak_audio(sink, BYTE);
}

/* Dies a little after the sentence. */
static void late(const struct faccia_sink *sink) {
    speak_audio(sink, BYTE);
    ualarm(30000, 0);
}

/* Takes its time, and shows that it works. */
static void steady(const struct faccia_sink *sink) {
    for (int i = 0; i < 20 && !speak_audio(sink, BYTE); i++)
        usleep(250000);
}

/* A second. */
static void brief(const struct faccia_sink *sink) {
    for (int i = 0; i < 4 && !speak_audio(sink, BYTE); i++)
        usleep(250000);
}

static void drip(const struct faccia_sink *sink) {
    while (!speak_audio(sink, BYTE))
        usleep(50000);
}

static void spin(const struct faccia_sink *sink) {
    (void)sink;
    for (volatile unsigned turn = 0;; turn++)
        continue;
}

/* Half a second of processor time. */
static void work(const struct faccia_sink *sink) {
    const clock_t end = clock() + CLOCKS_PER_SEC / 2;
    while (clock() < end)
        continue;
    speak_audio(sink, BYTE);
}

/* More than there is, as an engine takes it that does not expect to be refused. */
static void hog(const struct faccia_sink *sink) {
    enum { BLOCK = 64 << 20, BLOCKS = 1024 };
    for (int i = 0; i < BLOCKS; i++)
        if (mmap(NULL, BLOCK, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0) ==
            MAP_FAILED)
            abort();
    speak_audio(sink, BYTE);
}

/* Tells in a warning what came of something that it did not say that it would do. */
static void tell(const struct faccia_sink *sink, const char *what, int refused) {
    char text[80];
    snprintf(text, sizeof text, "%s: %s", what, refused ? strerror(refused) : "done");
    sink->warning(sink->ctx, text);
}

static void dial(const struct faccia_sink *sink) {
    static const struct {
        const char *name;
        int domain, type;
    } sockets[] = {{"inet", AF_INET, SOCK_STREAM},
                   {"inet6", AF_INET6, SOCK_DGRAM},
                   {"packets", AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC},
                   {"netlink", AF_NETLINK, SOCK_RAW}};
    for (size_t i = 0; i < sizeof sockets / sizeof *sockets; i++) {
        int fd = socket(sockets[i].domain, sockets[i].type, 0);
        tell(sink, sockets[i].name, fd < 0 ? errno : 0);
        if (fd >= 0)
            close(fd);
    }
    int fd = socket(AF_UNIX, SOCK_STREAM, 0);
    const struct sockaddr_un nobody = {AF_UNIX, "/nonexistent"};
    tell(sink, "connect", connect(fd, (const struct sockaddr *)&nobody, sizeof nobody) < 0 ? errno : 0);
    close(fd);
    speak_audio(sink, BYTE);
}

static void *nothing(void *ctx) {
    return ctx;
}

/* Starts a program in every way there is, and a thread, which is allowed. */
static void launch(const struct faccia_sink *sink) {
    char *const argv[] = {"true", NULL};
    pid_t child;
    pthread_t thread;
    tell(sink, "spawn", posix_spawn(&child, "/bin/true", NULL, NULL, argv, NULL));
    tell(sink, "exec", execv("/bin/true", argv) < 0 ? errno : 0);
    tell(sink, "signal", kill(getppid(), 0) < 0 ? errno : 0);
    tell(sink, "unshare", unshare(CLONE_NEWUSER) < 0 ? errno : 0);
    int failed = pthread_create(&thread, NULL, nothing, NULL);
    if (!failed)
        failed = pthread_join(thread, NULL);
    tell(sink, "thread", failed);
    speak_audio(sink, BYTE);
}

/* A frame that the host would never write, past it onto the daemon's socket. */
static void raw(int which, uint32_t job) {
    enum { EVENTS = 7, AUDIO = 6, DONE = 8, HELLO = 4, ALIVE = 10 };
    static const uint32_t frames[][12] = {
        /* words after the header; then length, type, job (0 = of the sentence, 1 = another), payload */
        {0, 0xffffffff, AUDIO, 0},
        {0, 0, 0, 0},
        {0, 0, 99, 0},
        {2, 8, DONE, 1, 0, 0},
        {1, 4, HELLO, 0, 0xfffffff0},
        {1, 1, EVENTS, 0, 1},
        {1, 4, EVENTS, 0, 77},
        {7, 28, EVENTS, 0, 1, 0, 0, 0, 0, 0, 0xfffffffe},
        {8, 32, EVENTS, 0, 1, 0, 0, 0xffffffff, 0xffffffff, 0xffffffff, 1, 0x00414141},
        {6, 24, EVENTS, 0, 3, 0xffffffff, 0xffffffff, 0xffffff00, 0x41414141, 0x41414141},
        {1, 3, AUDIO, 0, 0},
        {2, 7, AUDIO, 0, 16000, 0},
        {1, 4, AUDIO, 0, 0},
        {1, 4, AUDIO, 0, 0xffffffff},
        {1, 4, DONE, 0, 0},
        {0, 0, DONE, 0},
        {0, 4, ALIVE, 0},
    };
    uint32_t frame[12];
    memcpy(frame, frames[which], sizeof frame);
    frame[3] += job;
    if (write(3, frame + 1, (3 + frame[0]) * sizeof *frame) < 0)
        abort();
}

static const struct {
    const char *name;
    void (*play)(const struct faccia_sink *sink);
} tricks[] = {
    {"crash", crash},     {"hang", hang},       {"slow", slow},     {"backwards", backwards},
    {"beyond", beyond},   {"names", names},     {"rates", rates},   {"pitchless", pitchless},
    {"flood", flood},     {"chatter", chatter}, {"leave", leave},   {"print", print},
    {"garbage", garbage}, {"late", late},       {"steady", steady}, {"drip", drip},
    {"spin", spin},       {"hog", hog},         {"dial", dial},     {"launch", launch},
    {"work", work},       {"brief", brief},
};

static int puppet_speak(void *self, const struct faccia_sentence *sentence, const struct faccia_sink *sink,
                        char *message, size_t cap) {
    (void)self;
    const char *text = sentence->span_count && sentence->spans[0].text ? sentence->spans[0].text : "";
    size_t length = strcspn(text, " ");
    if (length == 4 && !memcmp(text, "fail", 4)) {
        snprintf(message, cap, "it does not want to");
        return -1;
    }
    int which;
    unsigned job;
    if (sscanf(text, "raw %d %u", &which, &job) == 2) {
        raw(which, job);
        speak_audio(sink, BYTE);
        return 0;
    }
    for (size_t i = 0; i < sizeof tricks / sizeof *tricks; i++)
        if (strlen(tricks[i].name) == length && !memcmp(text, tricks[i].name, length)) {
            tricks[i].play(sink);
            return 0;
        }
    speak_plainly(sentence, sink);
    return 0;
}

__attribute__((visibility("default"))) const struct faccia_voice faccia_voice = {
    .abi = FACCIA_VOICE_ABI,
    .size = sizeof(struct faccia_voice),
    .name = "puppet",
    .version = "1",
    .licence = "GPL-3.0-or-later",
    .capabilities = FACCIA_VOICE_STREAMS,
    .open = puppet_open,
    .list = puppet_list,
    .speak = puppet_speak,
    .close = puppet_close,
};
