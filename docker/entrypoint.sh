#!/bin/sh
# Starts the daemon in a container. It listens beyond loopback there, which it does with keys only: so the first start makes one and
# prints it, once; only its SHA-256 is kept. GEODESICD_KEYS names a file of your own instead. Arguments are the daemon's flags, or
# `keygen NAME ...`.
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
