/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/buf.h"
#include "server/base/mem.h"
#include "server/base/utf8.h"
#include "server/bridges/satellite/satellite.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <time.h>

enum { NAME_MOST = 200, SHOWN = 3 };

static struct timer *find(struct timers *t, const char *id) {
    for (unsigned i = 0; id && i < t->count; i++)
        if (!strcmp(t->all[i].id, id))
            return &t->all[i];
    return NULL;
}

static void drop(struct timers *t, struct timer *one) {
    free(one->id);
    free(one->name);
    *one = t->all[--t->count];
}

static void start(struct timers *t, const char *id, const json_t *data, int64_t now) {
    const char *name = json_string_value(json_object_get(data, "name"));
    if (find(t, id))
        drop(t, find(t, id));
    if (t->count == TIMERS)
        return;
    struct timer *one = &t->all[t->count++];
    *one = (struct timer){.id = mem_strdup(id), .name = name && *name ? mem_strndup(name, NAME_MOST) : NULL};
    if (one->name)
        utf8_mend(one->name);
    one->end = now + (int64_t)json_number_value(json_object_get(data, "total_seconds"));
}

static char *over(const struct timer *one, const char *lang) {
    static const struct {
        const char *lang, *named, *plain;
    } texts[] = {{"en", "The timer for %s has finished.", "The timer has finished."},
                 {"it", "Il timer per %s è scaduto.", "Il timer è scaduto."},
                 {"pt", "O temporizador de %s terminou.", "O temporizador terminou."},
                 {"tr", "%s zamanlayıcısı bitti.", "Zamanlayıcı bitti."}};
    struct buf text = {0};
    size_t i = sizeof texts / sizeof *texts;
    while (--i && (!lang || strncasecmp(lang, texts[i].lang, 2) != 0))
        ;
    const char *form = one && one->name ? texts[i].named : texts[i].plain, *gap = strstr(form, "%s");
    if (gap)
        buf_printf(&text, "%.*s%s%s", (int)(gap - form), form, one->name, gap + 2);
    else
        buf_printf(&text, "%s", form);
    buf_add(&text, "", 1);
    return (char *)text.data;
}

char *timers_take(struct timers *t, const char *type, const json_t *data, const char *lang, int64_t now) {
    const char *id = json_string_value(json_object_get(data, "id")), *what = type + strlen("timer-");
    struct timer *one = find(t, id);
    char *text = NULL;
    if (!strcmp(what, "started") && id)
        start(t, id, data, now);
    else if (!strcmp(what, "updated") && one)
        one->end = json_is_false(json_object_get(data, "is_active"))
                       ? 0
                       : now + (int64_t)json_number_value(json_object_get(data, "total_seconds"));
    else if (!strcmp(what, "finished"))
        text = over(one, lang);
    if (one && (!strcmp(what, "finished") || !strcmp(what, "cancelled")))
        drop(t, one);
    return text;
}

static int by_end(const void *a, const void *b) {
    const int64_t x = ((const struct timer *)a)->end, y = ((const struct timer *)b)->end;
    return (x > y) - (x < y);
}

void timers_text(const struct timers *t, char *text, size_t cap) {
    struct timers sorted = *t;
    size_t shown = 0;
    *text = '\0';
    qsort(sorted.all, sorted.count, sizeof *sorted.all, by_end);
    for (unsigned i = 0; i < sorted.count && shown < SHOWN; i++) {
        const struct timer *one = &sorted.all[i];
        const time_t end = (time_t)one->end;
        struct tm local;
        char clock[16];
        const size_t at = strlen(text);
        if (!one->end || !localtime_r(&end, &local))
            continue;
        strftime(clock, sizeof clock, "%H:%M", &local);
        snprintf(text + at, cap - at, "%s⌛ %s%s%s", shown++ ? " · " : "", one->name ? one->name : "",
                 one->name ? " " : "", clock);
    }
    utf8_mend(text); /* it may be cut within a character */
}

void timers_free(struct timers *t) {
    while (t->count)
        drop(t, &t->all[0]);
}
