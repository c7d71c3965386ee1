/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The files that faccia library export writes, all in one reading. */
#ifndef FACCIA_APP_LIBRARY_EXPORT_FILES_H
#define FACCIA_APP_LIBRARY_EXPORT_FILES_H

#include "server/app/cli_file.h"
#include "server/export/export.h"
#include "server/publish/epub_book.h"

enum { EXPORT_WAV, EXPORT_OGG, EXPORT_FAP, EXPORT_VTT, EXPORT_TEXTGRID, EXPORT_OUTPUTS };

/* Zeroed, but for what is asked for. */
struct library_export_files {
    const char *epub; /* NULL = not asked for */
    struct epub_book *book;
    struct library_export_output {
        const char *path; /* NULL = not asked for */
        struct cli_file file;
        struct export export;
    } outputs[EXPORT_OUTPUTS];
};

bool library_export_wanted(const struct library_export_files *files);

/* All return not 0 after a message. */
int library_export_open(struct library_export_files *files, const struct work_meta *meta, const char *hash,
                        double fps);
int library_export_segment(struct library_export_files *files, const struct recital *recital,
                           const struct media_segment *segment, const char *text, const char *markup);
int library_export_section(struct library_export_files *files, const struct section *section,
                           const struct recital_part *part, uint32_t rate);

/* Not well: nothing is left. */
int library_export_close(struct library_export_files *files, const struct recital *recital, bool well);

#endif
