# SPDX-License-Identifier: GPL-3.0-or-later
# What every test finds in its environment, for run.sh and one.sh. Wants $root, the top of the tree.
: "${FACCIA_ARTEFACTS:=$root/build/test-artefacts}" "${FACCIA_MODELS:=$root/build/models}" "${FACCIA_WEB:=$root/build/web}"
export FACCIA_ARTEFACTS FACCIA_MODELS FACCIA_WEB
export LSAN_OPTIONS="suppressions=$root/tests/lsan.supp:print_suppressions=0"
export ASAN_OPTIONS="detect_leaks=1:abort_on_error=0:quarantine_size_mb=16" UBSAN_OPTIONS="halt_on_error=1:print_stacktrace=1"
mkdir -p "$FACCIA_ARTEFACTS"
