/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/api/api_internal.h"
#include "server/api/client_internal.h"
#include "server/base/json/field.h"
#include <math.h>
#include <string.h>

struct client_message {
    const char *type;
    const struct field *fields; /* its own fields */
    size_t count;
    const char *const *shared; /* names of fields of speech_request, NULL-terminated; or NULL */
};

struct message_right {
    const char *type;
    enum right right;
};

#include "protocol/client_messages.h" /* generated from protocol/messages.json */

/* NULL: the message has no members, or only those of a request (speak). */
static const struct client_message *find(const char *type) {
    for (size_t i = 0; i < sizeof client_messages / sizeof *client_messages; i++)
        if (!strcmp(client_messages[i].type, type))
            return &client_messages[i];
    return NULL;
}

enum right client_message_right(const char *type) {
    for (size_t i = 0; i < sizeof message_rights / sizeof *message_rights; i++)
        if (!strcmp(message_rights[i].type, type))
            return message_rights[i].right;
    return 0;
}

int client_message_check(const char *type, const json_t *message, struct error *e) {
    const struct client_message *m = find(type);
    for (const struct field *f = m ? m->fields : NULL; m && f < m->fields + m->count; f++) {
        const json_t *member = json_object_get(message, f->name);
        const struct request_value value = value_from_json(member);
        if (!member && !f->required)
            continue;
        if (field_check(f, &value, e)) {
            if (!member)
                e->code = ERROR_MISSING_FIELD;
            return -1;
        }
    }
    return 0;
}

int client_message_request(const char *type, const json_t *message, struct speech_request *request,
                           struct error *e) {
    json_t *own = json_object();
    for (const char *const *name = find(type)->shared; *name; name++)
        json_object_set(own, *name, json_object_get(message, *name));
    int failed = request_from_json(request, own, e);
    json_decref(own);
    return failed;
}
