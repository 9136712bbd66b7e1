#!/usr/bin/env bash
# install_packages.sh PACKAGE... [--if-available PACKAGE...] [--headers FOLDER PACKAGE]
#                     [--npm FOLDER VERSION]
#
# Installs the missing packages and prints their size. {clang} in a name stands for the version of
# the system's clang: libclang-rt-{clang}-dev. --headers unpacks one package below FOLDER, without
# the packages that it depends on, and installs only the libraries of the same source. --npm
# installs npm below FOLDER if the system has no npm. Needs apt, and root or sudo if a package is
# missing. Does not start or enable the services of servers (PostgreSQL, HAProxy).
set -euo pipefail

# The installation leaves only the packages: no downloads, no caches, no translations.
place=$(mktemp -d)
chmod 755 "$place" # apt downloads as another user
trap 'rm -rf "$place"' EXIT
cat >"$place/apt.conf" <<END
APT::Keep-Downloaded-Packages "false";
APT::Get::List-Cleanup "false";
Acquire::Languages "none";
Dir::Cache::pkgcache "";
Dir::Cache::srcpkgcache "";
END
export APT_CONFIG=$place/apt.conf

is_installed() {
    dpkg-query -W -f='${Status}' "$1" 2>/dev/null | grep -q 'ok installed'
}

# Prints the control fields of the package that is or will be unpacked.
headers_control() {
    if [ -e "$folder/DEBIAN/control" ]; then
        cat "$folder/DEBIAN/control"
    else
        apt-cache show --no-all-versions "$headers" 2>/dev/null
    fi
}

# Sets `required` and `optional` to the packages that are missing.
find_missing() {
    local package version list=required
    required=()
    optional=()
    # The version is empty until apt has its lists. The script installs no package before.
    version=$( (dpkg-query -W -f='${Depends}\n' clang; apt-cache depends clang) 2>/dev/null | sed -n 's/.*clang-\([0-9]\+\).*/\1/p' | head -n 1 || true)
    version=${version:-*}
    if [ -n "$headers" ]; then # the libraries of the same source: dependencies with a fixed version
        set -- "$@" --headers $(headers_control | sed -n 's/^Depends: //p' | tr , '\n' | sed -n 's/^ *\([^ ]*\) (= .*/\1/p')
    fi
    for package in "$@"; do
        package=${package/\{clang\}/$version}
        case $package in
        --if-available) list=optional ;;
        --headers) list=required ;;
        *) is_installed "$package" || eval "$list+=(\"\$package\")" ;;
        esac
    done
}

unpack_headers() {
    local link
    (cd "$place" && apt-get -qq download "$headers" 2>/dev/null) || { echo "apt cannot download $headers" >&2; return 1; }
    rm -rf "$folder"
    mkdir -p "$(dirname "$folder")"
    dpkg-deb -R "$place/$headers"_*.deb "$folder"
    # The linker finds libraries by links, which must lead to the installed libraries.
    find "$folder/usr/lib" -name '*.so' -type l | while read -r link; do
        ln -sfn "$(dirname "${link#"$folder"}")/$(readlink "$link")" "$link"
    done
}

# Debian's npm depends on 350 packages with 200 MB. The script unpacks these packages only to
# install npm from npm's registry, and deletes them afterwards. This npm needs only node.
install_npm() {
    mkdir -p "$place/archives/partial"
    "${root[@]}" apt-get -qq -y --no-install-recommends --download-only -o Dir::Cache::archives="$place/archives" install npm >"$log" &&
        find "$place/archives" -name '*.deb' -print0 | xargs -0 -P 2 -I {} dpkg-deb -x {} "$place/npm" &&
        ln -s usr/share/nodejs "$place/npm/node_modules" &&
        node "$place/npm/usr/share/nodejs/npm/bin/npm-cli.js" install --silent --no-audit --no-fund --cache "$place/cache" \
            --prefix "$npm_folder" "npm@$npm_version" >>"$log"
}

wanted=()
headers=
npm_folder=
while [ $# -gt 0 ]; do
    case $1 in
    --headers)
        folder=$2
        headers=$3
        shift 3
        ;;
    --npm)
        npm_folder=$2
        npm_version=$3
        shift 3
        ;;
    *)
        wanted+=("$1")
        shift
        ;;
    esac
done
if ! command -v apt-get >/dev/null; then
    echo "There is no apt-get here, so nothing is installed. Wanted are what Debian names: ${wanted[*]} $headers" >&2
    exit 0
fi

is_unpacked=true
if [ -n "$headers" ] && is_installed "$headers"; then
    headers=
elif [ -n "$headers" ]; then
    [ -e "$folder/DEBIAN/control" ] || is_unpacked=false
fi
if [ -e "$npm_folder/node_modules/.bin/npm" ] || command -v npm >/dev/null; then
    npm_folder=
fi

find_missing "${wanted[@]}"
if [ ${#required[@]} = 0 ] && $is_unpacked && [ -z "$npm_folder" ]; then
    exit 0
fi

if [ ${#required[@]} = 0 ] && [ -z "$npm_folder" ] &&
    apt-cache show "$headers" >/dev/null 2>&1; then # this needs no root
    unpack_headers
    exit 0
fi

root=()
if [ "$(id -u)" != 0 ]; then
    if ! command -v sudo >/dev/null; then
        echo "These packages are missing, and there is neither root nor sudo to install them: have an administrator run" >&2
        echo "    apt-get install --no-install-recommends ${required[*]}${npm_folder:+ npm} $headers" >&2
        exit 1
    fi
    root=(sudo)
fi
root+=(env "APT_CONFIG=$APT_CONFIG" DEBIAN_FRONTEND=noninteractive)

$is_unpacked && headers_too= || headers_too=", and the headers of $headers"
echo "apt installs what is missing: ${required[*]}$headers_too${npm_folder:+, and npm below $npm_folder}"
lists=/var/lib/apt/lists
had_lists=$(find $lists -name '*_Packages*' -print -quit 2>/dev/null)
"${root[@]}" apt-get -qq update
find_missing "${wanted[@]}"
available=()
for package in "${optional[@]}"; do
    if [ -n "$(apt-cache search --names-only "^$package\$")" ]; then
        available+=("$package")
    else
        echo "    apt has no package $package: tests that need it are skipped"
    fi
done

log=$place/log
policy=/usr/sbin/policy-rc.d # by this file, Debian starts no service
[ -e $policy ] && policy= || printf '#!/bin/sh\nexit 101\n' | "${root[@]}" install -m 755 /dev/stdin $policy
# If the system had no lists before, as in a container's image, the script removes them.
trap 'rm -rf "$place"; [ -z "$policy" ] || "${root[@]}" rm -f "$policy"; [ -n "$had_lists" ] || "${root[@]}" find $lists -type f -delete' EXIT

# Installs packages. Prints a line for each tenth of the work, and apt's output only if it fails.
install_all() {
    "${root[@]}" apt-get -y --no-install-recommends install "$@" 2>&1 | tee "$log" | awk '
        /newly installed/ { steps = 3 * $3 }
        /^Need to get|^After this operation/ { print "    " $0; fflush() }
        /^Get:|^Unpacking |^Setting up / && steps {
            done++
            if (int(10 * done / steps) > tenths) { tenths = int(10 * done / steps); printf "    %d %%\n", 10 * tenths; fflush() }
        }' || { tail -n 20 "$log" >&2; return 1; }
}

[ ${#required[@]} = 0 ] || install_all "${required[@]}"
[ ${#available[@]} = 0 ] || install_all "${available[@]}" ||
    echo "    not all of ${available[*]} could be installed: tests that need them are skipped"
$is_unpacked || unpack_headers
for service in haproxy postgresql; do
    if [[ " ${required[*]} " == *" $service "* ]] && command -v systemctl >/dev/null; then
        "${root[@]}" systemctl --quiet disable $service 2>/dev/null || true
    fi
done
[ -z "$npm_folder" ] || install_npm || { tail -n 20 "$log" >&2; echo "    npm could not be installed: what needs it is skipped" >&2; }
