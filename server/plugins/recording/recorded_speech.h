/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A sentence as it is heard in a recording, as fast as it is asked for. */
#ifndef FACCIA_PLUGINS_RECORDING_RECORDED_SPEECH_H
#define FACCIA_PLUGINS_RECORDING_RECORDED_SPEECH_H

#include "server/plugins/recording/recording_folder.h"

#endif
