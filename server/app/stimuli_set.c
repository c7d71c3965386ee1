/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/app/stimuli_set.h"
#include "server/base/buf.h"
#include "server/base/mem.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char place[] = "{item}";

static const char *text_of(json_t *object, const char *key) {
    const char *text = json_string_value(json_object_get(object, key));
    return text && *text ? text : NULL;
}

static int read_items(struct stimuli_set *set, struct error *e) {
    static const char letters[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-";
    json_t *items = json_object_get(set->json, "items"), *snrs = json_object_get(set->json, "snrs"), *value;
    size_t i;
    char field[40];
    set->items = mem_alloc((json_array_size(items) + 1) * sizeof *set->items);
    set->snrs = mem_alloc((json_array_size(snrs) + 1) * sizeof *set->snrs);
    json_array_foreach(items, i, value) {
        struct stimuli_item item = {text_of(value, "name"), text_of(value, "text")};
        snprintf(field, sizeof field, "items[%zu]", i);
        if (!item.name || !item.text || strlen(item.name) > 32 || item.name[strspn(item.name, letters)])
            return error_in_field(e, ERROR_BAD_STIMULI, field,
                                  "needs a text, and a name of up to 32 letters, digits, - and _");
        for (size_t k = 0; k < i; k++)
            if (!strcmp(set->items[k].name, item.name))
                return error_in_field(e, ERROR_BAD_STIMULI, field, "the name '%s' was there before",
                                      item.name);
        set->items[set->item_count++] = item;
    }
    json_array_foreach(snrs, i, value) {
        snprintf(field, sizeof field, "snrs[%zu]", i);
        if (!json_is_number(value) || !(json_number_value(value) >= -60 && json_number_value(value) <= 60))
            return error_in_field(e, ERROR_BAD_STIMULI, field, "must be a number of dB from -60 to 60");
        set->snrs[set->snr_count++] = json_number_value(value);
    }
    if (!set->item_count || !set->snr_count)
        return error_in_field(e, ERROR_BAD_STIMULI, set->item_count ? "snrs" : "items", "there are none");
    return 0;
}

int stimuli_set_load(struct stimuli_set *set, const char *path, struct error *e) {
    json_error_t why;
    *set = (struct stimuli_set){.json = json_load_file(path, JSON_REJECT_DUPLICATES, &why)};
    if (!set->json)
        return why.line > 0
                   ? error_at_line(e, ERROR_BAD_STIMULI, (size_t)why.line, (size_t)why.column, "%s", why.text)
                   : error_set(e, ERROR_BAD_STIMULI, "%s", why.text);
    set->lang = text_of(set->json, "lang");
    set->carrier = text_of(set->json, "carrier");
    if (!set->lang)
        return error_in_field(e, ERROR_BAD_STIMULI, "lang", "must be a language tag");
    if (!set->carrier || !strstr(set->carrier, place))
        return error_in_field(e, ERROR_BAD_STIMULI, "carrier", "must be a sentence with %s in it", place);
    if (!json_is_object(json_object_get(set->json, "page")))
        return error_in_field(e, ERROR_BAD_STIMULI, "page", "must be the texts of the page");
    return read_items(set, e);
}

void stimuli_set_free(struct stimuli_set *set) {
    json_decref(set->json);
    free(set->items);
    free(set->snrs);
    *set = (struct stimuli_set){0};
}

char *stimuli_sentence(const struct stimuli_set *set, const struct stimuli_item *item) {
    struct buf out = {0};
    const char *at = strstr(set->carrier, place);
    buf_printf(&out, "%.*s%s%s", (int)(at - set->carrier), set->carrier, item->text, at + sizeof place - 1);
    return (char *)out.data;
}
