#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Installs what the tests need, builds, and runs all of them. The last line is "N passed, N failed, N skipped".
set -eu

usage() {
    cat <<'TEXT'
Usage: sh tests/run.sh [WHAT]...
Installs, builds and runs the tests; the last line says how many passed and failed.
WHAT is one or more of: unit limits fuzz protocol models web daemon browser (all of these when left out), and packages: the
Debian packages and the container, built and tried in a fresh Debian (ten minutes; wants root).

  -h, --help   print this and exit

Pictures and logs that the tests make lie in build/test-artefacts. Benchmarks are run by hand: see tests/bench.
TEXT
}

die() {
    echo "run.sh: $*" >&2
    exit 1
}

all='unit limits fuzz protocol models web daemon browser'
for what in "$@"; do
    case $what in
    -h | --help)
        usage
        exit 0
        ;;
    *) case " $all packages " in *" $what "*) ;; *) die "no tests '$what'; there are: $all packages" ;; esac ;;
    esac
done
[ $# -gt 0 ] || set -- $all

root=$(cd "$(dirname "$0")/.." && pwd)
. "$root/server/setup.sh"

need_packages libcmocka-dev g++ strace mosquitto mosquitto-clients speech-dispatcher haproxy nginx-light redis-server openssl chromium curl epubcheck espeak-ng ffmpeg firefox-esr hunspell-tr librsvg2-bin pocketsphinx-testdata python3-bibtexparser python3-feedparser python3-skimage python3-websockets mypy sox iproute2 systemd \
    sqlite3 wamerican wbrazilian witalian asterisk-core-sounds-it asterisk-core-sounds-it-wav festival festvox-italp16k festvox-itapc16k festvox-us-slt-hts festvox-kallpc16k flite gstreamer1.0-tools gstreamer1.0-plugins-base gstreamer1.0-plugins-good
need_modules "$root/tests"
# A build that was configured before the tests' packages were there has no unit tests.
if [ -f "$root/build/build.ninja" ] && [ ! -d "$root/build/tests/unit" ]; then
    meson setup --reconfigure "$root/build" >/dev/null || die "meson could not configure $root/build again"
fi
sh "$root/server/run.sh" --build-only

# The daemon is tested with the sanitizers built in; the browser, which needs speed, with the ordinary build.
build "$root/build/sanitized" -Db_sanitize=address,undefined -Db_lundef=false -Dwerror=true -Dc_args=-Wno-format-truncation
# Nobody runs the benchmarks here, but they must go on building.
ninja -C "$root/build/sanitized" --quiet benchmarks || die "the benchmarks cannot be built"
case " $* " in *' fuzz '*)
    need_packages clang libclang-rt-14-dev
    . "$root/tests/fuzz/setup.sh"
    fuzz_build || die "the fuzz targets cannot be built"
    ;;
esac
artefacts="$root/build/test-artefacts"
case " $* " in *' packages '*)
    need_packages buildah lintian mmdebstrap reuse systemd
    FACCIA_PACKAGES="$root/build/packages"
    export FACCIA_PACKAGES
    sh "$root/server/deploy/package.sh" "$FACCIA_PACKAGES"
    ;;
esac
mkdir -p "$artefacts"
export FACCIA_ARTEFACTS="$artefacts" FACCIA_MODELS="$root/build/models" FACCIA_WEB="$root/build/web"
export LSAN_OPTIONS="suppressions=$root/tests/lsan.supp:print_suppressions=0"
export ASAN_OPTIONS="detect_leaks=1:abort_on_error=0:quarantine_size_mb=16" UBSAN_OPTIONS="halt_on_error=1:print_stacktrace=1"

# run WHAT JOBS: the test files that standard input names, so many side by side. A test file is one job: tests/one.sh says how
# it went and leaves its counts in the artefacts.
run() {
    sort | xargs -r -P "$2" -n 1 sh "$root/tests/one.sh" "$1" || true # the counts tell
}

# group WHAT: the tests of that name.
group() {
    case $1 in
    unit)
        # the corpora of the fuzz targets, too
        find "$root/build/sanitized/tests/unit" "$root/build/sanitized/tests/fuzz" -maxdepth 1 \
            \( -name 'test_*' -o -name 'fuzz_*' \) -type f -perm -u+x | run unit 2
        ;;
    fuzz) find "$root/build/fuzz/tests/fuzz" -maxdepth 1 -name 'fuzz_*' -type f -perm -u+x | run fuzz 2 ;;
    limits) # once more in the ordinary build: a sanitized program takes more memory than any limit
        printf '%s\n' "$root/build/tests/unit/test_limits" "$root/tests/daemon/limits.test.mjs" | run limits 2
        ;;
    daemon) # they wait for speech most of their time
        find "$root/tests/daemon" -name '*.test.mjs' | run daemon 3
        ;;
    packages) find "$root/tests/packages" -name '*.test.mjs' | run packages 1 ;;
    *) find "$root/tests/$1" -name '*.test.mjs' | run "$1" 2 ;;
    esac
}

rm -f "$artefacts"/*.count
# What draws a face goes one by one, for want of a graphics card; it leaves room for all others beside it.
for what in "$@"; do
    [ "$what" = browser ] || group "$what"
done &
case " $* " in *' browser '*)
    faceless=$(grep -l 'launch({ webgl: false })' "$root"/tests/browser/*.test.mjs | xargs grep -L 'launch()')
    printf '%s\n' "$root"/tests/browser/*.test.mjs | grep -vxF "$faceless" | run browser 1
    printf '%s\n' "$faceless" | run browser 2
    ;;
esac
wait

passed=$(cat "$artefacts"/*.count | awk '{ sum += $1 } END { print sum + 0 }')
failed=$(cat "$artefacts"/*.count | awk '{ sum += $2 } END { print sum + 0 }')
skipped=$(cat "$artefacts"/*.count | awk '{ sum += $3 } END { print sum + 0 }')
echo "$passed passed, $failed failed, $skipped skipped"
[ "$failed" = 0 ]
