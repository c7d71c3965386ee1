/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/film/film_coder.h"
#include "server/base/mem.h"
#include "server/film/film_process.h"
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    PICTURE_SECONDS = 120, /* for ffmpeg to take a picture */
    FINISH_SECONDS = 600,  /* to write the rest: the colours of a GIF are chosen at its end */
    OUTPUT_FD = 3,
    WORDS = 96,
};

static const char program[] = "ffmpeg";

/* A picture that ffmpeg has not taken yet, or the last one. */
struct picture {
    unsigned uses;
    struct buf pixels;
};

struct film_coder {
    uv_timer_t timer;
    const struct film_coder_calls *calls;
    void *ctx;
    struct film_process *process;
    struct picture *last;
    unsigned waiting; /* writes in progress */
    bool finishing, ended, closed;
};

/* A picture that is being written. */
struct turn {
    struct film_coder *coder;
    struct picture *picture;
};

const char *film_coder_found(void) {
    return film_process_found(program) ? program : NULL;
}

/* The command line of ffmpeg */

struct words {
    char *list[WORDS + 1];
    size_t count;
};

/* Adds words separated by spaces. */
static void say(struct words *w, const char *text) {
    while (*text) {
        size_t length = strcspn(text, " ");
        if (length && w->count < WORDS)
            w->list[w->count++] = mem_strndup(text, length);
        text += length + (text[length] == ' ');
    }
}

/* Adds one word. */
__attribute__((format(printf, 2, 3))) static void word(struct words *w, const char *format, ...) {
    struct buf text = {0};
    char line[8192];
    va_list args;
    va_start(args, format);
    vsnprintf(line, sizeof line, format, args);
    va_end(args);
    buf_add(&text, line, strlen(line) + 1);
    if (w->count < WORDS)
        w->list[w->count++] = (char *)text.data;
}

static void words_free(struct words *w) {
    for (size_t i = 0; i < w->count; i++)
        free(w->list[i]);
}

/* Whether the format stores luma and chroma, not red, green and blue. */
static bool is_yuv(const struct film_coding *c) {
    return (c->format == FILM_MP4 && !c->lossless) || c->format == FILM_WEBM;
}

/* From pixels with alpha multiplied in, lowest line first, to what is coded. */
static void add_filters(struct words *w, const struct film_coding *c) {
    struct buf f = {0};
    buf_printf(&f, "vflip%s", c->transparent ? ",format=gbrap,unpremultiply=inplace=1" : "");
    if (c->captions == FILM_CAPTIONS_BURN)
        buf_printf(&f,
                   ",%ssubtitles=f=captions.vtt%s:force_style='FontName=sans-serif,FontSize=19,MarginV=12'",
                   c->transparent ? "format=rgba," : "", c->transparent ? ":alpha=1" : "");
    if (c->filter)
        buf_printf(&f, ",%s", c->filter);
    if (is_yuv(c))
        buf_printf(&f, ",scale=out_color_matrix=bt709:out_range=tv,format=%s",
                   c->transparent ? "yuva420p" : "yuv420p");
    else if (c->format == FILM_GIF)
        buf_printf(&f,
                   ",format=rgba,split[a][b];[a]palettegen=reserve_transparent=%d[p];"
                   "[b][p]paletteuse=dither=bayer:bayer_scale=4",
                   c->transparent);
    else if (c->format == FILM_WEBP)
        buf_printf(&f, ",format=%s", c->transparent ? "rgba,format=bgra" : "bgra");
    else
        buf_printf(&f, ",format=%s", c->transparent ? "rgba" : "rgb24");
    word(w, "-vf");
    word(w, "%.*s", (int)f.size, (char *)f.data);
    buf_free(&f);
}

static void add_coders(struct words *w, const struct film_coding *c) {
    if (is_yuv(c))
        say(w, "-colorspace bt709 -color_primaries bt709 -color_trc bt709 -color_range tv");
    switch (c->format) {
    case FILM_MP4:
        say(w,
            c->lossless ? "-c:v libx264rgb -preset veryfast -qp 0" : "-c:v libx264 -preset veryfast -crf 18");
        say(w, c->lossless ? "-c:a flac -strict -2" : "-c:a aac -b:a 96k");
        say(w, "-c:s mov_text -movflags +faststart -f mp4");
        break;
    case FILM_WEBM:
        say(w, "-c:v libvpx-vp9 -deadline realtime -cpu-used 6 -row-mt 1 -crf 24 -b:v 0");
        if (c->transparent)
            say(w, "-auto-alt-ref 0");
        say(w, "-c:a libopus -b:a 48k -c:s webvtt -f webm");
        break;
    case FILM_GIF:
        say(w, "-f gif");
        break;
    case FILM_WEBP:
        say(w, "-c:v libwebp_anim -quality 80 -loop 0 -f webp");
        break;
    case FILM_PICTURES:
        say(w, "-c:v png -pred mixed -f image2 -start_number 1");
        break;
    case FILM_STILL:
        say(w, "-c:v png -frames:v 1 -f image2pipe");
        break;
    }
}

static void command(struct words *w, const struct film_coding *c) {
    bool track = c->captions == FILM_CAPTIONS_TRACK;
    say(w, program);
    say(w, "-nostdin -hide_banner -loglevel error -y -f rawvideo -pixel_format");
    say(w, c->transparent ? "rgba" : "rgb0"); /* spares a step that would take the alpha away */
    say(w, "-video_size");
    word(w, "%ux%u", c->width, c->height);
    word(w, "-framerate");
    word(w, "%.12g", c->fps);
    say(w, "-i pipe:0");
    if (c->sound)
        say(w, "-i sound.wav");
    if (track)
        say(w, "-i captions.vtt");
    say(w, "-map 0:v");
    if (c->sound)
        say(w, "-map 1:a");
    if (track)
        word(w, "-map"), word(w, "%d:s", c->sound ? 2 : 1);
    say(w, "-fps_mode passthrough -map_metadata -1 -fflags +bitexact");
    add_filters(w, c);
    add_coders(w, c);
    if (c->format == FILM_PICTURES)
        word(w, "file:%s", c->pattern);
    else
        word(w, "file:/proc/self/fd/%d", OUTPUT_FD);
}

/* Writing */

static void end(struct film_coder *c, const char *why, const char *said) {
    struct error e;
    if (c->ended || c->closed)
        return;
    c->ended = true;
    uv_timer_stop(&c->timer);
    if (why)
        error_set(&e, ERROR_FILM_FAILED, "%s%s%s", why, *said ? ": " : "", said);
    c->calls->ended(c->ctx, why ? &e : NULL);
}

static void on_time(uv_timer_t *timer) {
    struct film_coder *c = timer->data;
    end(c, c->finishing ? "ffmpeg takes too long to finish" : "ffmpeg takes too long for a picture", "");
}

static void on_ended(void *ctx, bool well) {
    struct film_coder *c = ctx;
    end(c, well && c->finishing ? NULL : "ffmpeg has failed", film_process_said(c->process));
}

static void drop(struct picture *picture) {
    if (picture && !--picture->uses) {
        buf_free(&picture->pixels);
        free(picture);
    }
}

static void watch(struct film_coder *c) {
    if (c->closed || c->ended)
        return;
    if (c->waiting || c->finishing)
        uv_timer_start(&c->timer, on_time, 1000 * (c->waiting ? PICTURE_SECONDS : FINISH_SECONDS), 0);
    else
        uv_timer_stop(&c->timer);
}

static void on_written(void *ctx, int status) {
    struct turn *turn = ctx;
    struct film_coder *c = turn->coder;
    drop(turn->picture);
    free(turn);
    c->waiting--;
    watch(c);
    if (c->closed || c->ended || status < 0)
        return; /* ffmpeg has ended, and tells why */
    if (c->finishing && !c->waiting)
        film_process_end_input(c->process);
    c->calls->taken(c->ctx);
}

struct film_coder *film_coder_new(uv_loop_t *loop, const struct film_coder_calls *calls, void *ctx) {
    struct film_coder *c = mem_alloc(sizeof *c);
    c->calls = calls;
    c->ctx = ctx;
    uv_timer_init(loop, &c->timer);
    c->timer.data = c;
    return c;
}

int film_coder_start(struct film_coder *c, const struct film_coding *coding, struct error *e) {
    struct words words = {0};
    command(&words, coding);
    const struct film_process_options options = {.args = words.list,
                                                 .given = coding->file,
                                                 .as = OUTPUT_FD,
                                                 .folder = coding->folder,
                                                 .ended = on_ended,
                                                 .ctx = c};
    c->process = film_process_start(c->timer.loop, &options, e);
    words_free(&words);
    return c->process ? 0 : -1;
}

void film_coder_add(struct film_coder *c, struct buf *pixels) {
    struct turn *turn = mem_alloc(sizeof *turn);
    if (pixels->size) {
        drop(c->last);
        c->last = mem_alloc(sizeof *c->last);
        c->last->uses = 1;
        c->last->pixels = *pixels;
        *pixels = (struct buf){0};
    }
    *turn = (struct turn){c, c->last};
    c->last->uses++;
    c->waiting++;
    watch(c);
    film_process_write(c->process, c->last->pixels.data, c->last->pixels.size, on_written, turn);
}

void film_coder_finish(struct film_coder *c) {
    c->finishing = true;
    watch(c);
    if (!c->waiting)
        film_process_end_input(c->process);
}

void film_coder_close(struct film_coder *c) {
    if (!c)
        return;
    c->closed = true;
    uv_close((uv_handle_t *)&c->timer, NULL);
    film_process_close(c->process);
}

void film_coder_free(struct film_coder *c) {
    if (!c)
        return;
    drop(c->last);
    free(c);
}
