#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Daemons, workers and Redis with all their faults at once, for so many minutes: run.sh [MINUTES [SPEAKERS [LISTENERS [SEED]]]],
# or by their names; node chaos.mjs is the same.
# Takes a network of its own, in which packets can be held up and lost, and a disk of its own, which can be full, where the machine lets it
# (unshare, tc, iptables), and clocks that are stepped (a C compiler); says what was left out. Prints the tally; exits with 1 when a promise was broken.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
case ${1:-} in
-h | --help)
    echo "usage: sh tests/chaos/run.sh [MINUTES [SPEAKERS [LISTENERS [SEED]]]] (10 200 2000, a seed by the clock)"
    echo "    or [--minutes N] [--speakers N] [--listeners N] [--seed N] [--only WORD]: only faults with that word"
    exit 0
    ;;
esac
export FACCIA_CHAOS_PLACE=1 FACCIA_CHAOS_OWN_NETWORK=0 FACCIA_CHAOS_DISK=
for how in -nm -Urnm; do # as root, or as somebody who is that in a place of his own
    if unshare "$how" true 2>/dev/null; then
        exec unshare "$how" sh -c '
            ip link set lo up && FACCIA_CHAOS_OWN_NETWORK=1
            FACCIA_CHAOS_DISK=$(mktemp -d)
            mount -t tmpfs -o size=16m tmpfs "$FACCIA_CHAOS_DISK" || FACCIA_CHAOS_DISK=
            here=$1
            shift
            exec node "$here/chaos.mjs" "$@"' sh "$here" "$@"
    fi
done
exec node "$here/chaos.mjs" "$@"
