#!/bin/sh
# sbom.sh VERSION [CREATED]: the parts list of the image that this runs in, as SPDX 2.3 in JSON, by what dpkg knows of its packages.
# By the shell, sed and dpkg-query alone: the image has nothing else.
set -eu
version=$1
created=${2:-$(date -u +%Y-%m-%dT%H:%M:%SZ)}

distro=debian-$(. /etc/os-release && echo "${VERSION_ID:-unknown}")

packages() {
    dpkg-query --show --showformat '${Package}|${Version}|${Architecture}\n'
}

# Identifiers have letters, digits, dots and dashes only.
package() {
    identifier=$(printf %s "$1-$3" | sed 's/[^A-Za-z0-9.-]/-/g')
    quoted=$(printf %s "$1@$2" | sed 's/+/%2B/g; s/:/%3A/g; s/~/%7E/g')
    printf ',\n    {"SPDXID": "SPDXRef-%s", "name": "%s", "versionInfo": "%s", "supplier": "Organization: Debian",' "$identifier" "$1" "$2"
    printf ' "downloadLocation": "NOASSERTION", "filesAnalyzed": false, "externalRefs": [{"referenceCategory": "PACKAGE-MANAGER",'
    printf ' "referenceType": "purl", "referenceLocator": "pkg:deb/debian/%s?arch=%s&distro=%s"}]}' "$quoted" "$3" "$distro"
    relationships=$relationships$(printf ',\n    {"spdxElementId": "SPDXRef-geodesicd", "relationshipType": "DEPENDS_ON", "relatedSpdxElement": "SPDXRef-%s"}' "$identifier")
}

cat <<END
{
  "spdxVersion": "SPDX-2.3",
  "dataLicense": "CC0-1.0",
  "SPDXID": "SPDXRef-DOCUMENT",
  "name": "geodesicd-$version",
  "documentNamespace": "urn:geodesicd:sbom:$version:$(packages | sha256sum | cut -c1-32)",
  "creationInfo": {"created": "$created", "creators": ["Tool: geodesicd-sbom"]},
  "packages": [
END
printf '    {"SPDXID": "SPDXRef-geodesicd", "name": "geodesicd", "versionInfo": "%s", "supplier": "Organization: the geodesicd authors",' "$version"
printf ' "downloadLocation": "NOASSERTION", "filesAnalyzed": false, "licenseDeclared": "MIT", "primaryPackagePurpose": "APPLICATION"}'
relationships='    {"spdxElementId": "SPDXRef-DOCUMENT", "relationshipType": "DESCRIBES", "relatedSpdxElement": "SPDXRef-geodesicd"}'
list=$(packages)
while IFS='|' read -r name number architecture; do
    package "$name" "$number" "$architecture"
done <<END
$list
END
printf '\n  ],\n  "relationships": [\n%s\n  ]\n}\n' "$relationships"
