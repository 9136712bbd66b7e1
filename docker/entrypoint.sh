#!/bin/sh
# Starts the daemon in a container. There the daemon listens beyond loopback, which requires keys.
# So the first start creates a key and prints it once; the container stores only its SHA-256. Set
# GEODESICD_KEYS to use your own file of keys. Arguments: the daemon's flags, or `keygen NAME ...`.
set -eu

if [ "${1:-}" = keygen ]; then
    exec geodesicd "$@"
fi
if [ -z "${GEODESICD_KEYS:-}" ]; then
    export GEODESICD_KEYS=/var/lib/geodesicd/access/keys
    if [ ! -s "$GEODESICD_KEYS" ]; then
        umask 077
        mkdir -p "${GEODESICD_KEYS%/*}"
        made=$(geodesicd keygen first --role write 2>/dev/null)
        printf '%s\n' "$made" | sed 1d >"$GEODESICD_KEYS.new"
        mv "$GEODESICD_KEYS.new" "$GEODESICD_KEYS"
        echo "geodesicd: this key was made for you and is not shown again: $(printf '%s\n' "$made" | sed -n 1p)" >&2
        echo "geodesicd: use it as  curl -H 'Authorization: Bearer KEY' ...; more keys: geodesicd keygen NAME >> $GEODESICD_KEYS" >&2
    fi
fi
exec geodesicd "$@"
