#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Fuzzes one target: builds it with clang, makes its seeds, runs it for some time, and says where a crash lies.
set -eu

usage() {
    cat <<'TEXT'
Usage: sh tests/fuzz/run.sh TARGET [SECONDS [OPTION of libFuzzer]...]
       sh tests/fuzz/run.sh TARGET FILE...
       sh tests/fuzz/run.sh --merge TARGET
       sh tests/fuzz/run.sh --keep TARGET FILE NAME
Fuzzes the target for SECONDS (3600), or runs it on files. --merge adds the inputs found that reach new code to its corpus,
--keep adds one file under a name.
What is found stays in build/fuzz/found/TARGET, crashes lie in build/fuzz/crashes.
TEXT
    sed -n "s/^  '\([a-z]*\)': \[.*/  \1/p" "$(dirname "$0")/meson.build"
}

die() {
    echo "run.sh: $*" >&2
    exit 1
}

merge=no
keep=no
case ${1:-} in
--merge) merge=yes && shift ;;
--keep) keep=yes && shift ;;
esac
case ${1:-} in
'' | -h | --help)
    usage
    exit 0
    ;;
esac
target=$1
shift

root=$(cd "$(dirname "$0")/../.." && pwd)
folder="$root/build/fuzz"
. "$root/tests/fuzz/setup.sh"
[ -f "$root/tests/fuzz/fuzz_$target.c" ] || die "no target '$target'; there are: $(cd "$root/tests/fuzz" && echo fuzz_*.c)"
if [ $keep = yes ]; then
    [ $# = 2 ] && [ -f "$1" ] || die "--keep wants a target, a file and a name"
    fuzz_folder
    fuzz_corpus "$target" "$TMPDIR/corpus"
    cp "$1" "$TMPDIR/corpus/$2"
    fuzz_archive "$target" "$TMPDIR/corpus"
    exit 0
fi
fuzz_build "$target"
program="$folder/tests/fuzz/fuzz_$target"

fuzz_folder

if [ -f "${1:-}" ]; then
    "$program" "$@"
    exit
fi
seeds="$TMPDIR/seeds"
fuzz_seeds "$target" "$seeds"
corpus="$TMPDIR/corpus"
fuzz_corpus "$target" "$corpus"
found="$folder/found/$target"
mkdir -p "$found" "$folder/crashes"
if [ $merge = yes ]; then
    # What reaches code that neither the seeds nor the corpus reach, the shortest first.
    kept="$TMPDIR/kept"
    mkdir "$kept"
    cp "$seeds"/* "$kept/"
    find "$corpus" -type f -exec cp {} "$kept/" \;
    "$program" -merge=1 -use_counters=0 -max_len=2048 -timeout=60 -rss_limit_mb=2048 "$kept" "$found" >"$folder/merge.log" 2>&1 ||
        die "see $folder/merge.log"
    for name in $(ls -Sr "$kept"); do
        [ -f "$seeds/$name" ] || [ -f "$corpus/$name" ] || echo "$name"
    done | head -n 40 | while read -r name; do
        cp "$kept/$name" "$corpus/$(echo "$name" | cut -c 1-12)"
    done
    fuzz_archive "$target" "$corpus"
    echo "the corpora have $(cat "$root"/tests/fuzz/corpus/* | wc -c) bytes"
    exit 0
fi
seconds=${1:-3600}
[ $# -gt 0 ] && shift
"$program" -max_total_time="$seconds" -timeout=20 -rss_limit_mb=2048 -malloc_limit_mb=512 -print_final_stats=1 \
    -artifact_prefix="$folder/crashes/$target-" $(fuzz_dictionary "$target") "$@" "$found" "$corpus" "$seeds"
