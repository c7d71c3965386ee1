#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Installs what is missing, builds, and starts the daemon. Safe to run again: what is there is left alone.
set -eu

usage() {
    cat <<'TEXT'
Usage: sh server/run.sh [--build-only] [--with WHAT]... [--] [OPTION of facciad]...
Installs what is missing (Debian packages, npm packages), builds, and starts facciad on 127.0.0.1:8080.

  --build-only    stop after the build
  --with kokoro   installs Kokoro's neural voices and ONNX Runtime too: a download of 540 MB; 370 MB stay
  --with film     installs what 'faccia film' needs, and audiobooks: chromium-headless-shell and ffmpeg
  -h, --help      print this and exit

Options of facciad: build/server/daemon/facciad --help. For example: sh server/run.sh --port 9000
TEXT
}

die() {
    echo "run.sh: $*" >&2
    exit 1
}

build_only=no
kokoro=no
film=no
while [ $# -gt 0 ]; do
    case $1 in
    -h | --help)
        usage
        exit 0
        ;;
    --build-only) build_only=yes ;;
    --with)
        case ${2:-} in
        kokoro) kokoro=yes ;;
        film) film=yes ;;
        *) die "--with takes: kokoro, film" ;;
        esac
        shift
        ;;
    --)
        shift
        break
        ;;
    *) break ;;
    esac
    shift
done

root=$(cd "$(dirname "$0")/.." && pwd)
. "$root/server/setup.sh"

need_packages gcc libc6-dev pkg-config meson ninja-build python3 libwebsockets-dev libwebsockets-evlib-uv libssl-dev libuv1-dev \
    libexpat1-dev libicu-dev libjansson-dev libsndfile1-dev libfaad-dev libvo-aacenc-dev libsonic-dev libgsl-dev zlib1g-dev libjwt-dev uthash-dev libopus-dev libogg-dev \
    libsoxr-dev libsystemd-dev libespeak-ng-dev espeak-ng-data libsqlite3-dev libutf8proc-dev libseccomp-dev \
    libzip-dev libcmark-gfm-dev libcmark-gfm-extensions-dev libstemmer-dev libcurl4-openssl-dev libmosquitto-dev libhiredis-dev libqrencode-dev
want_packages festival festvox-italp16k festvox-itapc16k festvox-us-slt-hts
need_node
need_modules "$root/models"
need_modules "$root/web"
[ $film = no ] || need_packages chromium-headless-shell ffmpeg libgl1-mesa-dri
[ $kokoro = no ] || need_weights "$root/server/plugins/kokoro" 930
build "$root/build"

[ $build_only = yes ] && exit 0
exec "$root/build/server/daemon/facciad" "$@"
