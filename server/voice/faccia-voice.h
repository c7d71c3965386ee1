/* SPDX-License-Identifier: MIT */
/* The voice plugin interface of facciad, a talking head server.
 *
 * A voice plugin is a shared object that exports one symbol, `faccia_voice`, a const struct faccia_voice. It
 * runs in a worker process (faccia-voice), one plugin per process, so it may crash, leak or hang without
 * harming the daemon. All functions are called from one thread, except cancel. The plugin may call the sink
 * only during speak and only from that thread.
 *
 * Texts are UTF-8. Times are samples of the sentence's own audio, counted from its first sample.
 *
 * A plugin needs only this header, which includes no other header of faccia, compiles as C11 and C++17, and
 * puts no conditions on the plugin's licence. With pkg-config:
 *
 *   cc -shared -fPIC $(pkg-config --cflags faccia-voice) hum.c -o hum.so
 *   cp hum.so $(pkg-config --variable=plugindir faccia-voice)    # or: facciad --plugins FOLDER
 *
 * Compatibility. The interface has one version number, FACCIA_VOICE_ABI, which a plugin stores in its table
 * (abi). A host of version N loads plugins of versions FACCIA_VOICE_ABI_OLDEST to N, built by any compiler,
 * and refuses newer ones with a message that names both versions. A new version only adds:
 * - capability bits; a plugin must leave bits without a name here at 0, because later versions use them;
 * - values of enumerations passed from the host to the plugin, which must ignore values unknown to it;
 * - functions at the end of struct faccia_voice and struct faccia_sink, whose size members tell how many are
 *   present: a plugin may call a function of the sink if sink->size reaches beyond it.
 *
 * The other structures never grow, because they are elements of arrays or one side allocates them for the
 * other. If one must change, or a feature is removed, FACCIA_VOICE_ABI_OLDEST rises and plugins must be
 * rebuilt; their sources still compile if everything that they use remains. */
#ifndef FACCIA_VOICE_H
#define FACCIA_VOICE_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#define FACCIA_VOICE_EXPORT extern "C" __attribute__((visibility("default")))
#else
#define FACCIA_VOICE_EXPORT extern __attribute__((visibility("default")))
#endif

/* Version 2 added FACCIA_VOICE_NETWORK and FACCIA_VOICE_PROGRAMS, version 3 FACCIA_VOICE_FILES; plugins of
 * older versions are assumed to need them. Version 4 added FACCIA_VOICE_CONTEXT. */
#define FACCIA_VOICE_ABI 4
#define FACCIA_VOICE_ABI_OLDEST 1 /* the oldest version that still loads */

/* Capabilities of a plugin (faccia_voice.capabilities). */
enum {
    FACCIA_VOICE_STREAMS = 1u << 0, /* delivers audio while it still synthesises */
    FACCIA_VOICE_MARKS =
        1u << 1, /* reports marks itself; otherwise the host places them at word boundaries */
    FACCIA_VOICE_RATE = 1u << 2,
    FACCIA_VOICE_PITCH = 1u << 3,
    FACCIA_VOICE_RANGE = 1u << 4,
    FACCIA_VOICE_VOLUME = 1u << 5,
    FACCIA_VOICE_PHONEMES = 1u << 6, /* speaks IPA given in a span */
    FACCIA_VOICE_EMOTION = 1u << 7,
    FACCIA_VOICE_UNTIMED =
        1u
        << 8, /* may deliver audio without phones or words; the caller has to find their times in the audio */
    FACCIA_VOICE_FRESH =
        1u << 9, /* the same sentence may sound different each time, so it must not be cached */
    FACCIA_VOICE_SLOW = 1u << 12, /* synthesises in about real time: long sentences are cut at commas, so that
                                     the first part is heard early */
    /* Resources that a plugin needs. Everything undeclared is refused (EPERM, EACCES) from before it is
       loaded. The bits are read from the file, so the table must be a constant without an initialiser. */
    FACCIA_VOICE_NETWORK = 1u << 10,  /* it, or a program that it starts, opens sockets */
    FACCIA_VOICE_PROGRAMS = 1u << 11, /* starts processes; threads are always allowed */
    FACCIA_VOICE_FILES = 1u << 13,    /* writes files, in /tmp and in folders named in its configuration */
    /* The plugin wants the text around a sentence, because pronunciation or lookup depends on it. */
    FACCIA_VOICE_CONTEXT = 1u << 14,
};

/* Absolute paths, separated by "\0", that a plugin may read besides the system's programs, libraries and
 * their data, its own folder and the paths in its configuration. Use it once, outside any function. The
 * list is read from the file. */
#define FACCIA_VOICE_READS(PATHS)                                                                            \
    FACCIA_VOICE_EXPORT const char faccia_voice_reads[sizeof(PATHS)];                                        \
    const char faccia_voice_reads[sizeof(PATHS)] = PATHS

/* One voice. id is unique within the plugin; clients see "PLUGIN:ID". */
struct faccia_voice_info {
    const char *id;      /* "it", "it+f2" */
    const char *name;    /* shown to users */
    const char *lang;    /* BCP 47 */
    const char *gender;  /* "female", "male", "neutral" */
    const char *quality; /* "formant", "diphone", "parametric", "neural", "recorded", "unknown" */
    const char *licence; /* SPDX expression */
    uint32_t sample_rate;
    uint32_t rate; /* default words per minute; 0 = unknown */
};

enum faccia_span_kind { FACCIA_SPAN_TEXT, FACCIA_SPAN_BREAK, FACCIA_SPAN_MARK };

/* A part of a sentence. */
struct faccia_span {
    uint32_t kind;       /* enum faccia_span_kind */
    const char *text;    /* TEXT: what to speak; MARK: the mark's name */
    const char *lang;    /* BCP 47; NULL = the voice's own */
    const char *phones;  /* NULL, or IPA that replaces the text */
    const char *say_as;  /* NULL, or how to read it */
    const char *emotion; /* NULL, or a name, with intensity 0..1 */
    double intensity;
    double seconds;              /* BREAK */
    double rate;                 /* words per minute; 0 = the voice's own */
    double pitch, range, volume; /* factors, 1 = the voice's own */
    uint32_t emphasis;           /* 0 none, 1 reduced, 2 weak, 3 medium, 4 strong */
};

struct faccia_sentence {
    const char *voice; /* id of one of this plugin's voices */
    const struct faccia_span *spans;
    size_t span_count;
    /* With FACCIA_VOICE_CONTEXT: the text of the same utterance before and after the sentence, about 400
     * bytes of whole words, as far as it is known; NULL = none. */
    const char *before, *after;
};

/* A phone. Pauses are phones too: ipa "" and sampa "_". */
struct faccia_phone {
    const char *ipa;     /* without stress marks */
    const char *symbol;  /* the engine's own name, for diagnostics */
    uint64_t start, end; /* samples; phones touch and never overlap */
    uint32_t stress;     /* 0 none, 1 secondary, 2 primary: of the syllable whose nucleus this is */
};

struct faccia_word {
    uint32_t span;        /* index of its span */
    size_t offset, bytes; /* position in the span's text */
    uint64_t start, end;  /* samples; end 0 = unknown: the next word's start or the end of the audio */
};

/* Receives what a plugin produces. Every function returns 0 to continue; on any other value speak should
 * return soon. Audio is mono, 16 bit. Phones, words and marks are in order of time and may come before or
 * after their audio. */
struct faccia_sink {
    uint32_t size;
    void *ctx;
    int (*audio)(void *ctx, const int16_t *samples, size_t count, uint32_t sample_rate);
    int (*phone)(void *ctx, const struct faccia_phone *phone);
    int (*word)(void *ctx, const struct faccia_word *word);
    int (*mark)(void *ctx, const char *name, uint64_t at);
    int (*warning)(void *ctx, const char *message);
};

struct faccia_voice {
    uint32_t abi;  /* the FACCIA_VOICE_ABI it was built with */
    uint32_t size; /* sizeof(struct faccia_voice) */
    const char *name;
    const char *version;
    const char *licence; /* SPDX expression */
    uint32_t capabilities;

    /* Starts the engine. config is the plugin's part of the configuration, a JSON object as text, never
     * NULL. Returns 0 and sets *self; returns 1 with a message (cap bytes) when there is nothing to run,
     * because the engine is not installed or not configured; returns -1 with a message on failure. */
    int (*open)(const char *config, void **self, char *message, size_t cap);

    /* Calls each for every voice. */
    void (*list)(void *self, void (*each)(void *ctx, const struct faccia_voice_info *voice), void *ctx);

    /* Speaks one sentence into the sink. Returns 0 when it was spoken or the sink asked to stop, -1 with a
     * message when the engine failed. */
    int (*speak)(void *self, const struct faccia_sentence *sentence, const struct faccia_sink *sink,
                 char *message, size_t cap);

    /* Makes a running speak return soon. May be NULL. Called from another thread. */
    void (*cancel)(void *self);

    void (*close)(void *self);
};

/* The table that a plugin defines: const struct faccia_voice faccia_voice = {...}; its initialiser must be
 * a constant. Export nothing else: build with -fvisibility=hidden, and link static libraries with
 * -Wl,--exclude-libs,ALL. */
FACCIA_VOICE_EXPORT const struct faccia_voice faccia_voice;

#define FACCIA_VOICE_SYMBOL "faccia_voice"
#define FACCIA_VOICE_READS_SYMBOL "faccia_voice_reads"

#ifdef __cplusplus
}
#endif

#endif
