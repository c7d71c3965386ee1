/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/app/hear_write.h"
#include "protocol/fapfile.h"
#include "server/app/cli.h"
#include <errno.h>
#include <string.h>

/* A class that was less likely over a sound is left out. */
#define LEAST_LIKELY 0.005

static struct lip_output *const *outputs_of(struct hear_write *w, struct lip_output *list[3]) {
    list[0] = &w->fap;
    list[1] = &w->json;
    list[2] = &w->lines;
    return list;
}

int hear_write_begin(struct hear_write *w, const char *lang, double fps, int lookahead) {
    struct lip_output *list[3];
    int standard = 0;
    if (!w->fap.path && !w->json.path && !w->lines.path)
        w->lines.path = "-";
    outputs_of(w, list);
    for (int i = 0; i < 3; i++) {
        standard += list[i]->path && !strcmp(list[i]->path, "-");
        if (list[i]->path && cli_create(&list[i]->file, list[i]->path))
            return -1;
    }
    if (standard > 1) {
        cli_complain("only one file can go to standard output");
        return -1;
    }
    w->fps = fps;
    if (w->fap.path && !(w->frames = tmpfile())) {
        cli_complain("a temporary file: %s", strerror(errno));
        return -1;
    }
    if (w->json.path)
        fprintf(w->json.file.file, "{\"lang\":\"%s\",\"fps\":%g,\"lookahead\":%g,\n \"phones\":[", lang, fps,
                lookahead / 1000.0);
    return 0;
}

void hear_write_frame(void *ctx, uint32_t k, const struct fap_frame *frame) {
    struct hear_write *w = ctx;
    char text[4096];
    w->frame_count = k + 1;
    if (w->frames) {
        fapfile_write_frame(frame, k, text, sizeof text);
        fputs(text, w->frames);
    }
    if (!w->lines.path)
        return;
    FILE *out = w->lines.file.file;
    const char *comma = "";
    fprintf(out, "{\"type\":\"frame\",\"frame\":%u,\"time\":%.6g,\"faps\":{", k, k / w->fps);
    for (int n = 3; n <= FAP_COUNT; n++)
        if (fap_frame_has(frame, n) && frame->value[n]) {
            fprintf(out, "%s\"%d\":%d", comma, n, (int)frame->value[n]);
            comma = ",";
        }
    fputs("}}\n", out);
}

void hear_write_phone(void *ctx, const struct lip_phone *p) {
    struct hear_write *w = ctx;
    char text[600];
    int size =
        snprintf(text, sizeof text,
                 "\"class\":\"%s\",\"ipa\":\"%s\",\"start\":%.4f,\"end\":%.4f,\"sure\":%.2f,\"likely\":{",
                 lip_classes[p->class].name, lip_classes[p->class].ipa, hear_seconds(p->start),
                 hear_seconds(p->end), p->likely[p->class] / (p->end - p->start));
    for (int i = 0, any = 0; i < LIP_CLASSES; i++) {
        double mean = p->likely[i] / (p->end - p->start);
        if (mean >= LEAST_LIKELY)
            size += snprintf(text + size, sizeof text - (size_t)size, "%s\"%s\":%.2f", any++ ? "," : "",
                             lip_classes[i].name, mean);
    }
    snprintf(text + size, sizeof text - (size_t)size, "}}");
    if (w->json.path)
        fprintf(w->json.file.file, "%s\n  {%s", w->phones ? "," : "", text);
    if (w->lines.path)
        fprintf(w->lines.file.file, "{\"type\":\"phone\",%s\n", text);
    w->phones++;
}

int hear_write_flush(struct hear_write *w) {
    struct lip_output *list[3];
    outputs_of(w, list);
    for (int i = 0; i < 3; i++)
        if (list[i]->path && (fflush(list[i]->file.file) || ferror(list[i]->file.file))) {
            cli_complain("%s: %s", list[i]->path, strerror(errno));
            return -1;
        }
    return 0;
}

/* The header, then what was put aside. */
static int write_fap(struct hear_write *w) {
    char text[4096];
    fapfile_write_header("faccia", w->fps, w->frame_count, text, sizeof text);
    fputs(text, w->fap.file.file);
    rewind(w->frames);
    for (size_t n; (n = fread(text, 1, sizeof text, w->frames));)
        fwrite(text, 1, n, w->fap.file.file);
    if (!ferror(w->frames))
        return 0;
    cli_complain("a temporary file: %s", strerror(errno));
    return -1;
}

int hear_write_end(struct hear_write *w) {
    if (w->json.path)
        fputs("\n ]}\n", w->json.file.file);
    return (w->fap.path && write_fap(w)) || hear_write_flush(w) ? -1 : 0;
}

int hear_write_close(struct hear_write *w, bool well) {
    struct lip_output *list[3];
    int status = 0;
    outputs_of(w, list);
    for (int i = 0; i < 3; i++)
        status |= cli_finish(&list[i]->file, well && list[i]->path);
    if (w->frames)
        fclose(w->frames);
    return status;
}
