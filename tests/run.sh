#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Installs what the tests need, builds, and runs all of them. The last line is "N passed, N failed".
set -eu

usage() {
    cat <<'TEXT'
Usage: sh tests/run.sh [WHAT]...
Installs, builds and runs the tests; the last line says how many passed and failed.
WHAT is one or more of: unit protocol models web daemon browser (all of them when left out).

  -h, --help   print this and exit

Pictures and logs that the tests make lie in build/test-artefacts. Benchmarks are run by hand: see tests/bench.
TEXT
}

die() {
    echo "run.sh: $*" >&2
    exit 1
}

all='unit protocol models web daemon browser'
for what in "$@"; do
    case $what in
    -h | --help)
        usage
        exit 0
        ;;
    *) case " $all " in *" $what "*) ;; *) die "no tests '$what'; there are: $all" ;; esac ;;
    esac
done
[ $# -gt 0 ] || set -- $all

root=$(cd "$(dirname "$0")/.." && pwd)
. "$root/server/setup.sh"

sh "$root/server/run.sh" --build-only
need_packages libcmocka-dev chromium espeak-ng librsvg2-bin witalian wbrazilian wamerican hunspell-tr \
    festival festvox-italp16k festvox-itapc16k festvox-us-slt-hts festvox-kallpc16k sox pocketsphinx-testdata
need_modules "$root/tests"

# The daemon is tested with the sanitizers built in; the browser, which needs speed, with the ordinary build.
build "$root/build/sanitized" -Db_sanitize=address,undefined -Db_lundef=false -Dwerror=true -Dc_args=-Wno-format-truncation
artefacts="$root/build/test-artefacts"
mkdir -p "$artefacts"
export FACCIA_ARTEFACTS="$artefacts" FACCIA_MODELS="$root/build/models" FACCIA_WEB="$root/build/web"
export LSAN_OPTIONS="suppressions=$root/tests/lsan.supp:print_suppressions=0"
export ASAN_OPTIONS="detect_leaks=1:abort_on_error=0" UBSAN_OPTIONS="halt_on_error=1:print_stacktrace=1"

passed=0
failed=0

# tap NAME COMMAND...: runs it and adds up the results that its TAP output states.
tap() {
    name=$1
    shift
    log="$artefacts/$name.tap"
    status=0
    "$@" >"$log" 2>&1 || status=$?
    if grep -q '^# pass ' "$log"; then # node
        ok=$(sed -n 's/^# pass //p' "$log")
        bad=$(($(sed -n 's/^# fail //p' "$log") + $(sed -n 's/^# cancelled //p' "$log")))
    else # cmocka
        ok=$(grep -c '^ok [0-9]* - ' "$log" || true)
        bad=$(grep -c '^not ok [0-9]* - ' "$log" || true)
    fi
    if [ "$status" != 0 ] && [ "$bad" = 0 ]; then
        bad=1 # died without a word
    fi
    if [ "$bad" != 0 ]; then
        cat "$log"
    fi
    echo "$name: $ok passed, $bad failed"
    passed=$((passed + ok))
    failed=$((failed + bad))
}

for what in "$@"; do
    case $what in
    unit)
        for test in "$root"/build/sanitized/tests/unit/test_*; do
            [ -x "$test" ] && [ -f "$test" ] && tap "unit-$(basename "$test")" env CMOCKA_MESSAGE_OUTPUT=TAP "$test"
        done
        ;;
    *)
        for test in "$root/tests/$what"/*.test.mjs; do
            build="$root/build"
            [ "$what" = daemon ] && build="$root/build/sanitized"
            [ -f "$test" ] && tap "$what-$(basename "$test" .test.mjs)" \
                env FACCIA_BUILD="$build" node --test-reporter=tap "$test"
        done
        ;;
    esac
done

echo "$passed passed, $failed failed"
[ "$failed" = 0 ]
