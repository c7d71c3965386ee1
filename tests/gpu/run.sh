#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Draws every head at every level of quality on this machine's graphics card, and compares with the same picture drawn in software.
# Says so and succeeds where there is no card. Needs the build, the tests' npm packages and Chromium: sh tests/run.sh film installs them.
set -eu

case ${1-} in
-h | --help)
    cat <<'TEXT'
Usage: sh tests/gpu/run.sh [--software] [HEAD]...
Draws the heads (all when left out) at each level on the graphics card and in software, and compares. Pictures that differ lie in
build/test-artefacts/gpu. FACCIA_GPU_FLAGS: the browser's flags for this machine's card, in place of Vulkan's.

      --software   draw both in software, to try the script itself
  -h, --help       print this and exit
TEXT
    exit 0
    ;;
esac

root=$(cd "$(dirname "$0")/../.." && pwd)
. "$root/tests/environment.sh"
export FACCIA_BUILD="${FACCIA_BUILD:-$root/build}"
exec node "$root/tests/gpu/compare.mjs" "$@"
