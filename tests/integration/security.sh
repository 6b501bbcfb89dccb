#!/usr/bin/env bash
# security.sh SOURCE_DIR BIN_DIR DDS_RIGHTS LENIENT_RIGHTS: the six services under DDS Security, one recorded test through them, and strangers of every
# kind beside them. Everything happens in a temporary directory and a discovery tag of its own. Exit status 77: not checked.
set -euo pipefail
source_dir=$1 bin=$2 dds_rights=$3 lenient_rights=$4
config=$source_dir/config
maker=$source_dir/deploy/security/make_identities.sh
layers=(data-acquisition data-manipulation state-detection health-assessment prognostic-assessment advisory-generation)

command -v openssl >/dev/null || { echo "not checked, as there is no openssl"; exit 77; }
compgen -G '/usr/lib/*/libddsc0debian/libdds_security_auth.so' >/dev/null ||
  { echo "not checked, as Cyclone DDS has no security plugins here"; exit 77; }

scratch=$(mktemp -d)
tag=security-$$
ours=$scratch/ours rogue=$scratch/rogue
up=
watcher=
lenient=()
cleanup() {
  local process
  for process in $watcher "${lenient[@]}" $up; do kill "$process" 2>/dev/null || true; done
  wait
  rm -rf "$scratch"
}
trap cleanup EXIT

fail() {
  echo "$1"
  shift
  for file in "$@"; do echo "--- $file"; head -60 "$file"; done
  exit 1
}

# A command of sealwatch under an identity: as DIRECTORY/NAME COMMAND...
as() {
  local identity=$1
  shift
  CYCLONEDDS_URI=file://$identity/cyclonedds.xml "$bin/sealwatch" "$@" --config "$config"
}

# A copy of an identity of ours, to be tampered with.
copy_of() {  # NAME COPY
  cp -r "$ours/$1" "$scratch/$2"
  sed -i "s|$ours/$1/|$scratch/$2/|" "$scratch/$2/cyclonedds.xml"
}

permissions_of() {  # NAME
  openssl smime -verify -text -CAfile "$ours/ca/permissions_ca.pem" -in "$ours/$1/permissions.p7s" 2>/dev/null | tr -d '\r'
}

sign() {  # XML FILE
  openssl smime -sign -text -in "$1" -signer "$ours/ca/permissions_ca.pem" -inkey "$ours/ca/permissions_ca.key" -out "$2"
}

# ---- the script itself ---------------------------------------------------------------------------------------------------------

check_usage() {
  local words status said
  mkdir -p "$scratch/orphans" && cp -r "$ours/operator" "$scratch/orphans"  # the authorities are in the safe
  while IFS='|' read -r words said; do
    status=0
    # shellcheck disable=SC2086  # a line of words
    "$maker" $words >"$scratch/said" 2>&1 || status=$?
    [ $status -eq 2 ] || fail "make_identities.sh $words: exit status $status" "$scratch/said"
    grep -qF -- "$said" "$scratch/said" || fail "make_identities.sh $words: not '$said'" "$scratch/said"
  done <<EOT
|usage: make_identities.sh
$scratch/none add display --may read|$scratch/none/ca is not there
$scratch/orphans|$scratch/orphans/ca is not there
$ours add display|add needs --may RIGHTS
$ours add display --may write|'write' is not a right
$ours add Display --may read|'Display' must be a name of small letters
$ours add operator --may read|$ours/operator is taken
$ours renew opertor|$ours/opertor is no identity
$ours renew operator --days 0|--days: '0' must be a whole number
$ours renew operator --days 9000|longer than the authorities hold
$ours remove operator|'remove' must be make, add, renew, revoke or list
$ours --domain 3|--domain counts only when the authorities are made
$ours --dasy 3|'--dasy' is not a known option
EOT
  status=0
  "$bin/sealwatch" up --config "$config" --security "$scratch/none" >"$scratch/said" 2>&1 || status=$?
  [ $status -eq 2 ] || fail "up starts without identities" "$scratch/said"
  grep -qF "$scratch/none/subscriber/cyclonedds.xml: is not there" "$scratch/said" || fail "up does not say what is missing" "$scratch/said"
  "$maker" --help | grep 'examples:' >/dev/null || fail "--help has no examples"
  [ -z "$(find "$ours" -name '*.key' -perm /077)$(find "$ours" -name key.pem ! -perm 600)" ] || fail "others can read a private key"
}

# The topics of which the first table of docs/topics.md says that a layer is theirs, by the column's heading. A row that begins with
# no topic's name ends the table; service_status and resend_request, which every service has, name no layer.
documented() {  # LAYER HEADING
  awk -F' *[|] *' -v heading="$2" -v layer="${1//-/_}" '
    $2 == "topic" { for (i = 3; i < NF; ++i) if ($i == heading) column = i; table = 1; next }
    table && /^[|]-/ { next }
    table && !/^[|] `[a-z_]+` [|]/ { exit }
    table && (" " $column ",") ~ "[ ,]" layer "," { gsub(/`/, "", $2); print $2 }
    END { if (!column) { print "docs/topics.md has no column " heading > "/dev/stderr"; exit 1 } }' "$source_dir/docs/topics.md"
}

# What DDS Security itself grants: to each layer what docs/topics.md says of it, to each role its own acts and no other.
check_rights() {
  local name conclusions acts granted expected
  conclusions='acknowledgement act_record advisory health_report leakage_estimate maintenance_event model_acceptance model_discrepancy pst_request
    remaining_life retraction state_report test_features'
  local -A acts_of=([sender]=raw_samples [replay]='raw_samples resend_request' [operator]=acknowledgement
    [maintenance]=maintenance_event [reviewer]=retraction [engineer]=model_acceptance [subscriber]='')
  for name in "${layers[@]}" "${!acts_of[@]}"; do
    granted=$(CYCLONEDDS_URI=file://$ours/$name/cyclonedds.xml "$dds_rights" "$config" 2>"$scratch/rights_errors" | sort) ||
      fail "$name cannot join" "$scratch/rights_errors"
    if [ -z "${acts_of[$name]+role}" ]; then
      expected=$({
        printf 'write service_status\nwrite resend_request\nread service_status\n'
        documented "$name" "written by" | sed 's/^/write /'
        documented "$name" "read by" | sed 's/^/read /'
      } | sort)
    else
      acts=${acts_of[$name]}
      # shellcheck disable=SC2086  # lists of words
      expected=$({
        [ -z "$acts" ] || printf 'write %s\n' $acts
        if [ "$name" = sender ]; then printf 'read %s\n' pst_request maintenance_event retraction; else printf 'read %s\n' $conclusions; fi
        echo read service_status
      } | sort)
    fi
    [ "$granted" = "$expected" ] || fail "the rights of $name are not: $(diff <(echo "$expected") <(echo "$granted"))"
  done
}

# ---- the services --------------------------------------------------------------------------------------------------------------

start_services() {
  : >"$scratch/up"
  "$bin/sealwatch" up --config "$config" --state "$scratch/state" --security "$ours" >"$scratch/up" 2>&1 &
  up=$!
  local attempt
  for ((attempt = 0; attempt < 300; ++attempt)); do
    ! grep -q 'sealwatch is up' "$scratch/up" || return 0
    sleep 0.1
  done
  fail "the secured services are not up" "$scratch/up"
}

stop_services() {
  kill "$up"
  wait "$up" || fail "sealwatch up did not end well" "$scratch/up"
  up=
}

# One recorded test goes all the way, and who may only read receives the advisory.
check_test() {
  "$bin/sealwatch" simulate --asset "$config/assets/xt03-mv2.yaml" --months 1 --rate 50 --out "$scratch/life" >"$scratch/simulated" 2>&1
  as "$ours/subscriber" watch advisory --json >"$scratch/watched" 2>"$scratch/watch_errors" &
  watcher=$!
  as "$ours/replay" replay --quiet "$scratch"/life/*.csv >"$scratch/replayed" 2>&1 ||
    fail "a test does not go through the secured services" "$scratch/replayed" "$scratch/up"
  local attempt
  for ((attempt = 0; attempt < 100; ++attempt)); do
    ! grep -q '"topic":"advisory"' "$scratch/watched" || break
    sleep 0.1
  done
  pkill -P "$watcher" || kill "$watcher"  # the program, not the shell that waits for it
  wait "$watcher" || true
  watcher=
  advisory=$(grep -o '"advisory_id":"[^"]*"' "$scratch/watched" | head -1 | cut -d'"' -f4)
  [ -n "$advisory" ] || fail "a read-only subscriber receives no advisory" "$scratch/watched" "$scratch/watch_errors"
  ! grep -r 'not published\|Not Allowed' "$scratch/state/log" || fail "a service lacks a right"
}

# ---- strangers -----------------------------------------------------------------------------------------------------------------

# Runs `sealwatch status` for a few seconds under each identity at once, a subscriber of ours among them: what that one sees, the
# others could have seen.
look_around() {  # IDENTITY...
  local identity
  local -A lookers=()
  for identity in "$@"; do
    as "$identity" status --json --seconds 4 >"$identity.saw" 2>"$identity.errors" &
    lookers[$identity]=$!
  done
  for identity in "$@"; do wait "${lookers[$identity]}" || true; done
}
saw_services() { grep -q '"state": *"running"' "$1.saw"; }

check_strangers() {
  local stranger
  mkdir "$scratch/unknown"
  printf '<CycloneDDS><Domain Id="any"><General><Interfaces><NetworkInterface name="lo" multicast="true"/></Interfaces></General>%s' \
    "<Discovery><LeaseDuration>2s</LeaseDuration><Tag>$tag</Tag></Discovery></Domain></CycloneDDS>" >"$scratch/unknown/cyclonedds.xml"
  copy_of operator forged  # a certificate of ours, rights signed by somebody else
  cp "$rogue/operator/"{permissions_ca.pem,permissions.p7s,governance.p7s} "$scratch/forged"
  copy_of subscriber altered
  sed -i 's|<subscribe>|<publish><topics><topic>sealwatch/acknowledgement</topic></topics></publish><subscribe>|' \
    "$scratch/altered/permissions.p7s"
  copy_of subscriber expired
  permissions_of subscriber | sed -E 's|<not_before>[^<]*|<not_before>2020-01-01T00:00:00|; s|<not_after>[^<]*|<not_after>2020-02-01T00:00:00|' \
    >"$scratch/expired.xml"
  sign "$scratch/expired.xml" "$scratch/expired/permissions.p7s"
  copy_of subscriber borrowed
  cp "$ours/operator/permissions.p7s" "$scratch/borrowed"
  copy_of subscriber keyless
  rm "$scratch/keyless/key.pem"

  look_around "$ours/subscriber" "$scratch/unknown" "$rogue/operator" "$scratch/forged" "$scratch"/{altered,expired,borrowed,keyless}
  saw_services "$ours/subscriber" || fail "a subscriber of ours sees no service" "$ours/subscriber.saw" "$ours/subscriber.errors"
  for stranger in "$scratch/unknown" "$rogue/operator" "$scratch"/{forged,altered,expired,borrowed,keyless}; do
    ! saw_services "$stranger" || fail "$stranger sees the services" "$stranger.saw"
  done
  # Refused by themselves already, with the reason; the first three join, and nobody answers them.
  for stranger in 'altered|digest failure' 'expired|expired' 'borrowed|Subject name is invalid' 'keyless|key.pem'; do
    grep -q "${stranger#*|}" "$scratch/${stranger%|*}.errors" ||
      fail "${stranger%|*}: the reason is not given" "$scratch/${stranger%|*}.errors"
  done
  for stranger in "$scratch/unknown" "$rogue/operator" "$scratch/forged"; do
    grep -q '"no heartbeat"' "$stranger.saw" || fail "$stranger did not even look" "$stranger.saw" "$stranger.errors"
  done
}

# Among ourselves nobody is refused or unknown.
check_no_alarm() {
  as "$ours/subscriber" status --json --seconds 3 >"$scratch/alarms" 2>"$scratch/alarm_errors" || true
  saw_state=$(grep -c '"state": *"running"' "$scratch/alarms" || true)
  [ "$saw_state" -eq 6 ] || fail "not all services are heard" "$scratch/alarms" "$scratch/alarm_errors"
  ! grep -qE '"kind": *"(refused_right|unknown_writer)"' "$scratch/alarms" || fail "one of ours is refused" "$scratch/alarms" "$scratch/up"
}

# Who was refused is an alarm, in every service that refused it.
check_alarm() {
  as "$ours/subscriber" status --json --seconds 3 >"$scratch/alarms" 2>"$scratch/alarm_errors" || true
  grep -q '"kind": *"refused_right"' "$scratch/alarms" || fail "strangers are no alarm" "$scratch/alarms" "$scratch/up"
  ! grep -q '"kind": *"unknown_writer"' "$scratch/alarms" || fail "one of ours is taken for a stranger" "$scratch/alarms"
}

# What one may not write is refused with its reason, and what one may is received.
check_acts() {
  local identity act number
  local -a acts=("subscriber acknowledge XT03-MV2 $advisory" "maintenance acknowledge XT03-MV2 $advisory"
    'operator replaced XT03-MV2 --at 2001-01-01' 'operator retract XT03-MV2 --since 2030-01-01 --reason test'
    'maintenance retract XT03-MV2 --since 2030-01-01 --reason test' 'reviewer replaced XT03-MV2 --at 2001-01-01') tries=()
  for number in "${!acts[@]}"; do
    read -r identity act <<<"${acts[$number]}"
    # shellcheck disable=SC2086  # a line of words
    as "$ours/$identity" $act --by tester >"$scratch/act.$number" 2>&1 &
    tries+=($!)
  done
  for number in "${!acts[@]}"; do
    ! wait "${tries[$number]}" || fail "one may: ${acts[$number]}" "$scratch/act.$number"
    grep -q 'writer of topic .*: DDS says: Not Allowed By Security' "$scratch/act.$number" ||
      fail "${acts[$number]}: no reason" "$scratch/act.$number"
  done
  as "$ours/operator" acknowledge XT03-MV2 "$advisory" --by tester >"$scratch/act" 2>&1 || fail "an operator cannot acknowledge" "$scratch/act"
  as "$ours/maintenance" replaced XT03-MV2 --at 2001-01-01 --by tester >"$scratch/act" 2>&1 ||
    fail "maintenance cannot report a replacement" "$scratch/act"
  as "$ours/reviewer" retract XT03-MV2 --since 2030-01-01 --reason test --by tester >"$scratch/act" 2>&1 ||
    fail "a reviewer cannot retract tests" "$scratch/act"
}

# Identities of ours in programs that do not check their own rights. What they write nobody takes, what they may not read nobody
# gives them; what they may goes on as ever.
start_lenient() {
  local name
  SEALWATCH_ACCESS_CONTROL=$(sed -n 's|.*<Library path="\([^"]*/libdds_security_ac.so\)".*|\1|p' "$ours/operator/cyclonedds.xml")
  export SEALWATCH_ACCESS_CONTROL
  for name in subscriber operator sender; do
    copy_of $name lenient_$name
    sed -i "s|$SEALWATCH_ACCESS_CONTROL|$lenient_rights|" "$scratch/lenient_$name/cyclonedds.xml"
  done
  lenient=()
  as "$scratch/lenient_subscriber" acknowledge XT03-MV2 "$advisory" --by stranger >"$scratch/lenient_subscriber.said" 2>&1 &
  lenient+=($!)
  as "$scratch/lenient_sender" watch advisory --json --seconds 6 >"$scratch/lenient_sender.saw" 2>"$scratch/lenient_sender.said" &
  lenient+=($!)
  as "$scratch/lenient_operator" watch advisory --json --seconds 6 >"$scratch/lenient_operator.saw" 2>"$scratch/lenient_operator.said" &
  lenient+=($!)
}
check_lenient() {
  local process
  for process in "${lenient[@]}"; do wait "$process" || true; done
  lenient=()
  grep -q 'acknowledgement: was not received' "$scratch/lenient_subscriber.said" ||
    fail "a subscriber that does not check itself is not refused" "$scratch/lenient_subscriber.said"
  ! grep -q '"topic"' "$scratch/lenient_sender.saw" || fail "a sender that does not check itself reads advice" "$scratch/lenient_sender.saw"
  [ ! -s "$scratch/lenient_sender.said" ] || ! grep -q 'Not Allowed' "$scratch/lenient_sender.said" ||
    fail "lenient_rights is not lenient" "$scratch/lenient_sender.said"
  grep -q '"topic":"advisory"' "$scratch/lenient_operator.saw" ||
    fail "lenient_rights does not work" "$scratch/lenient_operator.said"
  as "$scratch/lenient_operator" acknowledge XT03-MV2 "$advisory" --by tester >"$scratch/act" 2>&1 ||
    fail "an operator cannot acknowledge with lenient_rights" "$scratch/act"
  unset SEALWATCH_ACCESS_CONTROL
}

# Who is heard while its permission lasts is cut off when it ends. It listens beside what is checked meanwhile.
start_expiry() {
  expires=$(($(date +%s) + 8))
  copy_of subscriber soon
  permissions_of subscriber | sed "s|<not_after>[^<]*|<not_after>$(date -u -d "@$expires" +%FT%T)|" >"$scratch/soon.xml"
  sign "$scratch/soon.xml" "$scratch/soon/permissions.p7s"
  as "$scratch/soon" watch service_status --seconds 14 2>"$scratch/soon.errors" |
    while IFS= read -r line; do echo "$(date +%s) $line"; done >"$scratch/soon.saw" &
  watcher=$!
}
check_expiry() {
  wait "$watcher" || true
  watcher=
  local first last
  first=$(head -1 "$scratch/soon.saw" | cut -d' ' -f1)
  last=$(tail -1 "$scratch/soon.saw" | cut -d' ' -f1)
  [ -n "$first" ] || fail "nothing is heard with a permission that still holds" "$scratch/soon.errors"
  [ $((last - expires)) -le 1 ] || fail "heard $((last - expires)) s after the permission's end" "$scratch/soon.saw"
}

# After a restart with the new list of revoked certificates nobody answers a revoked one; a renewed one is heard.
check_revocation() {
  copy_of engineer revoked
  "$maker" "$ours" renew engineer >"$scratch/said" 2>&1 || fail "renew failed" "$scratch/said"  # the older one is revoked, too
  "$maker" "$ours" revoke engineer >"$scratch/said" 2>&1 || fail "revoke failed" "$scratch/said"
  "$maker" "$ours" renew operator data-manipulation --days 30 >"$scratch/said" 2>&1 || fail "renew failed" "$scratch/said"
  stop_services
  start_services
  look_around "$ours/operator" "$scratch/revoked"
  saw_services "$ours/operator" || fail "a renewed identity sees no service" "$ours/operator.saw" "$ours/operator.errors"
  ! saw_services "$scratch/revoked" || fail "a revoked identity sees the services" "$scratch/revoked.saw"
  grep -q '"no heartbeat"' "$scratch/revoked.saw" || fail "the revoked one did not even look" "$scratch/revoked.errors"
}

# A service that lost its journal has the acts back from its neighbours, and needs nobody's right to write them.
check_lost_journal() {
  stop_services
  rm "$scratch/state/state_detection.db"*
  start_services
  local attempt
  for ((attempt = 0; attempt < 200; ++attempt)); do
    "$bin/sealwatch" audit --config "$config" --state "$scratch/state" >"$scratch/audit" 2>&1 || true
    ! grep -q 'state_detection.* actuator_replaced .*fetched back from' "$scratch/audit" || break
    sleep 0.1
  done
  grep -q 'state_detection.* tests_retracted .*fetched back from' "$scratch/audit" || fail "a retraction is not fetched back" "$scratch/audit"
  grep -q 'state_detection.* actuator_replaced .*fetched back from' "$scratch/audit" || fail "a replacement is not fetched back" "$scratch/audit"
}

"$maker" "$ours" --tag "$tag" >"$scratch/said" 2>&1 || fail "make_identities.sh failed" "$scratch/said"
"$maker" "$rogue" --tag "$tag" >"$scratch/said" 2>&1 || fail "make_identities.sh failed" "$scratch/said"
check_usage
check_rights
start_services
check_test
check_no_alarm
start_expiry
start_lenient
check_strangers
check_lenient
check_alarm
check_acts
check_expiry
check_lost_journal
check_revocation
stop_services
echo "secured: one test went through, and strangers of every kind saw and wrote nothing"
