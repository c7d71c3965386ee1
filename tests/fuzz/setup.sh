# SPDX-License-Identifier: GPL-3.0-or-later
# Functions for run.sh here and one.sh above: the build of the targets, and what they begin with. Wants $root.

# As the other builds with sanitizers; a number too large for the type that it is converted to is a fault, too.
fuzz_build() { # [TARGET]: all of them when left out
    folder="$root/build/fuzz"
    if [ ! -f "$folder/build.ninja" ]; then
        CC=clang meson setup "$folder" "$root" -Dfuzz=true -Db_sanitize=address,undefined -Db_lundef=false \
            "-Dc_args=-fsanitize=fuzzer-no-link,float-cast-overflow -fno-sanitize-recover=all" >"$folder.log" 2>&1 || {
            cat "$folder.log" >&2
            return 1
        }
    fi
    ninja -C "$folder" --quiet "${1:+tests/fuzz/fuzz_}${1:-fuzzers}"
}

# A folder for the targets' files, in memory where that can be; what a crash leaves there goes, too.
fuzz_folder() {
    TMPDIR=$(mktemp -d -p /dev/shm faccia-fuzz-XXXXXX 2>/dev/null || mktemp -d)
    export TMPDIR
    trap 'rm -rf "$TMPDIR"' EXIT
    trap 'exit 1' INT TERM
}

fuzz_seeds() { # TARGET FOLDER
    rm -rf "$2"
    node "$root/tests/fuzz/seeds.mjs" "$1" "$2"
}

fuzz_corpus() { # TARGET FOLDER: the inputs of its archive
    mkdir -p "$2"
    if [ -f "$root/tests/fuzz/corpus/$1.tar.gz" ]; then
        tar -xzf "$root/tests/fuzz/corpus/$1.tar.gz" -C "$2"
    fi
}

fuzz_archive() { # TARGET FOLDER: makes the archive of the folder's inputs, the same bytes for the same inputs
    tar -C "$2" --sort=name --mtime=@0 --owner=0 --group=0 --numeric-owner --mode=644 --format=ustar -cf - $(ls -A "$2") |
        gzip -n9 >"$root/tests/fuzz/corpus/$1.tar.gz"
}

fuzz_dictionary() { # TARGET: libFuzzer's option, if there is a dictionary
    if [ -f "$root/tests/fuzz/dict/$1.dict" ]; then
        echo "-dict=$root/tests/fuzz/dict/$1.dict"
    fi
}

# As one of the tests: PROGRAM TARGET PREFIX of the files with what it crashed on. $FACCIA_FUZZ_SECONDS each (8).
fuzz_run() {
    mkdir "$TMPDIR/found"
    fuzz_corpus "$2" "$TMPDIR/corpus"
    # shellcheck disable=SC2046
    "$1" -seed=1 -max_total_time="${FACCIA_FUZZ_SECONDS:-4}" -timeout=60 -rss_limit_mb=2048 -malloc_limit_mb=512 -verbosity=0 \
        -print_final_stats=1 -artifact_prefix="$3" $(fuzz_dictionary "$2") "$TMPDIR/found" "$TMPDIR/corpus" "$TMPDIR/seeds" &&
        echo "ok 1 - fuzzed for ${FACCIA_FUZZ_SECONDS:-4} s"
}
