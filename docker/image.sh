#!/bin/sh
# image.sh BUILD: builds the image `geodesicd` with docker, podman or buildah. Labels the image with
# version, revision, date and source. Writes its software bill of materials to BUILD/sbom.spdx.json.
# Variables: BASE: another image of Debian 12; SOURCE: the address of the sources; VIEWER=no: leaves
# out the viewer, which needs npm.
set -eu
build=$1
builder=$(command -v docker || command -v podman || command -v buildah) || {
    echo "install docker, podman or buildah" >&2
    exit 1
}
version=$(sed -n 's/^  version: *//p' proto/openapi.yaml | head -n 1)
revision=$(git rev-parse HEAD 2>/dev/null || echo unknown)
created=$(TZ=UTC git log -1 --format=%cd --date=format-local:%Y-%m-%dT%H:%M:%SZ 2>/dev/null || date -u +%Y-%m-%dT%H:%M:%SZ)
parts=/usr/share/doc/geodesicd/sbom.spdx.json

"$builder" build ${BASE:+--build-arg BASE="$BASE"} ${VIEWER:+--build-arg VIEWER="$VIEWER"} ${SOURCE:+--build-arg SOURCE="$SOURCE"} \
    --build-arg VERSION="$version" --build-arg REVISION="$revision" --build-arg CREATED="$created" -t geodesicd -f docker/Dockerfile .

mkdir -p "$build"
case $builder in
*/buildah)
    container=$("$builder" from geodesicd)
    "$builder" run "$container" -- cat "$parts" >"$build/sbom.spdx.json"
    "$builder" rm "$container" >/dev/null
    ;;
*)
    "$builder" run --rm --entrypoint cat geodesicd "$parts" >"$build/sbom.spdx.json"
    "$builder" image inspect --format 'geodesicd: {{.Size}} bytes' geodesicd
    ;;
esac
echo "bill of materials: $build/sbom.spdx.json"
