#!/usr/bin/env bash
# install_packages.sh PACKAGE... [--if-available PACKAGE...] [--unpack FOLDER PACKAGES]...
#                     [--download FOLDER PACKAGE] [--npm FOLDER VERSION]
#
# Installs the missing packages and prints their size. {clang} in a name stands for the version of
# the system's clang: libclang-rt-{clang}-dev. --unpack unpacks packages below FOLDER, and installs
# only the libraries that they depend on, not the programs and headers. --download puts an optional
# package and the missing packages that it depends on into FOLDER. --npm installs npm below FOLDER
# if the system has no npm. Needs apt, and root or sudo if a package is missing. Does not start or
# enable the services of servers (PostgreSQL, HAProxy), and creates no database.
set -euo pipefail

# The installation leaves only the packages: no downloads, no caches, no translations.
place=$(mktemp -d)
chmod 755 "$place" # apt downloads as another user
trap 'rm -rf "$place"' EXIT
log=$place/log
cat >"$place/apt.conf" <<END
APT::Keep-Downloaded-Packages "false";
APT::Get::List-Cleanup "false";
Acquire::Languages "none";
Dir::Cache::pkgcache "$place/packages.bin";
Dir::Cache::srcpkgcache "$place/sources.bin";
END
export APT_CONFIG=$place/apt.conf

is_installed() {
    dpkg-query -W -f='${Status}' "$1" 2>/dev/null | grep -q 'ok installed'
}

# Prints the libraries on which the packages below a folder depend. The file `libraries` is there
# once the packages are unpacked.
libraries_of() {
    local folder=$1 packages=$2
    cat "$folder/libraries" 2>/dev/null || apt-cache show --no-all-versions $packages 2>/dev/null | sed -n 's/^Depends: //p' |
        tr , '\n' | sed -n '/-dev\b/d; s/^ *\(lib[^ ]*\).*/\1/p'
}

# Sets `required` and `optional` to the packages that are missing.
find_missing() {
    local package folder version list=required
    required=()
    optional=()
    # The version is empty until apt has its lists. The script installs no package before.
    version=$( (dpkg-query -W -f='${Depends}\n' clang; apt-cache depends clang) 2>/dev/null | sed -n 's/.*clang-\([0-9]\+\).*/\1/p' | head -n 1 || true)
    version=${version:-*}
    for folder in "${!unpacked[@]}"; do
        set -- $(libraries_of "$folder" "${unpacked[$folder]}") "$@"
    done
    for package in "$@"; do
        package=${package/\{clang\}/$version}
        case $package in
        --if-available) list=optional ;;
        *) is_installed "$package" || eval "$list+=(\"\$package\")" ;;
        esac
    done
}

unpack() {
    local folder=$1 packages=$2 package libraries link
    libraries=$(libraries_of "$folder" "$packages")
    (cd "$place" && apt-get -qq download $packages 2>/dev/null) || { echo "apt cannot download $packages" >&2; return 1; }
    rm -rf "$folder"
    mkdir -p "$folder"
    for package in $packages; do
        dpkg-deb -x "$place/${package}"_*.deb "$folder"
    done
    # The linker finds libraries by links, which must lead to the installed libraries.
    find "$folder/usr/lib" -name '*.so' -type l | while read -r link; do
        ln -sfn "$(dirname "${link#"$folder"}")/$(readlink "$link")" "$link"
    done
    echo "$libraries" >"$folder/libraries"
}

# Downloads a package and the missing packages that it depends on.
download() {
    local folder=$1 packages
    packages=$(apt-get -s --no-install-recommends install "$2" 2>"$log" | sed -n 's/^Inst \([^ ]*\).*/\1/p')
    mkdir -p "$folder"
    [ -n "$packages" ] && (cd "$folder" && apt-get -qq download $packages) >>"$log" 2>&1
}

# Debian's npm depends on 350 packages with 200 MB. The script unpacks these packages only to
# install npm from npm's registry, and deletes them afterwards. This npm needs only node.
install_npm() {
    download "$place/archives" npm &&
        find "$place/archives" -name '*.deb' -print0 | xargs -0 -P 2 -I {} dpkg-deb -x {} "$place/npm" &&
        ln -s usr/share/nodejs "$place/npm/node_modules" &&
        node "$place/npm/usr/share/nodejs/npm/bin/npm-cli.js" install --silent --no-audit --no-fund --cache "$place/cache" \
            --prefix "$npm_folder" "npm@$npm_version" >>"$log"
}

# Fetches what the script does not install. This needs no root.
fetch_all() {
    local folder
    for folder in "${!unpacked[@]}"; do
        [ -e "$folder/libraries" ] || unpack "$folder" "${unpacked[$folder]}"
    done
    [ -z "$downloaded" ] || download "$download_folder" "$downloaded" || { rm -rf "$download_folder"; echo "    apt cannot download $downloaded: tests that need it are skipped"; }
    [ -z "$npm_folder" ] || install_npm || { tail -n 20 "$log" >&2; echo "    npm could not be installed: what needs it is skipped" >&2; }
}

wanted=()
declare -A unpacked=() # packages by folder
downloaded=
npm_folder=
while [ $# -gt 0 ]; do
    case $1 in
    --unpack)
        is_installed "${3%% *}" || unpacked[$2]=$3
        shift 3
        ;;
    --download)
        download_folder=$2
        [ -e "$2" ] || is_installed "$3" || downloaded=$3
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
    echo "There is no apt-get here, so nothing is installed. Wanted are what Debian names: ${wanted[*]} ${unpacked[*]} $downloaded" >&2
    exit 0
fi
if [ -e "$npm_folder/node_modules/.bin/npm" ] || command -v npm >/dev/null; then
    npm_folder=
fi

# Packages to unpack, or npm. An optional download alone is not a reason to ask for root.
to_fetch=${npm_folder:+npm}
for folder in "${!unpacked[@]}"; do
    [ -e "$folder/libraries" ] || to_fetch+=" ${unpacked[$folder]}"
done

lists=/var/lib/apt/lists
had_lists=$(find $lists -name '*_Packages*' -print -quit 2>/dev/null)
# A system without lists, such as a container's image, gets no documentation and no translations.
[ -n "$had_lists" ] || cat >>"$place/apt.conf" <<END
DPkg::Options { "--path-exclude=/usr/share/doc/*"; "--path-exclude=/usr/share/man/*"; "--path-exclude=/usr/share/locale/*"; };
END
find_missing "${wanted[@]}"
if [ ${#required[@]} = 0 ] && [ -n "$had_lists" ]; then
    fetch_all
    exit 0
elif [ ${#required[@]} = 0 ] && [ -z "$to_fetch" ]; then
    exit 0
fi

root=()
if [ "$(id -u)" != 0 ]; then
    if ! command -v sudo >/dev/null; then
        echo "These packages are missing, and there is neither root nor sudo to install them: have an administrator run" >&2
        echo "    apt-get install --no-install-recommends ${required[*]} $to_fetch" >&2
        exit 1
    fi
    root=(sudo)
fi
root+=(env "APT_CONFIG=$APT_CONFIG" DEBIAN_FRONTEND=noninteractive)

[ ${#required[@]} = 0 ] || echo "apt installs what is missing: ${required[*]}"
[ -z "$to_fetch" ] || echo "The script unpacks below build, without installing:" $to_fetch
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

# If the system had no lists before, as in a container's image, the script removes them.
temporary=()
trap 'rm -rf "$place"; "${root[@]}" rm -f "${temporary[@]}"; [ -n "$had_lists" ] || "${root[@]}" find $lists -type f -delete' EXIT
# Writes a file that exists only while apt installs, unless the system has this file.
configure() {
    [ -e "$1" ] || { temporary+=("$1"); "${root[@]}" install -D -m "$2" /dev/stdin "$1"; }
}
configure /usr/sbin/policy-rc.d 755 <<<$'#!/bin/sh\nexit 101' # Debian starts no service
if [[ " ${required[*]} " == *" postgresql "* ]]; then
    configure /etc/postgresql-common/createcluster.d/geodesicd.conf 644 <<<'create_main_cluster = false'
fi

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
fetch_all
for service in haproxy postgresql; do
    if [[ " ${required[*]} " == *" $service "* ]] && command -v systemctl >/dev/null; then
        "${root[@]}" systemctl --quiet disable $service 2>/dev/null || true
    fi
done
