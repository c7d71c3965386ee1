#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Daemons, workers and Redis with all their faults at once, for so many minutes: run.sh [MINUTES [SPEAKERS [LISTENERS [SEED]]]].
# Takes a network of its own, in which packets can be held up, and a disk of its own, which can be full, where the machine lets it
# (root, unshare, tc); says what was left out. Prints the tally; exits with 1 when a promise was broken.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
case ${1:-} in
-h | --help)
    echo "usage: sh tests/chaos/run.sh [MINUTES [SPEAKERS [LISTENERS [SEED]]]] (10 200 2000, a seed by the clock)"
    exit 0
    ;;
esac
export FACCIA_CHAOS_NETEM=0 FACCIA_CHAOS_DISK=
if unshare -nm true 2>/dev/null; then
    exec unshare -nm sh -c '
        ip link set lo up
        if tc qdisc add dev lo root netem delay 0ms 2>/dev/null; then FACCIA_CHAOS_NETEM=1; fi
        FACCIA_CHAOS_DISK=$(mktemp -d)
        mount -t tmpfs -o size=16m tmpfs "$FACCIA_CHAOS_DISK" || FACCIA_CHAOS_DISK=
        here=$1
        shift
        exec node "$here/chaos.mjs" "$@"' sh "$here" "$@"
fi
exec node "$here/chaos.mjs" "$@"
