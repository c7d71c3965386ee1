/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The folder of recordings: what is in it. */
#include "server/net/internal.h"

int media_source(const struct net *net, struct reel_source *source, const char *name, struct error *e) {
    source->fap_bytes_max = net->options.play_bytes;
    if (!net->options.media)
        return error_in_field(e, "unknown-media", "name", "there is no folder of recordings here");
    return reel_source_in(source, net->options.media, name, e);
}

static void add(void *list, const char *name, bool sound) {
    json_array_append_new(list, json_pack("{ss sb}", "name", name, "sound", sound));
}

json_t *message_media(const struct net *net) {
    json_t *list = json_array();
    if (net->options.media)
        reel_list(net->options.media, add, list);
    return list;
}
