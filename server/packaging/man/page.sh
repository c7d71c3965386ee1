#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# page.sh PROGRAM SECTION SUMMARY: its manual page, made by help2man of what it says itself; of its commands, too.
set -eu
program=$1
include=$(mktemp)
trap 'rm -f "$include"' EXIT
"$program" --help | sed -n '/COMMAND/,/^.faccia COMMAND/ s/^  \([a-z]*\) .*/\1/p' | while read -r command; do
    # as it is printed, in columns
    printf '[faccia %s]\n.nf\n' "$command"
    "$program" "$command" --help | sed 's/\\/\\e/g; s/^\([.'\'']\)/\\\&\1/; s/-/\\-/g'
    printf '.fi\n\n'
done >"$include"
printf "[see also]\nThe files in /usr/share/doc/faccia.\n" >>"$include"
help2man --no-info --section "$2" --name "$3" --source faccia --include "$include" "$program"
