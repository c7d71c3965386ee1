/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/voice/plugin_loader.h"
#include "server/base/mem.h"
#include "server/base/paths.h"
#include "server/voice/faccia-voice.h"
#include "server/voice/sandbox.h"
#include <dlfcn.h>
#include <elf.h>
#include <fcntl.h>
#include <jansson.h>
#include <limits.h>
#include <link.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

enum { READS_MAX = 16384 };

/* The mapped file. Every offset is checked before use. */
struct image {
    const uint8_t *data;
    size_t size;
};

static bool copy(const struct image *image, uint64_t offset, void *out, size_t size) {
    if (offset > image->size || size > image->size - offset)
        return false;
    memcpy(out, image->data + offset, size);
    return true;
}

/* Finds the file offset of a loaded address. */
static bool offset_of(const struct image *image, const ElfW(Ehdr) * header, uint64_t address, size_t size,
                      uint64_t *offset) {
    ElfW(Phdr) part;
    for (unsigned i = 0; i < header->e_phnum; i++) {
        if (!copy(image, header->e_phoff + (uint64_t)i * sizeof part, &part, sizeof part))
            return false;
        if (part.p_type != PT_LOAD || address < part.p_vaddr || address - part.p_vaddr > part.p_filesz ||
            size > part.p_filesz - (address - part.p_vaddr))
            continue;
        *offset = part.p_offset + (address - part.p_vaddr);
        return true;
    }
    return false;
}

static bool has_name(const struct image *image, const ElfW(Shdr) * names, uint64_t at, const char *name) {
    char text[64];
    size_t size = strlen(name) + 1;
    return at < names->sh_size && size <= names->sh_size - at && size <= sizeof text &&
           copy(image, names->sh_offset + at, text, size) && !memcmp(text, name, size);
}

/* Finds an exported symbol. */
static bool find_symbol(const struct image *image, const ElfW(Ehdr) * header, const char *name,
                        ElfW(Sym) * found) {
    ElfW(Shdr) section, names;
    for (unsigned i = 0; i < header->e_shnum; i++) {
        if (!copy(image, header->e_shoff + (uint64_t)i * sizeof section, &section, sizeof section))
            return false;
        if (section.sh_type != SHT_DYNSYM || section.sh_link >= header->e_shnum ||
            !copy(image, header->e_shoff + (uint64_t)section.sh_link * sizeof names, &names, sizeof names))
            continue;
        for (uint64_t k = 0; k < section.sh_size / sizeof *found; k++) {
            if (!copy(image, section.sh_offset + k * sizeof *found, found, sizeof *found))
                return false;
            if (found->st_shndx != SHN_UNDEF && has_name(image, &names, found->st_name, name))
                return true;
        }
    }
    return false;
}

static bool is_ours(const struct image *image, ElfW(Ehdr) * header) {
    return copy(image, 0, header, sizeof *header) && !memcmp(header->e_ident, ELFMAG, SELFMAG) &&
           header->e_ident[EI_CLASS] == (sizeof(void *) == 8 ? ELFCLASS64 : ELFCLASS32) &&
           header->e_phentsize == sizeof(ElfW(Phdr)) && header->e_shentsize == sizeof(ElfW(Shdr));
}

/* Reads the start of the table: plain numbers are in the file as they are, without relocation. */
static bool read_table(const struct image *image, const ElfW(Ehdr) * header, struct faccia_voice *table) {
    const size_t size = offsetof(struct faccia_voice, capabilities) + sizeof table->capabilities;
    ElfW(Sym) symbol;
    uint64_t offset;
    return find_symbol(image, header, FACCIA_VOICE_SYMBOL, &symbol) &&
           offset_of(image, header, symbol.st_value, size, &offset) && copy(image, offset, table, size);
}

static void read_paths(const struct image *image, const ElfW(Ehdr) * header, struct plugin_needs *needs) {
    ElfW(Sym) symbol;
    uint64_t offset;
    if (!find_symbol(image, header, FACCIA_VOICE_READS_SYMBOL, &symbol) || symbol.st_size > READS_MAX ||
        !offset_of(image, header, symbol.st_value, symbol.st_size, &offset))
        return;
    needs->reads = mem_alloc(symbol.st_size + 1);
    needs->reads_size = copy(image, offset, needs->reads, symbol.st_size) ? symbol.st_size + 1 : 0;
}

/* Capabilities of a table, including what an older interface could not declare. */
static uint32_t needs_of_version(uint32_t abi, uint32_t capabilities) {
    if (abi < 2)
        capabilities |= FACCIA_VOICE_NETWORK | FACCIA_VOICE_PROGRAMS;
    if (abi < 3)
        capabilities |= FACCIA_VOICE_FILES;
    return capabilities;
}

bool plugin_needs_read(struct plugin_needs *needs, const char *path) {
    struct faccia_voice table = {0};
    ElfW(Ehdr) header;
    struct stat file;
    *needs = (struct plugin_needs){0};
    int fd = open(path, O_RDONLY | O_CLOEXEC);
    void *data = fd >= 0 && !fstat(fd, &file) && file.st_size > 0
                     ? mmap(NULL, (size_t)file.st_size, PROT_READ, MAP_PRIVATE, fd, 0)
                     : MAP_FAILED;
    if (fd >= 0)
        close(fd);
    if (data == MAP_FAILED)
        return false;
    const struct image image = {data, (size_t)file.st_size};
    bool found = is_ours(&image, &header) && read_table(&image, &header, &table);
    if (found) {
        needs->capabilities = needs_of_version(table.abi, table.capabilities);
        read_paths(&image, &header, needs);
    }
    munmap(data, image.size);
    return found;
}

void plugin_needs_free(struct plugin_needs *needs) {
    free(needs->reads);
    *needs = (struct plugin_needs){0};
}

static void add(struct allowed_paths *a, char *path, bool write) {
    a->paths = mem_grow(a->paths, &a->cap, a->count + 1, sizeof *a->paths);
    a->paths[a->count++] = (struct sandbox_path){path, write};
}

/* Shared folders that hold unrelated files. */
static bool is_common(const char *folder) {
    static const char *const common[] = {"", "/etc", "/tmp", "/var/tmp", "/run"};
    const char *home = getenv("HOME");
    for (size_t i = 0; i < sizeof common / sizeof *common; i++)
        if (!strcmp(folder, common[i]))
            return true;
    return home && !strcmp(folder, home);
}

static void add_named(struct allowed_paths *a, const char *path) {
    struct stat file;
    if (*path != '/' || stat(path, &file))
        return;
    add(a, mem_strdup(path), S_ISDIR(file.st_mode));
    char *folder = mem_strndup(path, (size_t)(strrchr(path, '/') - path));
    if (S_ISDIR(file.st_mode) || is_common(folder))
        free(folder);
    else
        add(a, folder, false);
}

static void add_all_named(struct allowed_paths *a, const json_t *value) {
    const char *key;
    json_t *part;
    size_t i;
    if (json_is_string(value))
        add_named(a, json_string_value(value));
    json_object_foreach((json_t *)value, key, part) add_all_named(a, part);
    json_array_foreach(value, i, part) add_all_named(a, part);
}

static int add_listed(struct allowed_paths *a, const json_t *config, const char *member, bool write,
                      char *message, size_t cap) {
    const json_t *list = json_object_get(config, member);
    json_t *path;
    size_t i;
    if (list && !json_is_array(list)) {
        snprintf(message, cap, "%s: must be a list of absolute paths", member);
        return -1;
    }
    json_array_foreach(list, i, path) {
        const char *text = json_string_value(path);
        if (!text || *text != '/') {
            snprintf(message, cap, "%s[%zu]: must be an absolute path", member, i);
            return -1;
        }
        add(a, mem_strdup(text), write);
    }
    return 0;
}

int allowed_paths_read(struct allowed_paths *allowed, const char *config, char *message, size_t cap) {
    json_t *root = json_loads(config, 0, NULL);
    *allowed = (struct allowed_paths){0};
    int result = add_listed(allowed, root, "may_read", false, message, cap);
    if (!result)
        result = add_listed(allowed, root, "may_write", true, message, cap);
    json_object_del(root, "may_read");
    json_object_del(root, "may_write");
    add_all_named(allowed, root);
    char *rest = json_dumps(root, JSON_COMPACT);
    allowed->config = rest ? rest : mem_strdup("{}");
    json_decref(root);
    return result;
}

void allowed_paths_add_packs(struct allowed_paths *allowed) {
    struct paths paths;
    char folder[PATH_MAX];
    paths_find(&paths);
    if (*paths.models && (size_t)snprintf(folder, sizeof folder, "%s/speech", paths.models) < sizeof folder)
        add(allowed, mem_strdup(folder), false);
    paths_free(&paths);
}

void allowed_paths_free(struct allowed_paths *allowed) {
    for (size_t i = 0; i < allowed->count; i++)
        free((char *)allowed->paths[i].path);
    free(allowed->paths);
    free(allowed->config);
    *allowed = (struct allowed_paths){0};
}

static int fail(char *message, size_t cap, const char *path, const char *why) {
    snprintf(message, cap, "%s: %s", path, why);
    return -1;
}

/* Returns why the host cannot use the table, or NULL. A newer plugin's table may be longer. */
static const char *complaint(const struct faccia_voice *api, char *out, size_t cap) {
    if (api->abi < FACCIA_VOICE_ABI_OLDEST || api->abi > FACCIA_VOICE_ABI) {
        snprintf(out, cap,
                 "the plugin was built for version %u of the voice interface; this program has version %u",
                 api->abi, FACCIA_VOICE_ABI);
        return out;
    }
    if (api->size < sizeof *api) {
        snprintf(out, cap, "the plugin's table has %u bytes, %zu are needed", api->size, sizeof *api);
        return out;
    }
    if (!api->name || !api->version || !api->licence || !api->open || !api->list || !api->speak ||
        !api->close)
        return "the plugin's table is incomplete";
    return NULL;
}

int loaded_plugin_load(struct loaded_plugin *loaded, const char *path, uint32_t capabilities, char *message,
                       size_t cap) {
    enum { NEEDS = FACCIA_VOICE_NETWORK | FACCIA_VOICE_PROGRAMS | FACCIA_VOICE_FILES };
    char why[160];
    loaded->path = path;
    loaded->library = dlopen(path, RTLD_NOW | RTLD_LOCAL);
    if (!loaded->library) {
        const char *error = dlerror();
        snprintf(message, cap, "%s", error ? error : path);
        return -1;
    }
    loaded->api = dlsym(loaded->library, FACCIA_VOICE_SYMBOL);
    if (!loaded->api)
        return fail(message, cap, path, "not a voice plugin: it does not export \"" FACCIA_VOICE_SYMBOL "\"");
    const char *bad = complaint(loaded->api, why, sizeof why);
    if (bad)
        return fail(message, cap, path, bad);
    loaded->capabilities = needs_of_version(loaded->api->abi, loaded->api->capabilities);
    if (loaded->capabilities & NEEDS & ~capabilities)
        return fail(message, cap, path, "the plugin's table differs from its file: it must be a constant");
    return 0;
}

int loaded_plugin_open(struct loaded_plugin *loaded, const char *config, char *message, size_t cap) {
    *message = '\0';
    int result = loaded->api->open(config, &loaded->self, message, cap);
    message[cap - 1] = '\0';
    if (result && !*message)
        return fail(message, cap, loaded->path, "the plugin did not start");
    return result > 0 ? 1 : result ? -1 : 0;
}

void loaded_plugin_close(struct loaded_plugin *loaded) {
    loaded->api->close(loaded->self);
    /* the library stays loaded: the process is about to end, and a leak report can still name it */
    *loaded = (struct loaded_plugin){0};
}

static json_t *text(const char *s) {
    json_t *string = json_string(s ? s : "");
    return string ? string : json_string(""); /* not UTF-8 */
}

static void add_voice(void *ctx, const struct faccia_voice_info *voice) {
    if (!voice || !voice->id || !*voice->id)
        return;
    json_array_append_new(ctx, json_pack("{so so so so so so sI sI}", "id", text(voice->id), "name",
                                         text(voice->name), "lang", text(voice->lang), "gender",
                                         text(voice->gender), "quality", text(voice->quality), "licence",
                                         text(voice->licence), "sample_rate", (json_int_t)voice->sample_rate,
                                         "rate", (json_int_t)voice->rate));
}

char *loaded_plugin_describe(const struct loaded_plugin *loaded) {
    json_t *voices = json_array();
    loaded->api->list(loaded->self, add_voice, voices);
    json_t *root = json_pack("{so so so sI so s{so so so}}", "name", text(loaded->api->name), "version",
                             text(loaded->api->version), "licence", text(loaded->api->licence),
                             "capabilities", (json_int_t)loaded->capabilities, "voices", voices, "gaps",
                             "spaces", text(loaded->gaps.spaces), "files", text(loaded->gaps.files), "calls",
                             text(loaded->gaps.calls));
    char *dump = json_dumps(root, JSON_COMPACT);
    json_decref(root);
    return dump ? dump : mem_strdup("{}");
}
