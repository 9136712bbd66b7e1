#!/bin/sh
# Starts the daemon in a container. The daemon accepts connections from other machines, so it needs
# keys. The first start creates a key and prints it; the container stores only the key's SHA-256.
# Set GEODESICD_KEYS to use your own file of keys. Arguments: the daemon's flags, or
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
        echo "geodesicd: save this new key, it is not shown again: $(printf '%s\n' "$made" | sed -n 1p)" >&2
        echo "geodesicd: send it as  curl -H 'Authorization: Bearer KEY' ..." >&2
        echo "geodesicd: more keys: geodesicd keygen NAME | tee /dev/stderr | tail -n 1 >> $GEODESICD_KEYS" >&2
    fi
fi
exec geodesicd "$@"
