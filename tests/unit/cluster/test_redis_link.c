/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Detecting a silent Redis: not confused by a loop that was itself blocked, nor by one that keeps
 * sending. */
#include "server/base/mem.h"
#include "server/cluster/redis_internal.h"
#include <pthread.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cmocka.h>

/* A server that answers each PING at once, or nothing once it is mute. */
struct server {
    int listening;
    atomic_bool mute;
    pthread_t thread;
    char path[64];
};

static void *serve(void *data) {
    struct server *server = data;
    int client = accept(server->listening, NULL, NULL);
    char text[4096];
    for (ssize_t size; (size = read(client, text, sizeof text - 1)) > 0;) {
        text[size] = 0;
        for (const char *at = text; !server->mute && (at = strstr(at, "PING")); at++)
            if (send(client, "+PONG\r\n", 7, MSG_NOSIGNAL) != 7)
                break;
    }
    close(client);
    return NULL;
}

static void start(struct server *server) {
    struct sockaddr_un at = {.sun_family = AF_UNIX};
    *server = (struct server){.listening = socket(AF_UNIX, SOCK_STREAM, 0)};
    snprintf(server->path, sizeof server->path, "/tmp/faccia-link-%d", (int)getpid());
    snprintf(at.sun_path, sizeof at.sun_path, "%s", server->path);
    unlink(server->path);
    assert_int_equal(bind(server->listening, (struct sockaddr *)&at, sizeof at), 0);
    assert_int_equal(listen(server->listening, 1), 0);
    assert_int_equal(pthread_create(&server->thread, NULL, serve, server), 0);
}

enum { TURNS = 9 };

struct seen {
    int ups, downs, asked, answers, unanswered;
};

static void on_changed(void *ctx, bool up) {
    struct seen *seen = ctx;
    *(up ? &seen->ups : &seen->downs) += 1;
}

static void on_pong(void *ctx, const redisReply *reply) {
    struct seen *seen = ctx;
    seen->answers += reply != NULL;
}

struct asker {
    union {
        uv_check_t after_poll;
        uv_poll_t always;
    };
    struct redis_link *link;
    struct seen *seen;
};

/* Sends after the loop's poll: it leaves with the next poll and is answered in the one after. */
static void ask(uv_check_t *check) {
    struct asker *asker = check->data;
    struct link_text ping = link_text_of("PING");
    if (asker->seen->asked == asker->seen->answers)
        asker->seen->asked += redis_link_send(asker->link, &ping, 1, on_pong, asker->seen);
}

static void a_loop_that_was_away_reads_before_it_judges(void **state) {
    uv_loop_t loop;
    struct server server;
    struct seen seen = {0};
    struct asker asker = {.seen = &seen};
    (void)state;
    start(&server);
    struct redis_address address = {.path = mem_strdup(server.path), .shown = mem_strdup("here")};
    uv_loop_init(&loop);
    asker.link = redis_link_open(&loop, &address, on_changed, &seen);
    while (!seen.ups)
        uv_run(&loop, UV_RUN_ONCE);
    uv_check_init(&loop, &asker.after_poll);
    asker.after_poll.data = &asker;
    uv_check_start(&asker.after_poll, ask);
    /* blocks longer than a server may be silent */
    for (int turn = 0; turn < TURNS; turn++) {
        usleep(1000 * (LINK_PATIENCE_MS + 100));
        uv_run(&loop, UV_RUN_NOWAIT);
    }
    assert_int_equal(seen.downs, 0);
    assert_true(seen.answers >= TURNS / 3);
    server.mute = true;
    while (!seen.downs)
        uv_run(&loop, UV_RUN_ONCE);
    redis_link_close(asker.link);
    uv_close((uv_handle_t *)&asker.after_poll, NULL);
    uv_run(&loop, UV_RUN_DEFAULT);
    assert_int_equal(uv_loop_close(&loop), 0);
    pthread_join(server.thread, NULL);
    close(server.listening);
    unlink(server.path);
}

/* Sends in each iteration, before Redis's answers are read. */
static void ask_on(uv_poll_t *poll, int status, int events) {
    struct asker *asker = poll->data;
    struct link_text ping = link_text_of("PING");
    (void)status, (void)events;
    asker->seen->asked += redis_link_send(asker->link, &ping, 1, on_pong, asker->seen);
    redis_link_flush(asker->link);
}

static void what_is_sent_in_each_turn_keeps_no_answer_from_being_read(void **state) {
    enum { TURNS_MOST = 100000, ANSWERS = 10 };
    uv_loop_t loop;
    struct server server;
    struct seen seen = {0};
    struct asker asker = {.seen = &seen};
    int readable[2];
    (void)state;
    start(&server);
    struct redis_address address = {.path = mem_strdup(server.path), .shown = mem_strdup("here")};
    assert_int_equal(pipe(readable), 0);
    assert_int_equal(write(readable[1], "", 1), 1);
    uv_loop_init(&loop);
    uv_poll_init(&loop, &asker.always, readable[0]);
    asker.always.data = &asker;
    asker.link = redis_link_open(&loop, &address, on_changed, &seen);
    while (!seen.ups)
        uv_run(&loop, UV_RUN_ONCE);
    uv_poll_start(&asker.always, UV_READABLE, ask_on);
    for (int turn = 0; turn < TURNS_MOST && seen.answers < ANSWERS && !seen.downs; turn++)
        uv_run(&loop, UV_RUN_NOWAIT);
    assert_int_equal(seen.downs, 0);
    assert_true(seen.answers >= ANSWERS);
    redis_link_close(asker.link);
    uv_close((uv_handle_t *)&asker.always, NULL);
    uv_run(&loop, UV_RUN_DEFAULT);
    assert_int_equal(uv_loop_close(&loop), 0);
    pthread_join(server.thread, NULL);
    close(server.listening);
    close(readable[0]);
    close(readable[1]);
    unlink(server.path);
}

/* Sends more after each answer or failure, like the bus. */
static void send_more(void *ctx, const redisReply *reply) {
    struct asker *asker = ctx;
    struct link_text ping = link_text_of("PING");
    asker->seen->answers += reply != NULL;
    if (reply)
        return;
    asker->seen->asked += redis_link_up(asker->link);
    asker->seen->asked += redis_link_send(asker->link, &ping, 1, on_pong, asker->seen);
    redis_link_flush(asker->link);
    asker->seen->unanswered++;
}

static void what_a_lost_link_ends_finds_it_lost(void **state) {
    uv_loop_t loop;
    struct server server;
    struct seen seen = {0};
    struct asker asker = {.seen = &seen};
    struct link_text ping = link_text_of("PING");
    (void)state;
    start(&server);
    struct redis_address address = {.path = mem_strdup(server.path), .shown = mem_strdup("here")};
    uv_loop_init(&loop);
    asker.link = redis_link_open(&loop, &address, on_changed, &seen);
    while (!seen.ups)
        uv_run(&loop, UV_RUN_ONCE);
    server.mute = true;
    assert_true(redis_link_send(asker.link, &ping, 1, send_more, &asker));
    redis_link_flush(asker.link);
    redis_link_close(asker.link);
    assert_int_equal(seen.unanswered, 1);
    assert_int_equal(seen.asked, 0);
    uv_run(&loop, UV_RUN_DEFAULT);
    assert_int_equal(uv_loop_close(&loop), 0);
    pthread_join(server.thread, NULL);
    close(server.listening);
    unlink(server.path);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_a_lost_link_ends_finds_it_lost),
        cmocka_unit_test(a_loop_that_was_away_reads_before_it_judges),
        cmocka_unit_test(what_is_sent_in_each_turn_keeps_no_answer_from_being_read),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
