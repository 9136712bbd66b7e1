#!/usr/bin/env bash
# install_packages.sh PACKAGE... [--if-available PACKAGE...]: installs the missing packages and
# prints their size. {clang} in a name stands for the version of the system's clang:
# libclang-rt-{clang}-dev. Needs apt, and root or sudo if a package is missing. Neither starts nor
# enables the services of servers (PostgreSQL, HAProxy).
set -euo pipefail

if ! command -v apt-get >/dev/null; then
    echo "There is no apt-get here, so nothing is installed. Wanted are what Debian names: $*" >&2
    exit 0
fi

is_installed() {
    dpkg-query -W -f='${Status}' "$1" 2>/dev/null | grep -q 'ok installed'
}

# Sets `required` and `optional` to the packages that are missing.
find_missing() {
    local package version list=required
    required=()
    optional=()
    # Fails as long as apt has no lists; no name that needs the version is installed before that.
    version=$( (dpkg-query -W -f='${Depends}\n' clang; apt-cache depends clang) 2>/dev/null | sed -n 's/.*clang-\([0-9]\+\).*/\1/p' | head -n 1 || true)
    for package in "$@"; do
        package=${package/\{clang\}/$version}
        if [ "$package" = --if-available ]; then
            list=optional
        elif ! is_installed "$package"; then
            eval "$list+=(\"\$package\")"
        fi
    done
}

find_missing "$@"
[ ${#required[@]} -gt 0 ] || exit 0

root=()
if [ "$(id -u)" != 0 ]; then
    if ! command -v sudo >/dev/null; then
        echo "These packages are missing, and there is neither root nor sudo to install them: have an administrator run" >&2
        echo "    apt-get install --no-install-recommends ${required[*]}" >&2
        exit 1
    fi
    root=(sudo)
fi

echo "apt installs what is missing: ${required[*]}"
"${root[@]}" apt-get -qq update
find_missing "$@"
for package in "${optional[@]}"; do
    if [ -n "$(apt-cache search --names-only "^$package\$")" ]; then
        required+=("$package")
    else
        echo "    apt has no $package: what needs it is skipped"
    fi
done

log=$(mktemp)
policy=/usr/sbin/policy-rc.d # Debian's own way to say that no service starts
[ -e $policy ] && policy= || printf '#!/bin/sh\nexit 101\n' | "${root[@]}" install -m 755 /dev/stdin $policy
trap 'rm -f "$log"; [ -z "$policy" ] || "${root[@]}" rm -f "$policy"' EXIT

# Prints a line for each tenth of the work, and the output of apt only if it fails.
"${root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -y --no-install-recommends install "${required[@]}" 2>&1 | tee "$log" | awk '
    /newly installed/ { steps = 3 * $3 }
    /^Need to get|^After this operation/ { print "    " $0; fflush() }
    /^Get:|^Unpacking |^Setting up / && steps {
        done++
        if (int(10 * done / steps) > tenths) { tenths = int(10 * done / steps); printf "    %d %%\n", 10 * tenths; fflush() }
    }' || { tail -n 20 "$log" >&2; exit 1; }
for service in haproxy postgresql; do
    if [[ " ${required[*]} " == *" $service "* ]] && command -v systemctl >/dev/null; then
        "${root[@]}" systemctl --quiet disable $service 2>/dev/null || true
    fi
done
