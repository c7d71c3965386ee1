/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One change to an ONNX model in memory: a tensor inside its graph becomes an output. An ONNX file is a
 * Protocol Buffers message; of its schema (onnx.proto3) only these fields matter here: ModelProto.graph = 7,
 * GraphProto.output = 12 and GraphProto.value_info = 13, both of ValueInfoProto, whose name = 1. */
#ifndef FACCIA_PLUGINS_KOKORO_KOKORO_ONNX_H
#define FACCIA_PLUGINS_KOKORO_KOKORO_ONNX_H

#include "server/base/buf.h"
#include <stdbool.h>

/* Appends the tensor's value_info to the graph's outputs. False when the model cannot be read, has more than
 * one graph, or does not describe such a tensor; it is as it was then. */
bool ko_onnx_expose(struct buf *model, const char *tensor);

#endif
