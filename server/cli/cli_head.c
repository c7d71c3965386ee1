/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/cli/cli_head.h"
#include "server/base/mem.h"
#include "server/cli/cli.h"
#include <errno.h>
#include <glob.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <zlib.h>

static const char head_format[] = "faccia-head";

/* Reads a file of this format, or returns NULL. */
static json_t *model_at(const char *file, const char *format) {
    json_t *model = json_load_file(file, 0, NULL);
    const char *own = json_string_value(json_object_get(model, "format"));
    if (own && !strcmp(own, format))
        return model;
    json_decref(model);
    return NULL;
}

/* The same of a file that an option names: NULL after a message, which says that it is not `what`. */
static json_t *named_model(const char *option, const char *file, const char *format, const char *what) {
    json_t *model = model_at(file, format);
    if (!model && access(file, R_OK))
        cli_complain("%s: %s: %s", option, file, strerror(errno));
    else if (!model)
        cli_complain("%s: %s: this is not a %s", option, file, what);
    return model;
}

json_t *cli_head_find(const struct settings *settings, const char *option, const char *name,
                      char file[PATH_MAX]) {
    char pattern[PATH_MAX];
    glob_t found;
    json_t *best = NULL;
    const char *wanted = name ? name : "*";
    size_t length = strlen(wanted);
    if (strchr(wanted, '/') || (length > 5 && !strcmp(wanted + length - 5, ".json"))) {
        snprintf(file, PATH_MAX, "%s", wanted);
        return named_model(option, wanted, head_format, "head model");
    }
    snprintf(pattern, sizeof pattern, "%s/heads/%s.json", settings->models, wanted);
    if ((name && strpbrk(name, "*?[")) || glob(pattern, 0, NULL, &found)) {
        cli_complain("%s: unknown head '%s'; 'faccia models' lists them", option, wanted);
        return NULL;
    }
    for (size_t i = 0; i < found.gl_pathc; i++) {
        json_t *head = model_at(found.gl_pathv[i], head_format), *rank = json_object_get(head, "rank");
        bool first =
            head && (!best || (json_is_number(rank) &&
                               json_number_value(rank) < json_number_value(json_object_get(best, "rank"))));
        if (first) {
            json_decref(best);
            best = json_incref(head);
            snprintf(file, PATH_MAX, "%s", found.gl_pathv[i]);
        }
        json_decref(head);
    }
    globfree(&found);
    if (!best)
        cli_complain("%s: this is not a head model", pattern);
    return best;
}

static bool is_given(const struct speech_request *request, const char *name) {
    struct request_value value;
    for (size_t i = 0; request_field(i); i++)
        if (!strcmp(request_field(i), name))
            return request_get(request, i, &value);
    return false;
}

int cli_head_pictures(const struct settings *settings, const json_t *head, char file[PATH_MAX]) {
    const char *name = json_string_value(json_object_get(head, "name"));
    snprintf(file, PATH_MAX, "%s/pictures/%s.json", settings->models, name ? name : "");
    if (!access(file, R_OK))
        return 0;
    cli_complain("%s: %s: this head has no set of pictures", file, strerror(errno));
    return -1;
}

int cli_pictures_check(const char *option, const char *file) {
    json_t *set = named_model(option, file, "faccia-pictures", "set of pictures");
    json_decref(set);
    return set ? 0 : -1;
}

void cli_head_suit(struct speech_request *request, const json_t *head) {
    const char *name;
    json_t *value;
    struct error e;
    if (request->voice || request->gender != GENDER_ANY)
        return;
    json_object_foreach(json_object_get(head, "voice"), name, value) {
        char *word = json_is_string(value) ? mem_strdup(json_string_value(value))
                                           : json_dumps(value, JSON_ENCODE_ANY | JSON_REAL_PRECISION(9));
        if (!strcmp(name, "gender") || !is_given(request, name)) /* a choice always has a word */
            request_set(request, name, (struct request_value){REQUEST_WORD, word, strlen(word), 0}, &e);
        free(word);
    }
}

/* Bit of zlib's window size that asks for gzip's header. */
enum { GZIP_WINDOW = MAX_WBITS + 16 };

int cli_head_pack(const char *file, struct buf *out) {
    struct buf text = {0};
    z_stream z = {0};
    if (cli_read(file, &text) ||
        deflateInit2(&z, Z_BEST_COMPRESSION, Z_DEFLATED, GZIP_WINDOW, 8, Z_DEFAULT_STRATEGY) != Z_OK) {
        buf_free(&text);
        return -1;
    }
    uLong most = deflateBound(&z, text.size);
    z.next_in = text.data;
    z.avail_in = (uInt)text.size;
    z.next_out = buf_reserve(out, most);
    z.avail_out = (uInt)most;
    deflate(&z, Z_FINISH); /* cannot fail: the room is what deflateBound asks for */
    out->size += z.total_out;
    deflateEnd(&z);
    buf_free(&text);
    return 0;
}
