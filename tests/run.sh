#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Installs what the tests need, builds, and runs all of them. The last line is "N passed, N failed, N skipped".
set -eu

usage() {
    cat <<'TEXT'
Usage: sh tests/run.sh [--list] [WHAT]...
Installs, builds and runs the tests; the last line says how many passed and failed.
WHAT is one or more of
  - a group: unit limits fuzz protocol models web daemon browser (all of these when left out); long: the further cases of some of
    these, and each fuzz target for a minute; packages: the Debian packages and the container, built and tried in a fresh Debian
    (ten minutes; wants root);
  - a test file: tests/daemon/api/api.test.mjs, tests/unit/markup/test_markup.c;
  - a part of test files' names: api, markup.

      --list   print the test files that WHAT names, and exit
  -h, --help   print this and exit

When at most four files fail, they run once more alone, except where a sanitizer found something.
Pictures and logs that the tests make lie in build/test-artefacts. Benchmarks are run by hand: see tests/bench.
TEXT
}

die() {
    echo "run.sh: $*" >&2
    exit 1
}

root=$(cd "$(dirname "$0")/.." && pwd)

# named WHAT: the sources of the tests whose names hold it, or of the one that is that file.
named() {
    name=$(basename "$1")
    case $name in
    *.test.mjs | test_*.c) find "$root/tests" -name node_modules -prune -o -type f -name "$name" -print ;;
    *) find "$root/tests" -name node_modules -prune -o -type f \( -name "*$name*.test.mjs" -o -path "$root/tests/unit/*/test_*$name*.c" \) -print ;;
    esac | sort
}

all='unit limits fuzz protocol models web daemon browser'
groups= chosen= list=no
for what in "$@"; do
    case $what in
    -h | --help)
        usage
        exit 0
        ;;
    --list) list=yes ;;
    -*) die "no option '$what'; sh tests/run.sh --help lists them" ;;
    *)
        case " $all long packages " in
        *" $what "*) groups="$groups $what" ;;
        *)
            found=$(named "$what")
            [ -n "$found" ] || die "no test file has '$what' in its name; groups: $all long packages"
            chosen="$chosen $found"
            ;;
        esac
        ;;
    esac
done
[ -n "$groups$chosen" ] || groups=$all
if [ $list = yes ]; then
    for group in $groups; do find "$root/tests/$group" -name '*.test.mjs' -o -name 'test_*.c' 2>/dev/null; done | sort
    [ -z "$chosen" ] || printf '%s\n' $chosen
    exit 0
fi
set -- $groups
. "$root/server/setup.sh"

need_packages clang-format libcmocka-dev g++ libnss3-tools strace mosquitto mosquitto-clients speech-dispatcher haproxy nginx-light redis-server openssl chromium chromium-headless-shell curl epubcheck espeak-ng ffmpeg firefox-esr hunspell-tr librsvg2-bin pocketsphinx pocketsphinx-en-us pocketsphinx-testdata python3-bibtexparser python3-feedparser python3-skimage python3-websockets mypy sox iproute2 systemd \
    sqlite3 wamerican wbrazilian witalian asterisk-core-sounds-it asterisk-core-sounds-it-wav festival festvox-italp16k festvox-itapc16k festvox-us-slt-hts festvox-kallpc16k flite gstreamer1.0-tools gstreamer1.0-plugins-base gstreamer1.0-plugins-good
need_modules "$root/tests"
need_modules "$root/web/mcp"
# A build that was configured before the tests' packages were there has no unit tests.
if [ -f "$root/build/build.ninja" ] && [ ! -d "$root/build/tests/unit" ]; then
    meson setup --reconfigure "$root/build" >/dev/null || die "meson could not configure $root/build again"
fi
sh "$root/server/run.sh" --build-only

# The daemon is tested with the sanitizers built in; the browser, which needs speed, with the ordinary build.
build "$root/build/sanitized" -Db_sanitize=address,undefined -Db_lundef=false -Dwerror=true -Dc_args=-Wno-format-truncation
# Nobody runs the benchmarks here, but they must go on building.
ninja -C "$root/build/sanitized" --quiet benchmarks || die "the benchmarks cannot be built"
case " $* " in *' fuzz '* | *' long '*)
    need_packages clang libclang-rt-14-dev
    . "$root/tests/fuzz/setup.sh"
    fuzz_build || die "the fuzz targets cannot be built"
    ;;
esac
case " $* " in *' packages '*)
    need_packages buildah lintian mmdebstrap reuse systemd
    FACCIA_PACKAGES="$root/build/packages"
    export FACCIA_PACKAGES
    sh "$root/server/packaging/package.sh" "$FACCIA_PACKAGES"
    ;;
esac
. "$root/tests/environment.sh"
artefacts=$FACCIA_ARTEFACTS

# files WHAT: the tests of that name, one a line.
files() {
    case $1 in
    unit)
        # the corpora of the fuzz targets, too
        find "$root/build/sanitized/tests/unit" "$root/build/sanitized/tests/fuzz" -maxdepth 1 \
            \( -name 'test_*' -o -name 'fuzz_*' \) -type f -perm -u+x | sort
        ;;
    fuzz) find "$root/build/fuzz/tests/fuzz" -maxdepth 1 -name 'fuzz_*' -type f -perm -u+x | sort ;;
    limits) # once more in the ordinary build: a sanitized program takes more memory than any limit
        printf '%s\n' "$root/build/tests/unit/test_limits" "$root/tests/daemon/voice/limits.test.mjs" "$root/tests/daemon/programs/memory.test.mjs"
        ;;
    long)
        find "$root/tests" -name node_modules -prune -o -name '*.test.mjs' -exec grep -l "lib/long.mjs'" {} + | sort
        files fuzz
        ;;
    *) find "$root/tests/$1" -name '*.test.mjs' | sort ;;
    esac
}

# dearest FILE...: the lines of standard input, those of these files first, so that none of them is left for the end alone.
dearest() {
    lines=$(cat)
    {
        for name in "$@"; do echo "$lines" | grep "/$name\.test\.mjs$" || true; done
        echo "$lines"
    } | awk '!seen[$0]++'
}

# run JOBS: runs the lines "WHAT FILE" of standard input, so many side by side. tests/one.sh says how a file went and leaves its
# counts in the artefacts.
run() {
    grep . | xargs -r -P "$1" -n 2 sh "$root/tests/one.sh" || true # the counts tell
}

rm -f "$artefacts"/*.count "$artefacts"/*.again "$artefacts"/*.first.tap
# What draws a face goes one by one, for want of a graphics card, and leaves room for all others beside it, which wait for speech most
# of their time. When these are done, two faces are drawn side by side. Packages are built and tried when nothing else runs.
drawing=
case " $* " in *' browser '*)
    faceless=$(files browser | xargs grep -l 'launch({ webgl: false' | xargs grep -L 'launch()')
    files browser | grep -vxF "$faceless" | dearest foreign avatar-poses people film listen portrait | sed 's/^/browser /' >"$artefacts/drawn"
    xargs -P 1 -n 2 sh "$root/tests/one.sh" <"$artefacts/drawn" &
    drawing=$!
    ;;
esac
for what in "$@"; do
    case $what in
    browser) echo "$faceless" | dearest operator page-axe page-speak page-layout ;;
    daemon) files daemon | dearest worker library mqtt festival align fit cluster hear docs-commands command-examples cluster-rooms http-strict heard eval ;;
    models) files models | dearest import make-set crossing find-points profile ;;
    packages) ;;
    *) files "$what" ;;
    esac | sed "s/^/$what /"
done | run 3
if [ -n "$drawing" ]; then
    kill -USR1 $drawing 2>/dev/null || true # xargs: one more at a time
    wait $drawing || true
fi
# Single files: what draws a face one by one.
for file in $chosen; do
    group=${file#"$root/tests/"}
    group=${group%%/*}
    [ "$group" = unit ] && file="$root/build/sanitized/tests/unit/$(basename "$file" .c)"
    echo "$group $file"
done | sort -u | run $(case $chosen in */browser/*) echo 1 ;; *) echo 2 ;; esac)
case " $* " in *' packages '*) files packages | sed 's/^/packages /' | run 1 ;; esac
# A few files that failed while others ran run once more alone, since some wait for sound and pictures of which a busy machine is
# late. Both results are printed, the first log is kept, and what fails again has failed.
again=$(cat "$artefacts"/*.again 2>/dev/null || true)
if [ -n "$again" ] && [ -z "$chosen" ] && [ "$(echo "$again" | wc -l)" -le 4 ]; then
    echo "$again" | while read -r what file; do
        echo "$what $file failed; once more, alone:"
        name=$what-$(basename "$file" .test.mjs)
        mv "$artefacts/$name.tap" "$artefacts/$name.first.tap"
        echo "$what $file" | run 1
    done
fi

passed=$(cat "$artefacts"/*.count | awk '{ sum += $1 } END { print sum + 0 }')
failed=$(cat "$artefacts"/*.count | awk '{ sum += $2 } END { print sum + 0 }')
skipped=$(cat "$artefacts"/*.count | awk '{ sum += $3 } END { print sum + 0 }')
echo "$passed passed, $failed failed, $skipped skipped"
[ "$failed" = 0 ]
