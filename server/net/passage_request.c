/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/mem.h"
#include "server/library/library.h"
#include "server/net/net_internal.h"
#include <stdlib.h>
#include <string.h>

int passage_resolve(const struct net *net, struct speech_request *request, struct error *e) {
    struct library_passage passage;
    if (!request->passage)
        return request->from > 0 ? error_in_field(e, ERROR_BAD_FIELD, "from", "goes with a passage only") : 0;
    if (request->text)
        return error_in_field(e, ERROR_BAD_FIELD, "passage", "there is a text already");
    if (!net->options.library)
        return error_in_field(e, ERROR_UNKNOWN_PASSAGE, "passage", "there is no library here");
    if (library_passage(net->options.library, request->passage, request->from, net->options.text_bytes,
                        &passage, e))
        return -1;
    if (request->voice && !strcmp(request->voice, "recording")) {
        if (!passage.voice) {
            library_passage_free(&passage);
            return error_in_field(e, ERROR_UNKNOWN_VOICE, "voice", "there is no recording of it");
        }
        free(request->voice);
        request->voice = mem_strdup(passage.voice);
    }
    free(request->languages);
    request->languages = passage.voice && request->voice && !strcmp(request->voice, passage.voice)
                             ? NULL /* a recording speaks all of it */
                             : passage.languages;
    if (request->languages)
        passage.languages = NULL;
    request->text = passage.text;
    request->text_size = strlen(passage.text);
    passage.text = NULL;
    free(request->markup);
    request->markup = mem_strdup(passage.markup);
    if (!request->lang) {
        request->lang = passage.lang;
        passage.lang = NULL;
    }
    library_passage_free(&passage);
    return 0;
}
