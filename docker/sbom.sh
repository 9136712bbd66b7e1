#!/bin/sh
# sbom.sh VERSION [CREATED]: prints the software bill of materials of the image in which it runs, as
# SPDX 2.3 in JSON. It lists the packages that dpkg knows. Uses only the shell, sed and dpkg-query,
# because the image has no other tools.
set -eu
version=$1
created=${2:-$(date -u +%Y-%m-%dT%H:%M:%SZ)}

distro=debian-$(. /etc/os-release && echo "${VERSION_ID:-unknown}")

packages() {
    dpkg-query --show --showformat '${Package}|${Version}|${Architecture}\n'
}

# Prints the entry of a package. SPDX identifiers have only letters, digits, dots and dashes.
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
