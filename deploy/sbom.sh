#!/usr/bin/env bash
# sbom.sh VERSION OUTPUT PROGRAM...: a software bill of materials (SPDX 2.3, JSON): sealwatch, the Debian packages that its programs
# are linked to or load, and those that they were built with (headers of which are in the programs).
set -euo pipefail
[ $# -ge 3 ] || { echo "usage: $0 VERSION OUTPUT PROGRAM..." >&2; exit 2; }
version=$1 output=$2
shift 2
here=$(cd "$(dirname "$0")" && pwd)
loaded=(/usr/lib/*/libsoci_sqlite3.so.4.0 /usr/lib/*/libddsc0debian/libdds_security_*.so)  # at run time: no linker knows of them
export LC_ALL=C

# The package of each library that the programs are linked to, directly or not. dpkg is asked once, as it reads all its
# lists each time; it may know a library by another name: /lib is /usr/lib where /usr is merged.
linked() {
  local files owned file in_usr meant
  files=$({ ldd "$@" "${loaded[@]}" | sed -nE 's/.*=> (\/[^ ]+) .*/\1/p'; printf '%s\n' "${loaded[@]}"; } | sort -u |
    while read -r file; do echo "$file /usr$file $(readlink -f "$file")"; done)
  owned=$(xargs dpkg-query -S <<<"$files" 2>/dev/null || true)
  while read -r file in_usr meant; do
    grep -qF -e ": $file" -e ": $in_usr" -e ": $meant" <<<"$owned" || { echo "$0: $file belongs to no package" >&2; exit 1; }
  done <<<"$files"
  sed -E 's/(:[a-z0-9]+)?: .*//' <<<"$owned" | sort -u
}

built_with() {
  sed -n '/^build_packages=(/,/^)/p' "$here/install_packages.sh" | sed '1d;$d; s/#.*//' | tr -s ' ' '\n' | sed '/^$/d' | sort -u
}

package() {  # NAME VERSION SUPPLIER LICENCE PURL
  printf '  {"SPDXID": "SPDXRef-Package-%s", "name": "%s", "versionInfo": "%s", "supplier": "%s",' "${1//[^A-Za-z0-9.-]/-}" "$1" "$2" "$3"
  printf ' "downloadLocation": "NOASSERTION", "filesAnalyzed": false, "licenseConcluded": "NOASSERTION",'
  printf ' "licenseDeclared": "%s", "copyrightText": "NOASSERTION"' "$4"
  [ -z "$5" ] || printf ', "externalRefs": [{"referenceCategory": "PACKAGE-MANAGER", "referenceType": "purl", "referenceLocator": "%s"}]' "$5"
  printf '}'
}

relation() {  # FROM TYPE TO
  printf ',\n  {"spdxElementId": "SPDXRef-%s", "relationshipType": "%s", "relatedSpdxElement": "SPDXRef-Package-%s"}' "$1" "$2" \
    "${3//[^A-Za-z0-9.-]/-}"
}

debian_package() {
  local found architecture
  found=${installed[$1]:?"$1 is not installed"}
  architecture=${found#* }
  package "$1" "${found% *}" 'Organization: Debian' NOASSERTION \
    "pkg:deb/debian/${1//+/%2B}@${found% *}?arch=$architecture"
}

libraries=$(linked "$@")
mapfile -t runs_with <<<"$libraries"
mapfile -t builds_with < <(comm -23 <(built_with) <(printf '%s\n' "${runs_with[@]}"))
declare -A installed
while read -r name found; do
  : "${installed[$name]:=$found}"
done < <(dpkg-query -W -f '${Package} ${Version} ${Architecture}\n' "${runs_with[@]}" "${builds_with[@]}")
created=$(date -u -d "@${SOURCE_DATE_EPOCH:-$(date +%s)}" +%FT%TZ)
packages=$(
  package sealwatch "$version" 'Organization: sealwatch contributors' Apache-2.0 ''
  for name in "${runs_with[@]}" "${builds_with[@]}"; do printf ',\n'; debian_package "$name"; done
)
relations=$(
  printf '  {"spdxElementId": "SPDXRef-DOCUMENT", "relationshipType": "DESCRIBES", "relatedSpdxElement": "SPDXRef-Package-sealwatch"}'
  for name in "${runs_with[@]}"; do relation Package-sealwatch DEPENDS_ON "$name"; done
  for name in "${builds_with[@]}"; do relation "Package-${name//[^A-Za-z0-9.-]/-}" BUILD_DEPENDENCY_OF sealwatch; done
)
mkdir -p "$(dirname "$output")"
cat >"$output" <<EOT
{
 "spdxVersion": "SPDX-2.3",
 "dataLicense": "CC0-1.0",
 "SPDXID": "SPDXRef-DOCUMENT",
 "name": "sealwatch-$version",
 "documentNamespace": "urn:sealwatch:sbom:$version:$(sha256sum <<<"$packages" | cut -c1-32)",
 "creationInfo": {"created": "$created", "creators": ["Tool: sealwatch-sbom.sh", "Organization: sealwatch contributors"]},
 "packages": [
$packages
 ],
 "relationships": [
$relations
 ]
}
EOT
