#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# One test file, for run.sh: one.sh WHAT FILE. Prints its log when something failed, and a line with the counts.
set -u
what=$1
file=$2
root=$(cd "$(dirname "$0")/.." && pwd)
artefacts=$FACCIA_ARTEFACTS
name=$what-$(basename "$file" .test.mjs)
log="$artefacts/$name.tap"
status=0
case $(basename "$file") in
fuzz_*)
    target=$(basename "$file" | sed 's/^fuzz_//')
    . "$root/tests/fuzz/setup.sh"
    fuzz_folder
    fuzz_seeds "$target" "$TMPDIR/seeds"
    ;;
esac
case $what-${target:+corpus} in
unit-corpus) timeout -k 10 900 "$file" "$TMPDIR/seeds" "$root/tests/fuzz/corpus/$target" ;;
fuzz-*) fuzz_run "$file" "$target" "$artefacts/$name-" ;;
unit-*) CMOCKA_MESSAGE_OUTPUT=TAP timeout -k 10 900 "$file" ;;
daemon-*) FACCIA_BUILD="$root/build/sanitized" timeout -k 10 900 node --test-reporter=tap "$file" ;;
*) FACCIA_BUILD="$root/build" timeout -k 10 900 node --test-reporter=tap "$file" ;;
esac >"$log" 2>&1 || status=$?
if grep -aq '^# pass ' "$log"; then # node
    ok=$(sed -n 's/^# pass //p' "$log")
    bad=$(($(sed -n 's/^# fail //p' "$log") + $(sed -n 's/^# cancelled //p' "$log")))
else # cmocka, and those of the fuzz targets
    ok=$(grep -ac '^ok [0-9]* - ' "$log")
    bad=$(grep -ac '^not ok [0-9]* - ' "$log")
fi
if [ "$status" != 0 ] && [ "$bad" = 0 ]; then
    bad=1 # died without a word
fi
if [ "$bad" != 0 ]; then
    tail -n 400 "$log" # the whole log is kept
fi
echo "$ok $bad" >"$artefacts/$name.count"
echo "$name: $ok passed, $bad failed"
