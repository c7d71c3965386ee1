/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/voice/plugin_needs.h"
#include "server/base/mem.h"
#include "server/voice/faccia-voice.h"
#include <elf.h>
#include <fcntl.h>
#include <link.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

enum { READS_MAX = 16384 };

/* The file in memory. Everything in it is checked before it is used. */
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

/* The part of the file that is loaded to an address. */
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

/* An exported object of that name. */
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

/* The start of the table: numbers, which no initialiser has to fill in, stand in the file as they are. */
static bool read_table(const struct image *image, const ElfW(Ehdr) * header, struct faccia_voice *table) {
    const size_t size = offsetof(struct faccia_voice, capabilities) + sizeof table->capabilities;
    ElfW(Sym) symbol;
    uint64_t offset;
    return find_symbol(image, header, FACCIA_VOICE_SYMBOL, &symbol) &&
           offset_of(image, header, symbol.st_value, size, &offset) && copy(image, offset, table, size);
}

static void read_paths(const struct image *image, const ElfW(Ehdr) * header, struct needs *needs) {
    ElfW(Sym) symbol;
    uint64_t offset;
    if (!find_symbol(image, header, FACCIA_VOICE_READS_SYMBOL, &symbol) || symbol.st_size > READS_MAX ||
        !offset_of(image, header, symbol.st_value, symbol.st_size, &offset))
        return;
    needs->reads = mem_alloc(symbol.st_size + 1);
    needs->reads_size = copy(image, offset, needs->reads, symbol.st_size) ? symbol.st_size + 1 : 0;
}

uint32_t needs_stated(uint32_t abi, uint32_t capabilities) {
    if (abi < 2)
        capabilities |= FACCIA_VOICE_NETWORK | FACCIA_VOICE_PROGRAMS;
    if (abi < 3)
        capabilities |= FACCIA_VOICE_FILES;
    return capabilities;
}

bool needs_read(struct needs *needs, const char *path) {
    struct faccia_voice table = {0};
    ElfW(Ehdr) header;
    struct stat file;
    *needs = (struct needs){0};
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
        needs->capabilities = needs_stated(table.abi, table.capabilities);
        read_paths(&image, &header, needs);
    }
    munmap(data, image.size);
    return found;
}

void needs_free(struct needs *needs) {
    free(needs->reads);
    *needs = (struct needs){0};
}
