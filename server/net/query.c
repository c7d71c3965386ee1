/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/net/query.h"
#include "server/base/suggest.h"
#include "server/net/http_request.h"
#include "server/synthesis/speech_request.h"
#include <string.h>

static void check(const char *name, const struct members *known,
                  void (*warn)(void *ctx, const struct error *e), void *ctx) {
    struct suggestions near = suggestions_for(name);
    struct error e;
    char text[SUGGESTIONS_TEXT];
    const char *field;
    for (const char *const *more = known->more; more && *more; more++) {
        if (!strcmp(*more, name))
            return;
        suggest_name(&near, *more, *more);
    }
    for (size_t i = 0; known->speech && (field = request_field(i)); i++) {
        if (!strcmp(field, "text"))
            continue;
        if (!strcmp(field, name))
            return;
        suggest_name(&near, field, field);
    }
    error_in_field(&e, ERROR_UNKNOWN_MEMBER, name, "no member '%.60s'%s", name,
                   suggestions_text(&near, text));
    warn(ctx, &e);
}

void query_check(const struct http_request *request, const struct members *known, bool text,
                 void (*warn)(void *ctx, const struct error *e), void *ctx) {
    for (size_t i = 0; i < request->member_count; i++)
        if (strcmp(request->members[i].name, "token") && /* good everywhere */
            (!text || strcmp(request->members[i].name, "text")))
            check(request->members[i].name, known, warn, ctx);
}

void members_check(const json_t *object, const struct members *known,
                   void (*warn)(void *ctx, const struct error *e), void *ctx) {
    const char *name;
    json_t *value;
    json_object_foreach((json_t *)object, name, value) check(name, known, warn, ctx);
}

int query_flag(const char *value, const char *name, bool *flag, struct error *e) {
    bool yes = value && (!strcmp(value, "1") || !strcmp(value, "true"));
    bool no = !value || !strcmp(value, "0") || !strcmp(value, "false");
    *flag = yes;
    return yes || no ? 0 : error_in_field(e, ERROR_BAD_FIELD, name, "must be true or false");
}
