/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/mem.h"
#include "server/plugins/kokoro/kokoro_internal.h"
#include <ctype.h>
#include <dirent.h>
#include <dlfcn.h>
#include <errno.h>
#include <math.h>
#include <onnxruntime_c_api.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define SUFFIX ".bin"

static const char *text_of(const json_t *object, const char *key) {
    return json_string_value(json_object_get(object, key));
}

/* Adds the voice file NAME.bin if kokoro.json defines its letters. */
static void add(struct ko_voices *voices, const char *folder, const char *file) {
    size_t length = strlen(file) - strlen(SUFFIX);
    const char language[2] = {file[0]}, gender[2] = {file[1]};
    const json_t *entry = json_object_get(json_object_get(voices->table, "languages"), language);
    const char *sex = text_of(json_object_get(voices->table, "genders"), gender);
    const char *lang = text_of(entry, "lang"), *espeak = text_of(entry, "espeak");
    if (!lang || !espeak || !sex || length < 4 || file[2] != '_')
        return;
    voices->list = mem_grow(voices->list, &voices->cap, voices->count + 1, sizeof *voices->list);
    struct ko_voice *v = &voices->list[voices->count++];
    *v = (struct ko_voice){.espeak = espeak,
                           .alphabet = {voices->vocabulary, json_object_get(entry, "phones")}};
    snprintf(v->id, sizeof v->id, "%.*s", (int)length, file);
    snprintf(v->name, sizeof v->name, "Kokoro %.*s", (int)length - 3, file + 3);
    v->name[7] = (char)toupper((unsigned char)v->name[7]);
    double gain = json_number_value(json_object_get(json_object_get(voices->table, "gains"), v->id));
    v->gain = gain > 0 ? gain : 1;
    size_t size = strlen(folder) + strlen(file) + 2;
    v->file = mem_alloc(size);
    snprintf(v->file, size, "%s/%s", folder, file);
    v->info = (struct faccia_voice_info){.lang = lang,
                                         .gender = sex,
                                         .quality = "neural",
                                         .licence = "Apache-2.0",
                                         .sample_rate = KO_RATE,
                                         .rate = KO_WORDS_PER_MINUTE};
}

static int by_id(const void *a, const void *b) {
    return strcmp(((const struct ko_voice *)a)->id, ((const struct ko_voice *)b)->id);
}

static int read_folder(struct ko_voices *voices, const char *folder, char *message, size_t cap) {
    DIR *dir = opendir(folder);
    if (!dir) {
        snprintf(message, cap, "the voices in %s cannot be read: %s", folder, strerror(errno));
        return -1;
    }
    for (const struct dirent *entry; (entry = readdir(dir)) != NULL;) {
        size_t length = strlen(entry->d_name);
        if (length > strlen(SUFFIX) && !strcmp(entry->d_name + length - strlen(SUFFIX), SUFFIX))
            add(voices, folder, entry->d_name);
    }
    closedir(dir);
    if (!voices->count) {
        snprintf(message, cap, "there are no voices in %s", folder);
        return -1;
    }
    qsort(voices->list, voices->count, sizeof *voices->list, by_id);
    for (size_t i = 0; i < voices->count; i++) {
        voices->list[i].info.id = voices->list[i].id;
        voices->list[i].info.name = voices->list[i].name;
    }
    return 0;
}

int ko_voices_load(struct ko_voices *voices, const char *table, const char *vocabulary, const char *folder,
                   char *message, size_t cap) {
    json_error_t error;
    const char *file = table;
    voices->table = json_load_file(table, 0, &error);
    json_t *tokenizer = NULL;
    if (voices->table)
        tokenizer = json_load_file(file = vocabulary, 0, &error);
    if (!tokenizer) {
        snprintf(message, cap, "%s, line %d: %s", file, error.line, error.text);
        return -1;
    }
    voices->vocabulary = json_incref(json_object_get(json_object_get(tokenizer, "model"), "vocab"));
    json_decref(tokenizer);
    if (!json_object_size(voices->vocabulary)) {
        snprintf(message, cap, "%s has no vocabulary", vocabulary);
        return -1;
    }
    return read_folder(voices, folder, message, cap);
}

void ko_voices_free(struct ko_voices *voices) {
    for (size_t i = 0; i < voices->count; i++)
        free(voices->list[i].file);
    free(voices->list);
    json_decref(voices->table);
    json_decref(voices->vocabulary);
    *voices = (struct ko_voices){0};
}

const struct ko_voice *ko_voices_find(const struct ko_voices *voices, const char *id) {
    for (size_t i = 0; i < voices->count; i++)
        if (!strcmp(voices->list[i].id, id))
            return &voices->list[i];
    return NULL;
}

bool ko_voice_style(const struct ko_voice *voice, size_t tokens, float style[KO_STYLE], char *message,
                    size_t cap) {
    FILE *file = fopen(voice->file, "rb");
    bool read = file && fseek(file, (long)(tokens * KO_STYLE * sizeof *style), SEEK_SET) == 0 &&
                fread(style, sizeof *style, KO_STYLE, file) == KO_STYLE;
    if (file)
        fclose(file);
    if (!read)
        snprintf(message, cap, "the voice %s has no style for %zu tokens", voice->file, tokens);
    return read;
}

#define DURATIONS "/encoder/Clip_output_0"

enum { IN_TOKENS, IN_STYLE, IN_SPEED, INPUTS };
enum { OUT_WAVE, OUT_DURATIONS, OUTPUTS };

static const char *const input_names[INPUTS] = {"input_ids", "style", "speed"};
static const char *const output_names[OUTPUTS] = {"waveform", DURATIONS};

struct ko_model {
    void *library;
    const OrtApi *api;
    OrtEnv *env;
    OrtSession *session;
    OrtMemoryInfo *memory;
    OrtRunOptions *run;
};

/* Returns true on success, else false with a message. */
static bool well(const struct ko_model *m, OrtStatus *status, char *message, size_t cap) {
    if (!status)
        return true;
    snprintf(message, cap, "ONNX Runtime: %s", m->api->GetErrorMessage(status));
    m->api->ReleaseStatus(status);
    return false;
}

static bool read_file(struct buf *model, FILE *file) {
    size_t size;
    do {
        uint8_t *to = buf_reserve(model, 1 << 20);
        size = fread(to, 1, 1 << 20, file);
        model->size += size;
    } while (size);
    return !ferror(file);
}

/* Opens a part of the model, in one of three packages. */
static FILE *open_part(const char *folder, int part) {
    FILE *file = NULL;
    for (const char *package = "abc"; *package && !file; package++) {
        char path[4096];
        snprintf(path, sizeof path, "%s/kokoro-fp32%c-shards/kokoro-fp32.part%d.bin", folder, *package, part);
        file = fopen(path, "rb");
    }
    return file;
}

/* Joins the parts. */
static bool read_parts(struct buf *model, const char *folder, char *message, size_t cap) {
    bool read = true;
    FILE *file;
    for (int part = 0; read && (file = open_part(folder, part)) != NULL; part++) {
        read = read_file(model, file);
        fclose(file);
    }
    if (read && model->size)
        return true;
    snprintf(message, cap, "the model in %s cannot be read", folder);
    return false;
}

static bool load_library(struct ko_model *m, const char *path, char *message, size_t cap) {
    m->library = dlopen(path, RTLD_NOW | RTLD_LOCAL);
    if (!m->library) {
        snprintf(message, cap, "%s", dlerror());
        return false;
    }
    const OrtApiBase *(*base)(void);
    void *symbol = dlsym(m->library, "OrtGetApiBase");
    memcpy(&base, &symbol, sizeof base);
    m->api = symbol ? base()->GetApi(ORT_API_VERSION) : NULL;
    if (!m->api)
        snprintf(message, cap, "%s is no ONNX Runtime with version %d of its interface", path,
                 ORT_API_VERSION);
    return m->api != NULL;
}

/* Waiting threads must sleep instead of spinning. */
static bool set_options(struct ko_model *m, OrtSessionOptions *options, unsigned threads, char *message,
                        size_t cap) {
    const OrtApi *api = m->api;
    return well(m, api->SetIntraOpNumThreads(options, (int)threads), message, cap) &&
           well(m, api->SetInterOpNumThreads(options, 1), message, cap) &&
           well(m, api->AddSessionConfigEntry(options, "session.intra_op.allow_spinning", "0"), message, cap);
}

static bool start(struct ko_model *m, const struct buf *model, unsigned threads, char *message, size_t cap) {
    const OrtApi *api = m->api;
    OrtSessionOptions *options = NULL;
    bool ok =
        well(m, api->CreateEnv(ORT_LOGGING_LEVEL_ERROR, "faccia", &m->env), message, cap) &&
        well(m, api->DisableTelemetryEvents(m->env), message, cap) &&
        well(m, api->CreateSessionOptions(&options), message, cap) &&
        set_options(m, options, threads, message, cap) &&
        well(m, api->CreateSessionFromArray(m->env, model->data, model->size, options, &m->session), message,
             cap) &&
        well(m, api->CreateCpuMemoryInfo(OrtArenaAllocator, OrtMemTypeDefault, &m->memory), message, cap) &&
        well(m, api->CreateRunOptions(&m->run), message, cap);
    if (options)
        api->ReleaseSessionOptions(options);
    return ok;
}

struct ko_model *ko_model_load(const struct ko_model_files *files, unsigned threads, char *message,
                               size_t cap) {
    struct ko_model *m = mem_alloc(sizeof *m);
    struct buf model = {0};
    bool ok =
        load_library(m, files->library, message, cap) && read_parts(&model, files->folder, message, cap);
    if (ok && !ko_onnx_expose(&model, DURATIONS)) {
        snprintf(message, cap, "the model has no tensor %s", DURATIONS);
        ok = false;
    }
    ok = ok && start(m, &model, threads, message, cap);
    buf_free(&model);
    if (ok)
        return m;
    ko_model_free(m);
    return NULL;
}

void ko_model_free(struct ko_model *m) {
    if (!m)
        return;
    if (m->run)
        m->api->ReleaseRunOptions(m->run);
    if (m->memory)
        m->api->ReleaseMemoryInfo(m->memory);
    if (m->session)
        m->api->ReleaseSession(m->session);
    if (m->env)
        m->api->ReleaseEnv(m->env);
    if (m->library)
        dlclose(m->library);
    free(m);
}

static double half(uint16_t bits) {
    int exponent = bits >> 10 & 31;
    double fraction = bits & 1023;
    double value = exponent ? ldexp(1024 + fraction, exponent - 25) : ldexp(fraction, -24);
    return bits >> 15 ? -value : value;
}

/* Reads a number of a tensor of a supported type. */
static double number_at(const void *data, ONNXTensorElementDataType type, size_t i) {
    switch (type) {
    case ONNX_TENSOR_ELEMENT_DATA_TYPE_FLOAT:
        return ((const float *)data)[i];
    case ONNX_TENSOR_ELEMENT_DATA_TYPE_FLOAT16:
        return half(((const uint16_t *)data)[i]);
    case ONNX_TENSOR_ELEMENT_DATA_TYPE_INT64:
        return (double)((const int64_t *)data)[i];
    default:
        return 0;
    }
}

struct tensor {
    void *data;
    size_t count;
    ONNXTensorElementDataType type;
};

static bool open_tensor(struct ko_model *m, OrtValue *value, struct tensor *t, char *message, size_t cap) {
    OrtTensorTypeAndShapeInfo *info = NULL;
    bool ok = well(m, m->api->GetTensorTypeAndShape(value, &info), message, cap) &&
              well(m, m->api->GetTensorShapeElementCount(info, &t->count), message, cap) &&
              well(m, m->api->GetTensorElementType(info, &t->type), message, cap) &&
              well(m, m->api->GetTensorMutableData(value, &t->data), message, cap);
    if (info)
        m->api->ReleaseTensorTypeAndShapeInfo(info);
    return ok;
}

static bool take(struct ko_model *m, OrtValue *const *values, size_t tokens, double gain,
                 struct ko_speech *speech, char *message, size_t cap) {
    struct tensor wave, durations;
    if (!open_tensor(m, values[OUT_WAVE], &wave, message, cap) ||
        !open_tensor(m, values[OUT_DURATIONS], &durations, message, cap))
        return false;
    if (durations.count != tokens || wave.count > UINT32_MAX / 2) {
        snprintf(message, cap, "the model answered with %zu durations for %zu tokens", durations.count,
                 tokens);
        return false;
    }
    speech->durations = mem_alloc(tokens * sizeof *speech->durations);
    for (size_t i = 0; i < tokens; i++)
        speech->durations[i] =
            (uint16_t)fmin(fmax(round(number_at(durations.data, durations.type, i)), 0), 10000);
    speech->sample_count = (uint32_t)wave.count;
    speech->samples = mem_alloc((wave.count + 1) * sizeof *speech->samples);
    for (size_t i = 0; i < wave.count; i++) {
        double sample = number_at(wave.data, wave.type, i) * gain * 32767;
        if (!isfinite(sample)) {
            snprintf(message, cap, "the model's sound is not a number");
            return false;
        }
        speech->samples[i] = (int16_t)fmin(fmax(round(sample), -32767), 32767);
    }
    return true;
}

bool ko_model_run(struct ko_model *m, const int64_t *tokens, size_t count, const float style[KO_STYLE],
                  float speed, double gain, struct ko_speech *speech, char *message, size_t cap) {
    const OrtApi *api = m->api;
    const int64_t tokens_shape[] = {1, (int64_t)count}, style_shape[] = {1, KO_STYLE}, speed_shape[] = {1};
    OrtValue *in[INPUTS] = {0}, *out[OUTPUTS] = {0};
    bool ok = false;
    *speech = (struct ko_speech){0};
    bool ready = well(m,
                      api->CreateTensorWithDataAsOrtValue(
                          m->memory, (void *)tokens, count * sizeof *tokens, tokens_shape, 2,
                          ONNX_TENSOR_ELEMENT_DATA_TYPE_INT64, &in[IN_TOKENS]),
                      message, cap) &&
                 well(m,
                      api->CreateTensorWithDataAsOrtValue(m->memory, (void *)style, KO_STYLE * sizeof *style,
                                                          style_shape, 2, ONNX_TENSOR_ELEMENT_DATA_TYPE_FLOAT,
                                                          &in[IN_STYLE]),
                      message, cap) &&
                 well(m,
                      api->CreateTensorWithDataAsOrtValue(m->memory, &speed, sizeof speed, speed_shape, 1,
                                                          ONNX_TENSOR_ELEMENT_DATA_TYPE_FLOAT, &in[IN_SPEED]),
                      message, cap);
    if (ready && well(m,
                      api->Run(m->session, m->run, input_names, (const OrtValue *const *)in, INPUTS,
                               output_names, OUTPUTS, out),
                      message, cap))
        ok = take(m, out, count, gain, speech, message, cap);
    for (int i = 0; i < INPUTS; i++)
        if (in[i])
            api->ReleaseValue(in[i]);
    for (int i = 0; i < OUTPUTS; i++)
        if (out[i])
            api->ReleaseValue(out[i]);
    if (!ok)
        ko_speech_free(speech);
    return ok;
}

void ko_speech_free(struct ko_speech *speech) {
    free(speech->samples);
    free(speech->durations);
    *speech = (struct ko_speech){0};
}

/* These cannot fail: they set a flag. */
void ko_model_stop(struct ko_model *m) {
    m->api->ReleaseStatus(m->api->RunOptionsSetTerminate(m->run));
}

void ko_model_resume(struct ko_model *m) {
    m->api->ReleaseStatus(m->api->RunOptionsUnsetTerminate(m->run));
}
