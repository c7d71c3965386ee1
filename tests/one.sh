#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# One test file, for run.sh: one.sh WHAT FILE. Prints its log when something failed, and a line with the counts. By hand, when all is
# built: sh tests/one.sh FILE.
set -u
[ $# -gt 0 ] || {
    echo 'usage: sh tests/one.sh [WHAT] FILE (sh tests/run.sh FILE builds first)' >&2
    exit 2
}
root=$(cd "$(dirname "$0")/.." && pwd)
if [ $# = 1 ]; then
    set -- "$(cd "$(dirname "$1")" && pwd)/$(basename "$1")"
    what=${1#"$root/tests/"}
    set -- "${what%%/*}" "$1"
fi
what=$1
file=$2
. "$root/tests/environment.sh"
artefacts=$FACCIA_ARTEFACTS
name=$what-$(basename "$file" .test.mjs)
log="$artefacts/$name.tap"
status=0
begun=$(date +%s)
case $what-$file in
daemon-* | long-*/daemon/*) export FACCIA_BUILD="$root/build/sanitized" ;;
*) export FACCIA_BUILD="$root/build" ;;
esac
case $what in
long) export FACCIA_LONG=1 FACCIA_FUZZ_SECONDS="${FACCIA_FUZZ_SECONDS:-60}" ;;
esac
case $file in
*/fuzz_*)
    target=${file##*/fuzz_}
    . "$root/tests/fuzz/setup.sh"
    fuzz_folder
    fuzz_seeds "$target" "$TMPDIR/seeds"
    fuzz_corpus "$target" "$TMPDIR/corpus"
    ;;
esac
case $what-$file in
packages-*) timeout -k 10 1800 node --test-reporter=tap "$file" ;;
fuzz-* | long-*/fuzz_*) fuzz_run "$file" "$target" "$artefacts/$name-" ;;
*/fuzz_*) timeout -k 10 900 "$file" "$TMPDIR/seeds" "$TMPDIR/corpus" ;;
long-*) timeout -k 10 3600 node --test --test-reporter=tap "$file" ;;
*.mjs) timeout -k 10 900 node --test-reporter=tap "$file" ;;
*) CMOCKA_MESSAGE_OUTPUT=TAP timeout -k 10 900 "$file" ;;
esac >"$log" 2>&1 || status=$?
times >"$artefacts/$name.times" # a pipe's own shell would have none
processor=$(awk 'NR == 2 { gsub(/[ms]/, " "); print int($1 * 60 + $2 + $3 * 60 + $4) }' "$artefacts/$name.times")
rm "$artefacts/$name.times"
if grep -aq '^# pass ' "$log"; then # node
    ok=$(sed -n 's/^# pass //p' "$log")
    bad=$(($(sed -n 's/^# fail //p' "$log") + $(sed -n 's/^# cancelled //p' "$log")))
    skipped=$(sed -n 's/^# skipped //p' "$log")
else # cmocka, and the fuzz targets
    ok=$(grep -ac '^ok [0-9]* - ' "$log")
    bad=$(grep -ac '^not ok [0-9]* - ' "$log")
    skipped=$(grep -ac '^not ok [0-9]* # SKIP' "$log")
fi
if [ "$status" != 0 ] && [ "$bad" = 0 ]; then
    bad=1 # died without a word
fi
rm -f "$artefacts/$name.again"
if [ "$bad" != 0 ]; then
    tail -n 400 "$log" # the whole log is kept
    # A sanitizer's finding is never chance.
    grep -aqE 'ERROR: (Address|Leak)Sanitizer|runtime error: ' "$log" || echo "$what $file" >"$artefacts/$name.again"
fi
echo "$ok $bad ${skipped:-0}" >"$artefacts/$name.count"
echo "$name: $ok passed, $bad failed, ${skipped:-0} skipped in $(($(date +%s) - begun)) s ($processor of processor)"
