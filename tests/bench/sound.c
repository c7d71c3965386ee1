/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Encodes speech with the daemon's Opus coder and decodes it, for sound.mjs. Usage: sound RATE BITRATE
 * [LEVEL] < PCM > PCM: 16 bit, mono; the output has 48 kHz and is aligned with the input. Prints the number
 * of coded bytes, including lengths, and the CPU ms of coding to standard error. LEVEL: see coder_pool.h. */
#include "server/codec/opus_audio.h"
#include <opus/opus.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

int main(int argc, char **argv) {
    struct buf pcm = {0}, packets = {0};
    int16_t heard[OPUS_PACKET_SAMPLES];
    int error;
    if (argc < 3)
        return 2;
    for (size_t got = 1; got; pcm.size += got)
        got = fread(buf_reserve(&pcm, 65536), 1, 65536, stdin);
    struct opus_audio *o = opus_audio_new((uint32_t)atoi(argv[1]), (unsigned)atoi(argv[2]));
    OpusDecoder *decoder = opus_decoder_create(OPUS_RATE, 1, &error);
    if (!o || !decoder)
        return 1;
    opus_audio_set_level(o, argc > 3 ? (unsigned)atoi(argv[3]) : 0);
    clock_t from = clock();
    opus_audio_add(o, (const int16_t *)(const void *)pcm.data, pcm.size / 2, &packets);
    opus_audio_end(o, &packets);
    double took = (double)(clock() - from) / CLOCKS_PER_SEC;
    size_t skip = opus_audio_skip(o);
    for (const uint8_t *at = packets.data; at < packets.data + packets.size;) {
        int size = *at++;
        if (size >= 252)
            size += 4 * *at++;
        int count = opus_decode(decoder, at, size, heard, OPUS_PACKET_SAMPLES, 0);
        if (count < 0)
            return 1;
        fwrite(heard + skip, sizeof *heard, (size_t)count - skip, stdout);
        skip = 0;
        at += size;
    }
    fprintf(stderr, "%zu %.1f\n", packets.size, took * 1000);
    opus_decoder_destroy(decoder);
    opus_audio_free(o);
    buf_free(&pcm);
    buf_free(&packets);
    return 0;
}
