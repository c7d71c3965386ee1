#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Packages that people install. Safe to run again.
set -eu
umask 022 # whoever builds them

usage() {
    cat <<'TEXT'
Usage: sh server/packaging/package.sh [FOLDER]
Builds faccia (server/run.sh --build-only does what is still to be done) and writes its Debian packages to FOLDER
(build/packages), with a bill of materials (faccia_VERSION.cdx.json, CycloneDX). Those of the container and the npm packages are made by
sbom-container.mjs and sbom-npm.mjs beside it.

$DEBFULLNAME and $DEBEMAIL are their maintainer.

  -h, --help   print this and exit
TEXT
}

die() {
    echo "package.sh: $*" >&2
    exit 1
}

case ${1:-} in
-h | --help)
    usage
    exit 0
    ;;
-*) die "no option: '$1'" ;;
esac

root=$(cd "$(dirname "$0")/../.." && pwd)
mkdir -p "${1:-$root/build/packages}"
target=$(cd "${1:-$root/build/packages}" && pwd)
. "$root/server/setup.sh"

sh "$root/server/run.sh" --build-only
need_packages build-essential debhelper dpkg-dev help2man

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
trap 'exit 1' INT TERM

# What Node.js made, and the tables, wherever this build would be installed.
meson install -C "$root/build" --no-rebuild --quiet --destdir "$work/data"
FACCIA_DATA=$(find "$work/data" -type d -path '*/share/faccia' -prune)
FACCIA_MODELS=$FACCIA_DATA/models # the manual pages have the help of the tools there
export FACCIA_DATA FACCIA_MODELS

# The same bytes from the same sources: times are those of the last change, and names of folders do not go in.
version=$(meson introspect "$root/build" --projectinfo | sed -n 's/.*"version": "\([^"]*\)", "descriptive.*/\1/p')
changed=$(git -C "$root" log -1 --format=%ct 2>/dev/null || stat -c %Y "$root/CHANGELOG.md")
source=$work/faccia-$version
mkdir "$source"
(cd "$root" && tar -c --exclude=./.git --exclude=./build --exclude=node_modules .) | tar -x -C "$source"
mv "$source/server/packaging/debian" "$source/debian"
maintainer="${DEBFULLNAME:-The faccia authors} <${DEBEMAIL:-faccia@example.org}>"
sed -i "s/@MAINTAINER@/$maintainer/" "$source/debian/control"
cat >"$source/debian/changelog" <<TEXT
faccia ($version) unstable; urgency=medium

  * See CHANGELOG.md.

 -- $maintainer  $(LC_ALL=C date -u -R -d "@$changed")
TEXT
(cd "$source" && dpkg-buildpackage --build=binary --no-sign >"$work/log" 2>&1) || {
    tail -n 50 "$work/log" >&2
    die "the packages cannot be built"
}
cp "$work"/*.deb "$work"/*.changes "$work"/*.buildinfo "$target/"
SOURCE_DATE_EPOCH=$changed node "$root/server/packaging/sbom.mjs" "$target"
(cd "$target" && ls -l *"_${version}_"*.deb | awk '{ printf "%9d  %s\n", $5, $NF }')
