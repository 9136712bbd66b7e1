#!/bin/sh
# Builds the pages that the daemon serves, outside the checkout.
#
#     build.sh install PLACE    installs the packages that the pages contain, and esbuild, from
#                               package-lock.json into PLACE/node_modules
#     build.sh bundle PLACE     writes the pages into PLACE/pages
#     build.sh check PLACE      checks only types; first installs the compiler and declarations
#
# Commands for the same PLACE wait for each other. `install` links the sources into PLACE, beside
# node_modules, so that their imports resolve and error messages name the files of the checkout.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
place=$2

say() {
    echo "$*" >&2
    exit 1
}

install_packages() {
    command -v npm >/dev/null && [ "$(node -p 'parseInt(process.versions.node)')" -ge 18 ] ||
        say "the viewer is built by node 18 or later and npm, which are not here: make setup installs them; make VIEWER=no builds a daemon without the viewer"
    cp "$here/package.json" "$here/package-lock.json" "$place"
    ln -sfn "$(dirname "$here")" "$place/clients"
    (cd "$place" && timeout 300 npm "$@" --ignore-scripts --no-audit --no-fund --cache "$place/cache" --loglevel=error --fetch-retry-mintimeout=1000 --fetch-retry-maxtimeout=5000) >"$place/npm.log" 2>&1 ||
        say "npm could not install the viewer's packages ($(grep -m 1 -iE 'npm err' "$place/npm.log" || echo 'no answer in 300 s')): connect to its registry," \
            "or go on by make VIEWER=no, which builds a daemon without the viewer; all that npm said is in $place/npm.log"
    rm -rf "$place/cache" # the cache would serve only a second download
    touch "$place/installed"
}

compile() {
    node_modules/.bin/esbuild "$@" --bundle --minify --format=esm --target=es2022 --preserve-symlinks --legal-comments=eof --log-level=warning
}

# Prints the licences of the packages that the bundles contain.
print_notices() {
    for package in three d3-scale-chromatic d3-color d3-interpolate swagger-ui-dist; do
        printf '%s\n\n' "=== $package ==="
        for notice in "node_modules/$package/LICENSE" "node_modules/$package/NOTICE" "node_modules/$package/swagger-ui-es-bundle.js.LICENSE.txt"; do
            [ ! -e "$notice" ] || cat "$notice"
        done
        echo
    done
}

bundle() {
    [ -L "$place/clients" ] || say "$place was not made by: build.sh install $place"
    cd "$place"
    rm -rf pages
    mkdir -p pages/docs
    cp clients/web/index.html clients/web/style.css clients/web/icon.svg pages
    cp clients/web/docs/index.html pages/docs
    compile clients/web/src/main.ts --outfile=pages/app.js
    compile clients/web/src/worker.ts --outfile=pages/worker.js
    compile clients/web/docs/main.ts --outfile=pages/docs/app.js
    print_notices >pages/licenses.txt
}

check() {
    [ -e "$place/node_modules/typescript" ] || {
        before=$(mktemp)
        touch -r "$place/installed" "$before"
        install_packages install --no-save --include=dev
        touch -r "$before" "$place/installed" # the contents of the pages are the same
        rm "$before"
    }
    cd "$place"
    node_modules/.bin/tsc -p clients/web --preserveSymlinks
}

mkdir -p "$place"
exec 9>"$place/lock"
flock 9
case $1 in
install) install_packages ci --omit=dev ;;
bundle) bundle ;;
check) check ;;
*) say "usage: build.sh install|bundle|check PLACE" ;;
esac
