/* SPDX-License-Identifier: GPL-3.0-or-later */
/* faccia camera: the face of a room as a camera of this machine. */
#include "server/base/buf.h"
#include "server/base/mem.h"
#include "server/bridges/bridge.h"
#include "server/bridges/remote_internal.h"
#include "server/cli/cli.h"
#include "server/film/film_browser.h"
#include "server/film/film_cast.h"
#include "server/film/film_coder.h"
#include "server/film/film_folder.h"
#include "server/film/film_process.h"
#include <errno.h>
#include <fcntl.h>
#include <linux/videodev2.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <unistd.h>

static const char usage[] =
    "Usage: faccia camera --room ROOM [OPTION]... DEVICE\n"
    "Shows the face of a room in a running facciad in a virtual camera, which calls and streams can take for "
    "a\n"
    "webcam: DEVICE is one of v4l2loopback, such as /dev/video10 (package v4l2loopback-dkms; modprobe\n"
    "v4l2loopback exclusive_caps=1 card_label=faccia). With -, the pictures go to standard output as Motion "
    "JPEG.\n"
    "Needs chromium-headless-shell or chromium, and for a DEVICE ffmpeg.\n"
    "\n"
    "      --room ROOM      the room\n"
    "      --size WxH       pixels, even, 64x64 to 1920x1080 (640x480)\n"
    "      --fps N          pictures per second, 1 to 60 (25)\n"
    "      --model NAME     the head (the daemon's first)\n"
    "      --view VIEW      what is seen of it\n"
    "      --background COLOUR  as in CSS (#20303c)\n"
    "      --url URL        the daemon (FACCIA_URL, else http://127.0.0.1:8080)\n"
    "      --token-file FILE  its token (else FACCIA_TOKEN)\n"
    "  -h, --help           print this and exit\n"
    "The sound is not in it: it is that of a page of the room. Ctrl-C ends it. Exit status: 0 ended by a "
    "signal,\n"
    "1 failed, 2 wrong usage.\n";

enum { SIGNALS = 2, WIDTH_MOST = 1920, HEIGHT_MOST = 1080, SIDE_LEAST = 64 };

struct camera {
    const char *room, *size, *model, *view, *background, *url, *token_file, *device;
    int fps;
    unsigned width, height;
    struct daemon_address place;
    uv_loop_t loop;
    uv_signal_t signals[SIGNALS];
    uv_timer_t clock;
    struct film_cast *cast;
    struct film_process *coder; /* NULL: standard output */
    struct film_folder folder;
    struct buf picture, written; /* the last one; what is being written */
    uv_fs_t write;
    size_t done; /* bytes of it */
    bool writing, ended, failed;
};

static void end(struct camera *c, bool failed) {
    c->failed |= failed && !c->ended;
    c->ended = true;
    uv_stop(&c->loop);
}

static void on_signal(uv_signal_t *signal, int number) {
    (void)number;
    end(signal->data, false);
}

/* ---- the pictures: the last one, again and again, as cameras do; those for which there is no time are left
 * out ---- */

static void on_taken(void *ctx, int status) {
    struct camera *c = ctx;
    (void)status; /* the end of the program is told anyway */
    c->writing = false;
}

static void write_rest(struct camera *c);

static void on_written(uv_fs_t *request) {
    struct camera *c = request->data;
    ssize_t count = request->result;
    uv_fs_req_cleanup(request);
    c->writing = false;
    if (count < 0) {
        if (!c->ended)
            cli_complain("standard output: %s", uv_strerror((int)count));
        end(c, true);
        return;
    }
    c->done += (size_t)count;
    if (c->done < c->written.size)
        write_rest(c);
}

static void write_rest(struct camera *c) {
    uv_buf_t rest = uv_buf_init((char *)c->written.data + c->done, (unsigned)(c->written.size - c->done));
    c->write.data = c;
    c->writing = true;
    uv_fs_write(&c->loop, &c->write, STDOUT_FILENO, &rest, 1, -1, on_written);
}

static void on_clock(uv_timer_t *timer) {
    struct camera *c = timer->data;
    if (c->writing || !c->picture.size)
        return;
    c->written.size = 0;
    buf_add(&c->written, c->picture.data, c->picture.size);
    c->done = 0;
    c->writing = true;
    if (c->coder)
        film_process_write(c->coder, c->written.data, c->written.size, on_taken, c);
    else
        write_rest(c);
}

static void on_picture(void *ctx, const uint8_t *jpeg, size_t size) {
    struct camera *c = ctx;
    if (!c->picture.size)
        cli_complain("the room %.100s is shown in %.200s; Ctrl-C ends it", c->room,
                     c->coder ? c->device : "standard output");
    c->picture.size = 0;
    buf_add(&c->picture, jpeg, size);
}

static void on_failed(void *ctx, const struct error *e) {
    cli_complain("camera: %s", e->message);
    end(ctx, true);
}

static void on_coder_ended(void *ctx, bool well) {
    struct camera *c = ctx;
    (void)well;
    if (!c->ended)
        cli_complain("camera: ffmpeg has ended: %s", film_process_said(c->coder));
    end(c, true);
}

/* ---- what is needed ---- */

/* Returns 0 if pictures can be put into the device; otherwise -1 after a message. */
static int check_device(const char *path) {
    struct v4l2_capability can = {0};
    int device = open(path, O_RDWR | O_CLOEXEC | O_NONBLOCK);
    if (device < 0) {
        cli_complain("%s: %s%s", path, strerror(errno),
                     errno == ENOENT ? "; v4l2loopback makes such devices (faccia camera --help)" : "");
        return -1;
    }
    int status = ioctl(device, VIDIOC_QUERYCAP, &can);
    close(device);
    unsigned powers = can.capabilities & V4L2_CAP_DEVICE_CAPS ? can.device_caps : can.capabilities;
    if (!status && powers & V4L2_CAP_VIDEO_OUTPUT)
        return 0;
    cli_complain("%s: this is %s, and no device of v4l2loopback", path,
                 status ? "no video device" : "a camera of its own");
    return -1;
}

static int check(const struct camera *c) {
    if (!film_browser_found()) {
        cli_complain("camera: no browser in PATH: install Debian's chromium-headless-shell");
        return -1;
    }
    if (!strcmp(c->device, "-"))
        return 0;
    if (!film_coder_found()) {
        cli_complain("camera: no ffmpeg in PATH: install Debian's ffmpeg");
        return -1;
    }
    return check_device(c->device);
}

static int read_size(struct camera *c) {
    char rest;
    if (sscanf(c->size, "%4ux%4u%c", &c->width, &c->height, &rest) == 2 && c->width % 2 == 0 &&
        c->height % 2 == 0 && c->width >= SIDE_LEAST && c->height >= SIDE_LEAST && c->width <= WIDTH_MOST &&
        c->height <= HEIGHT_MOST)
        return 0;
    cli_complain("--size: '%s' is no size, such as 640x480", c->size);
    return -1;
}

static int start_coder(struct camera *c, struct error *e) {
    char fps[16];
    snprintf(fps, sizeof fps, "%d", c->fps);
    const char *args[] = {
        "ffmpeg", "-nostdin", "-hide_banner", "-loglevel",      "error", "-f",   "mjpeg",   "-r", fps,
        "-i",     "pipe:0",   "-vf",          "format=yuv420p", "-f",    "v4l2", c->device, NULL};
    const struct film_process_options options = {
        .args = (char **)args, .given = -1, .folder = c->folder.path, .ended = on_coder_ended, .ctx = c};
    c->coder = film_process_start(&c->loop, &options, e);
    return c->coder ? 0 : -1;
}

static int start(struct camera *c, struct error *e) {
    const struct remote_member members[] = {
        {"room", c->room},   {"model", c->model},       {"view", c->view}, {"background", c->background},
        {"quality", "high"}, {"token", c->place.token}, {NULL, NULL}};
    struct buf url = {0};
    if (strcmp(c->device, "-") != 0 && start_coder(c, e))
        return -1;
    remote_address(&url, c->place.url, "/stage.html", members);
    buf_add(&url, "", 1);
    int status = film_cast_start(c->cast, (const char *)url.data, c->width, c->height, c->folder.path, e);
    buf_free(&url);
    return status;
}

static int run(struct camera *c) {
    static const struct film_cast_calls calls = {on_picture, on_failed};
    static const int numbers[SIGNALS] = {SIGINT, SIGTERM};
    struct error e;
    if (film_folder_make(&c->folder, "/tmp/faccia-camera")) {
        cli_complain("/tmp/faccia-camera: %s", strerror(errno));
        return EXIT_FAILED;
    }
    uv_loop_init(&c->loop);
    uv_timer_init(&c->loop, &c->clock);
    c->clock.data = c;
    for (int i = 0; i < SIGNALS; i++) {
        uv_signal_init(&c->loop, &c->signals[i]);
        c->signals[i].data = c;
        uv_signal_start(&c->signals[i], on_signal, numbers[i]);
    }
    c->cast = film_cast_new(&c->loop, &calls, c);
    if (start(c, &e)) {
        on_failed(c, &e);
    } else {
        uv_timer_start(&c->clock, on_clock, 0, (uint64_t)(1000 / c->fps));
        uv_run(&c->loop, UV_RUN_DEFAULT);
    }
    film_cast_close(c->cast);
    film_process_close(c->coder);
    uv_close((uv_handle_t *)&c->clock, NULL);
    for (int i = 0; i < SIGNALS; i++)
        uv_close((uv_handle_t *)&c->signals[i], NULL);
    uv_run(&c->loop, UV_RUN_DEFAULT);
    film_cast_free(c->cast);
    uv_loop_close(&c->loop);
    film_folder_remove(&c->folder);
    buf_free(&c->picture);
    buf_free(&c->written);
    return c->failed ? EXIT_FAILED : EXIT_DONE;
}

int camera_main(int argc, char **argv, const struct settings *settings) {
    struct camera c = {.size = "640x480", .fps = 25, .background = "#20303c"};
    const struct cli_option options[] = {{"room", 0, CLI_TEXT, &c.room, 0, 0, NULL},
                                         {"size", 0, CLI_TEXT, &c.size, 0, 0, NULL},
                                         {"fps", 0, CLI_WHOLE, &c.fps, 1, 60, NULL},
                                         {"model", 0, CLI_TEXT, &c.model, 0, 0, NULL},
                                         {"view", 0, CLI_TEXT, &c.view, 0, 0, NULL},
                                         {"background", 0, CLI_TEXT, &c.background, 0, 0, NULL},
                                         {"url", 0, CLI_TEXT, &c.url, 0, 0, NULL},
                                         {"token-file", 0, CLI_TEXT, &c.token_file, 0, 0, NULL},
                                         {0}};
    (void)settings;
    int status = cli_options(argc, argv, usage, options, NULL);
    if (status >= 0)
        return status;
    if (!c.room || argc - optind != 1) {
        cli_complain("camera: expected --room and one device");
        return EXIT_USAGE;
    }
    c.device = argv[optind];
    if (read_size(&c))
        return EXIT_USAGE;
    if (check(&c))
        return EXIT_FAILED;
    daemon_address_open(&c.place);
    if (c.url)
        c.place.url = c.url;
    status = c.token_file && daemon_address_read_token(&c.place, c.token_file) ? EXIT_FAILED : run(&c);
    daemon_address_close(&c.place);
    return status;
}
