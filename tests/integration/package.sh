#!/usr/bin/env bash
# package.sh SOURCE_DIR BUILD_DIR: makes the Debian packages, looks into them, unpacks sealwatch and uses it as a normal user
# would. Nothing is installed on this machine; everything happens in a temporary directory.
set -euo pipefail
source_dir=$1 build_dir=$2
services=(data-acquisition data-manipulation state-detection health-assessment prognostic-assessment advisory-generation)

scratch=$(mktemp -d)
chmod 755 "$scratch"
root=$scratch/root
up=
cleanup() {
  if [ -n "$up" ]; then kill "$up" && wait "$up" || true; fi
  rm -rf "$scratch"
}
trap cleanup EXIT

fail() {
  echo "$1"
  shift
  for file in "$@"; do echo "--- $file"; cat "$file"; done
  exit 1
}
have() { command -v "$1" >/dev/null || { echo "not checked, as there is no $1: $2"; return 1; }; }

make_packages() {
  cpack --config "$build_dir/CPackConfig.cmake" -G DEB -B "$scratch/packages" >"$scratch/cpack.log" 2>&1 ||
    fail "cpack failed" "$scratch/cpack.log"
  dpkg-deb -x "$scratch"/packages/sealwatch_*.deb "$root"
  dpkg-deb -e "$scratch"/packages/sealwatch_*.deb "$scratch/control"
  dpkg-deb -c "$scratch"/packages/sealwatch-dev_*.deb >"$scratch/development"
}

check_contents() {
  local path
  for path in bin/sealwatch bin/sealwatch-virtual-bench "${services[@]/#/bin/sealwatch-}" lib/sysusers.d/sealwatch.conf \
    lib/systemd/system/sealwatch.target lib/systemd/system/sealwatch@data-acquisition.service.d/clock.conf share/sealwatch/security/security.conf share/doc/sealwatch/{copyright,changelog.gz,README.md,CHANGELOG.md,LICENSE}; do
    [ -s "$root/usr/$path" ] || fail "/usr/$path is not in sealwatch"
  done
  for path in libsealwatch_client.a sealwatchConfig.cmake sealwatch/client/subscriber.hpp idl/advisory_generation.idl; do
    grep -q "/$path\$" "$scratch/development" || fail "$path is not in sealwatch-dev" "$scratch/development"
  done
  diff -r "$source_dir/config" "$root/etc/sealwatch" || fail "the default configuration is another one"
  diff <(cd "$root" && find etc -type f -printf '/%p\n' | sort) <(sort "$scratch/control/conffiles") ||
    fail "the conffiles are not the files below /etc"
}

check_control() {
  local needed script
  # The second is loaded at run time: no linker knows of it.
  for needed in libddsc libsoci-sqlite3-4.0 libyaml-cpp libspdlog libfmt libmatio; do
    grep -q "^Depends:.*\b$needed" "$scratch/control/control" || fail "does not depend on $needed" "$scratch/control/control"
  done
  grep -q '^Recommends: libsoci-postgresql4.0' "$scratch/control/control" || fail "does not recommend PostgreSQL"
  for script in postinst prerm postrm; do
    sh -n "$scratch/control/$script"
    ! grep -E '^[^#]*systemctl.* (start|enable|restart) [^$]' "$scratch/control/$script" || fail "$script starts services by itself"
  done
}

# An overflow of a buffer ends a program; nothing in it is written to and executed, nor bound while it runs.
check_hardening() {
  have readelf "how the programs are hardened" || return 0
  local program
  for program in "$root"/usr/bin/sealwatch*; do
    head -c 4 "$program" | grep -q ELF || continue  # a script
    readelf -hldW "$program" >"$scratch/elf"
    grep -q 'Type: *DYN' "$scratch/elf" || fail "$program is not position-independent" "$scratch/elf"
    grep -q 'GNU_RELRO' "$scratch/elf" && grep -qE '\(FLAGS_1\).*NOW|BIND_NOW' "$scratch/elf" ||
      fail "$program is not bound at its start" "$scratch/elf"
    grep -qE 'GNU_STACK.* RW ' "$scratch/elf" || fail "the stack of $program can be executed" "$scratch/elf"
    readelf --dyn-syms -W "$program" >"$scratch/symbols"
    grep -q '__stack_chk_fail' "$scratch/symbols" || fail "$program does not protect its stack" "$scratch/symbols"
  done
}

check_units() {
  have systemd-analyze "the units" || return 0
  cp -n /lib/systemd/system/{sysinit,basic,shutdown,multi-user}.target "$root/usr/lib/systemd/system/" 2>/dev/null ||
    { echo "not checked, as systemd is not installed: the units"; return 0; }
  local service
  for service in "${services[@]}"; do
    # It says nothing of good units, and has exit status 0 for some bad ones.
    systemd-analyze verify --man=no --root="$root" "sealwatch@$service.service" >"$scratch/verify" 2>&1 &&
      [ ! -s "$scratch/verify" ] || fail "unit sealwatch@$service is faulty" "$scratch/verify"
    grep -q "^Wants=.*sealwatch@$service.service" "$root/usr/lib/systemd/system/sealwatch.target" ||
      fail "sealwatch.target does not want $service"
  done
}

check_identities() {
  have openssl "the identities" || return 0
  "$root/usr/share/sealwatch/security/make_identities.sh" "$scratch/identities" >"$scratch/made" 2>&1 ||
    fail "the installed make_identities.sh fails" "$scratch/made"
  [ -s "$scratch/identities/state-detection/permissions.p7s" ] || fail "there is no permission" "$scratch/made"
}

# What a service that was taken over could do to the machine, by systemd's own measure: 0 nothing, 10 everything.
check_exposure() {
  have systemd-analyze "how far the services are exposed" || return 0
  systemd-analyze security --offline=yes --threshold=15 --no-pager "$root/usr/lib/systemd/system/sealwatch@.service" \
    >"$scratch/exposure" 2>&1 || fail "the services are exposed to more than 1.5" "$scratch/exposure"
}

# The journals of an older package, all in one directory, go to each service's own.
check_move() {
  local old=$scratch/old state=$scratch/old/var/lib/sealwatch
  mkdir -p "$state/log"
  touch "$state"/state_detection.{db,db-wal,tries,lock} "$state"/log/state_detection.{log,1.log} "$state/log/other.log"
  DPKG_ROOT=$old sh "$scratch/control/postinst" configure >"$scratch/moved" 2>&1 || fail "postinst failed" "$scratch/moved"
  DPKG_ROOT=$old sh "$scratch/control/postinst" configure >"$scratch/moved" 2>&1 || fail "postinst failed again" "$scratch/moved"
  diff <(cd "$state" && find . -type f | sort) - <<'EOT' || fail "an older package's state is not moved"
./log/other.log
./state-detection/log/state_detection.1.log
./state-detection/log/state_detection.log
./state-detection/state_detection.db
./state-detection/state_detection.db-wal
./state-detection/state_detection.lock
./state-detection/state_detection.tries
EOT
}

# Complete and consistent, and it names what two others find: ldd in the unpacked programs, dpkg-shlibdeps for the package.
check_sbom() {
  local sbom=$root/usr/share/doc/sealwatch/sbom.spdx.json
  [ -s "$sbom" ] || fail "there is no software bill of materials"
  # dpkg knows a library with or without /usr, or what a link stands for; asked once, as it reads all its lists each time.
  ldd "$root"/usr/bin/* | sed -nE 's/.*=> (\/[^ ]+) .*/\1/p' | sort -u | while read -r file; do
    echo "$file /usr$file $(readlink -f "$file")"
  done >"$scratch/files"
  xargs dpkg-query -S <"$scratch/files" >"$scratch/owned" 2>/dev/null || true
  while read -r file in_usr meant; do
    grep -qF -e ": $file" -e ": $in_usr" -e ": $meant" "$scratch/owned" || fail "$file is of no package"
  done <"$scratch/files"
  sed -E 's/:.*//' "$scratch/owned" | sort -u >"$scratch/libraries"
  dpkg-deb -f "$scratch"/packages/sealwatch_*.deb Depends | tr ',' '\n' | grep -v '|' | awk '{ print $1 }' >>"$scratch/libraries"
  python3 - "$sbom" "$scratch/libraries" >"$scratch/sbom" 2>&1 <<'EOT' || fail "the software bill of materials is faulty" "$scratch/sbom"
import json, re, subprocess, sys
bill = json.load(open(sys.argv[1]))
assert bill["spdxVersion"] == "SPDX-2.3" and bill["dataLicense"] == "CC0-1.0" and bill["SPDXID"] == "SPDXRef-DOCUMENT", "document"
assert bill["name"] and re.match(r"^[a-z]+:[^#\s]+$", bill["documentNamespace"]) and bill["creationInfo"]["creators"], "document"
assert re.match(r"^\d{4}-\d\d-\d\dT\d\d:\d\d:\d\dZ$", bill["creationInfo"]["created"]), "created"
ids = [package["SPDXID"] for package in bill["packages"]]
assert len(ids) == len(set(ids)) and all(re.match(r"^SPDXRef-[A-Za-z0-9.-]+$", one) for one in ids), "ids"
for package in bill["packages"]:
    assert package["name"] and package["versionInfo"] and package["downloadLocation"] and package["filesAnalyzed"] is False, package
for relation in bill["relationships"]:
    for end in ("spdxElementId", "relatedSpdxElement"):
        assert relation[end] in ids + ["SPDXRef-DOCUMENT"], relation
runs_with = {r["relatedSpdxElement"] for r in bill["relationships"] if r["relationshipType"] == "DEPENDS_ON"}
listed = {package["name"]: package for package in bill["packages"] if package["SPDXID"] in runs_with}
def ask(names):
    words = subprocess.run(["dpkg-query", "-W", "-f", "${Package}\t${Version}\t${Provides}\n", *names], capture_output=True, text=True).stdout
    return {package: (version, provides) for package, version, provides in (line.split("\t") for line in reversed(words.splitlines()))}
installed = ask(listed)
provided = {word.split()[0] for _, provides in installed.values() for word in provides.split(",") if word.strip()}
for name in sorted(set(open(sys.argv[2]).read().split()) - provided):
    assert name in listed, name + " is not listed"
    assert listed[name]["versionInfo"] == installed[name][0], name + ": " + listed[name]["versionInfo"]
EOT
}

check_page() {
  have man "the manual page" || return 0
  LC_ALL=C.UTF-8 MANWIDTH=80 man --warnings -E UTF-8 -l "$root/usr/share/man/man1/sealwatch.1.gz" \
    >"$scratch/page" 2>"$scratch/page_warnings" || fail "man cannot show the page" "$scratch/page_warnings"
  [ ! -s "$scratch/page_warnings" ] || fail "the manual page has faults" "$scratch/page_warnings"
  grep -q -e '--with-services' "$scratch/page" || fail "the manual page names no options" "$scratch/page"
  grep -q 'sealwatch replay' "$scratch/page" || fail "the manual page does not tell of replay" "$scratch/page"
}

# The commands that begin with these letters, as --help lists them.
check_completion() {
  local completed listed
  listed=$("${as_user[@]}" "$root/usr/bin/sealwatch" --help | awk '/^  re/ { print $1 }' | sort | paste -sd' ')
  [[ " $listed " == *" replay "* ]] || fail "--help lists '$listed' for 're'"
  completed=$(bash -c 'source "$1"; COMP_WORDS=(sealwatch re); COMP_CWORD=1; _sealwatch; printf "%s\n" "${COMPREPLY[@]}"' bash \
    "$root/usr/share/bash-completion/completions/sealwatch" | sort | paste -sd' ')
  [ "$completed" = "$listed" ] || fail "'sealwatch re' completes to '$completed' and not to '$listed'"
}

check_programs() {
  local version service
  version=$(dpkg-deb -f "$scratch"/packages/sealwatch_*.deb Version)
  [[ "$("${as_user[@]}" "$root/usr/bin/sealwatch" --version)" == "sealwatch $version (commit "* ]] || fail "the program has another version"
  "${as_user[@]}" "$root/usr/bin/sealwatch" config check --config "$root/etc/sealwatch" || fail "the default configuration is faulty"
  for service in "${services[@]}" virtual-bench; do
    [ "$("${as_user[@]}" "$root/usr/bin/sealwatch-$service" --version)" = "$("${as_user[@]}" "$root/usr/bin/sealwatch" --version)" ] ||
      fail "sealwatch-$service has another version"
    "${as_user[@]}" "$root/usr/bin/sealwatch-$service" --help | grep -e --config >/dev/null || fail "sealwatch-$service gives no help"
  done
}

# Five services of six, since the configuration disables one: `up` starts those, and `replay` does not wait for the sixth.
check_services() {
  local sealwatch=$root/usr/bin/sealwatch config=$scratch/config
  cp -r "$root/etc/sealwatch" "$config"
  sed -i '/^  advisory_generation:/,/enabled:/s/enabled: true/enabled: false/' "$config/sealwatch.yaml"
  "${as_user[@]}" "$sealwatch" simulate --asset "$config/assets/xt03-mv2.yaml" --months 1 --rate 50 --out life >"$scratch/simulated"
  "${as_user[@]}" "$sealwatch" up --config "$config" >"$scratch/up" 2>&1 &
  up=$!
  "${as_user[@]}" bash -c '"$1" replay --config "$2" --quiet life/*.csv' bash "$sealwatch" "$config" >"$scratch/replayed" 2>&1 ||
    fail "replay through the unpacked services failed" "$scratch/replayed" "$scratch/up"
  kill "$up"
  wait "$up" || fail "sealwatch up did not end well" "$scratch/up"
  up=
  [ "$(grep -c '^started ' "$scratch/up")" -eq 5 ] || fail "not five services were started" "$scratch/up"
  [ -s "$scratch/home/state/prognostic_assessment.db" ] || fail "there is no journal in ./state"
  [ ! -e "$scratch/home/state/advisory_generation.db" ] || fail "a disabled service was started"
}

# dpkg installs the package into a root of its own, and the demo runs there as a user without rights: of this machine it
# reaches the libraries of Debian's packages and nothing else, the checkout and its configuration least of all.
check_demo() {
  local clean=$scratch/clean libraries lent folder
  [ "$(id -u)" -eq 0 ] && unshare --mount true 2>/dev/null ||
    { echo "not checked, as this user may not change root: the demo from the installed package"; return 0; }
  libraries=usr/lib/$(dpkg-architecture -qDEB_HOST_MULTIARCH)
  lent=("$libraries" usr/share/xml/udunits etc/alternatives proc dev)
  mkdir -p "$clean"/{var/lib/dpkg/{info,updates},tmp,home} "${lent[@]/#/$clean/}"
  for folder in lib lib64; do ln -s "usr/$folder" "$clean/$folder"; done
  cp -r --parents /usr/lib64 "$clean"
  touch "$clean"/var/lib/dpkg/{status,available}
  chown 65534:65534 "$clean"/{home,tmp}
  dpkg --root="$clean" --force-script-chrootless --force-depends -i "$scratch"/packages/sealwatch_*.deb \
    >"$scratch/installed" 2>&1 || fail "dpkg cannot install the package" "$scratch/installed"
  unshare --mount bash -euc '
    cd "$1"
    for folder in "${@:2}"; do mount --rbind "/$folder" "$folder"; done
    in_root() {
      env -i HOME=/home CYCLONEDDS_URI="$CYCLONEDDS_URI" \
        "$(command -v chroot)" --userspec=65534:65534 . /usr/bin/sealwatch "$@"
    }
    in_root simulate --asset /etc/sealwatch/assets/xt03-mv2.yaml --ageing --months 24 --rate 50 --out /home/recordings
    tests=(home/recordings/*.csv)
    in_root replay --config /etc/sealwatch --with-services --state /home/state "${tests[@]/#//}"
  ' bash "$clean" "${lent[@]}" >"$scratch/demo" 2>&1 || fail "the demo from the installed package fails" "$scratch/demo"
  grep -q '^  remaining life .*method' "$scratch/demo" && grep -q '^  advisory  *[A-Z]' "$scratch/demo" ||
    fail "the demo from the installed package ends without forecast and advisory" "$scratch/demo"
}

# Errors only: what lintian merely warns of are this package's own ways (one man page for all services, no tests in it).
check_lint() {
  have lintian "what Debian's policy asks for" || return 0
  lintian --fail-on error --tag-display-limit 0 "$scratch"/packages/*.deb >"$scratch/lintian" 2>&1 ||
    fail "lintian finds errors in the packages" "$scratch/lintian"
}

# The prefix is chosen when installing: units must name it, and what an operator changed must survive a second time.
check_other_prefix() {
  local prefix=$scratch/prefix turn
  for turn in first second; do
    cmake --install "$build_dir" --prefix "$prefix" --component services >"$scratch/install" 2>&1 ||
      fail "the $turn installation to a prefix failed" "$scratch/install"
    echo "# changed after the $turn" >>"$prefix/etc/sealwatch/sealwatch.yaml"
  done
  grep -q "^ExecStart=$prefix/bin/sealwatch-%i --config $prefix/etc/sealwatch " "$prefix/lib/systemd/system/sealwatch@.service" ||
    fail "the unit names another prefix" "$prefix/lib/systemd/system/sealwatch@.service"
  grep -q 'changed after the first' "$prefix/etc/sealwatch/sealwatch.yaml" || fail "a changed configuration was overwritten"
}

export CYCLONEDDS_URI="<CycloneDDS><Domain Id=\"any\"><General><Interfaces><NetworkInterface name=\"lo\" multicast=\"true\"/>\
</Interfaces></General><Discovery><Tag>package-$$</Tag></Discovery></Domain></CycloneDDS>"
unset SEALWATCH_CONFIG
# A user without rights, in a home of his own: using sealwatch must need no more.
mkdir "$scratch/home"
as_user=(env -C "$scratch/home")
if [ "$(id -u)" -eq 0 ]; then
  chown 65534:65534 "$scratch/home"
  as_user+=(setpriv --reuid=65534 --regid=65534 --clear-groups)
fi

have dpkg-shlibdeps "the packages" || exit 0
make_packages
check_contents
check_control
check_hardening
check_units
check_identities
check_exposure
check_move
check_sbom
check_page
check_lint
check_completion
check_programs
check_services
check_demo
check_other_prefix
echo "the package holds what it should, and what it installs works"
