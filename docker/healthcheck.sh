#!/bin/bash
# Succeeds if /livez answers 200; with TLS, if the daemon accepts a connection. Uses only bash,
# because the image has no HTTP client.
port=${GEODESICD_LISTEN##*:}
exec 3<>"/dev/tcp/127.0.0.1/$port" || exit 1
[ -n "${GEODESICD_TLS_CERT:-}" ] && exit 0
printf 'GET /livez HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n' >&3
read -r -t 4 _ status _ <&3
[ "$status" = 200 ]
