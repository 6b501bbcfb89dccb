#!/usr/bin/env bash
# Makes and keeps what DDS Security needs: two certificate authorities, an identity and signed permissions for every service,
# role and subscriber. See --help and docs/security.md.
set -euo pipefail
umask 022
here=$(cd "$(dirname "$(readlink -f "$0")")" && pwd)
me=$(basename "$0")

usage() {
  cat <<EOT
usage: $me DIRECTORY [make] [OPTIONS]             what is missing: authorities, six services, roles
       $me DIRECTORY add NAME --may RIGHTS        one more identity
       $me DIRECTORY renew [NAME...] [--days N]   new key, certificate and permissions; all where none is named
       $me DIRECTORY revoke NAME                  its certificates no longer count
       $me DIRECTORY list                         names, expiry, rights

Every identity gets a folder DIRECTORY/NAME; DIRECTORY/ca holds the authorities' keys and belongs on no machine of the plant.

options:
  --days N           how long identities and permissions hold (397, at most until the authorities expire)
  --may RIGHTS       with commas: read, raw_samples, resend_request, acknowledgement, maintenance_event, retraction,
                     model_acceptance
when the authorities are made, kept from then on:
  --authority-days N how long the authorities hold (7300)
  --domain N         DDS domain (0)
  --interface NAME   network interface of the services (lo: this machine only)
  --tag TEXT         discovery tag (none)
  --at PLACE         where DIRECTORY lies on the machine that uses it (DIRECTORY)

examples:
  $me /etc/sealwatch/security
  $me /etc/sealwatch/security add bridge-display --may read
  $me /etc/sealwatch/security add j-silva --may read,acknowledgement,maintenance_event
  CYCLONEDDS_URI=file:///etc/sealwatch/security/j-silva/cyclonedds.xml sealwatch status
exit status: 0 done, 2 bad usage or input
EOT
}

fail() { echo "$me: $1" >&2; exit 2; }

# ---- who may what --------------------------------------------------------------------------------------------------------------

layers=(data-acquisition data-manipulation state-detection health-assessment prognostic-assessment advisory-generation)
roles=(sender replay operator maintenance reviewer engineer subscriber)
conclusions='test_features state_report health_report leakage_estimate remaining_life pst_request advisory acknowledgement
  maintenance_event retraction model_discrepancy model_acceptance act_record'
rights=(read raw_samples resend_request acknowledgement maintenance_event retraction model_acceptance)

# Sets `writes` and `reads`: the topics of a layer (docs/topics.md), or of somebody with these rights.
topics_of() {  # NAME RIGHTS
  local right
  writes='' reads='service_status resend_request'
  case $1 in
    data-acquisition) writes='sample_block act_record' reads+=' raw_samples maintenance_event retraction act_record' ;;
    data-manipulation) writes='test_window test_features' reads+=' sample_block' ;;
    state-detection)
      writes='state_report act_record'
      reads+=' test_window test_features maintenance_event retraction model_acceptance model_discrepancy act_record' ;;
    health-assessment) writes='health_report model_discrepancy' reads+=' test_window test_features state_report' ;;
    prognostic-assessment)
      writes='leakage_estimate remaining_life pst_request act_record'
      reads+=' test_window health_report maintenance_event retraction model_acceptance model_discrepancy act_record' ;;
    advisory-generation)
      writes='advisory act_record'
      reads+=' state_report health_report leakage_estimate remaining_life acknowledgement maintenance_event retraction act_record' ;;
    *)
      for right in ${2//,/ }; do
        case $right in
          read) reads+=" $conclusions" ;;
          raw_samples) writes+=" raw_samples" reads+=' pst_request maintenance_event retraction' ;;
          *) writes+=" $right" ;;
        esac
      done
      return ;;
  esac
  writes+=' service_status resend_request'
}

rights_of_role() {
  case $1 in
    sender) echo raw_samples ;;
    replay) echo read,raw_samples,resend_request ;;
    operator) echo read,acknowledgement ;;
    maintenance) echo read,maintenance_event ;;
    reviewer) echo read,retraction ;;
    engineer) echo read,model_acceptance ;;
    subscriber) echo read ;;
  esac
}

is_layer() { [[ " ${layers[*]} " == *" $1 "* ]]; }

# ---- the command line ----------------------------------------------------------------------------------------------------------

command='make'
directory=
names=()
days=397
may=
declare -A chosen=()

number() {  # OPTION VALUE LEAST MOST
  if ! [[ $2 =~ ^[0-9]{1,5}$ ]] || [ "$2" -lt "$3" ] || [ "$2" -gt "$4" ]; then
    fail "$1: '$2' must be a whole number from $3 to $4"
  fi
}

read_arguments() {
  local words=()
  while [ $# -gt 0 ]; do
    case $1 in
      -h | --help) usage; exit 0 ;;
      --days | --may | --authority-days | --domain | --interface | --tag | --at)
        [ $# -ge 2 ] || fail "$1 needs a value; see $me --help"
        chosen[${1#--}]=$2
        shift ;;
      -*) fail "'$1' is not a known option; see $me --help" ;;
      *) words+=("$1") ;;
    esac
    shift
  done
  [ ${#words[@]} -gt 0 ] || { usage >&2; exit 2; }
  directory=${words[0]}
  command=${words[1]:-make}
  names=("${words[@]:2}")
  days=${chosen[days]:-$days}
  may=${chosen[may]:-}
  number --days "$days" 1 36500
  case $command in
    make | list) [ ${#names[@]} -eq 0 ] || fail "$command takes no name, and there is '${names[0]}'" ;;
    add | revoke) [ ${#names[@]} -eq 1 ] || fail "$command takes one name" ;;
    renew) ;;
    *) fail "'$command' must be make, add, renew, revoke or list; see $me --help" ;;
  esac
  local name
  for name in "${names[@]}"; do
    if ! [[ $name =~ ^[a-z][a-z0-9-]{0,47}$ ]] || [ "$name" = ca ]; then
      fail "'$name' must be a name of small letters, digits and hyphens, at most 48, other than ca"
    fi
  done
}

# What was chosen when the authorities were made stands in every identity: another choice would be passed over in silence.
refuse_late_choices() {
  local option
  for option in authority-days domain interface tag at; do
    [ -z "${chosen[$option]+given}" ] || fail "--$option counts only when the authorities are made, and $ca is there: take a new directory"
  done
}

check_rights() {
  local right
  [ -n "$may" ] || fail "add needs --may RIGHTS, for example --may read"
  for right in ${may//,/ }; do
    [[ " ${rights[*]} " == *" $right "* ]] || fail "--may: '$right' is not a right; there are: ${rights[*]}"
  done
}

# ---- authorities ---------------------------------------------------------------------------------------------------------------

find_plugins() {
  local file
  for file in /usr/lib/*/libddsc0debian/libdds_security_auth.so; do
    [ -e "$file" ] && { dirname "$file"; return; }
  done
  fail "/usr/lib/*/libddsc0debian/libdds_security_auth.so is not there: apt install libddsc0debian"
}

setting() { sed -n "s/^$1=//p" "$directory/ca/settings"; }

# openssl, silent unless it fails.
quietly() {
  local said
  said=$(openssl "$@" 2>&1 >/dev/null) || fail "openssl $1 failed: $said"
}

make_authority() {  # NAME TITLE DAYS
  quietly ecparam -name prime256v1 -genkey -noout -out "$ca/$1_ca.key"
  quietly req -x509 -new -sha256 -key "$ca/$1_ca.key" -out "$ca/$1_ca.pem" -days "$3" -subj "/O=sealwatch/CN=$2" \
    -addext keyUsage=critical,digitalSignature,keyCertSign,cRLSign
}

make_authorities() {
  local lasting=${chosen[authority-days]:-7300} domain=${chosen[domain]:-0} tag=${chosen[tag]:-} place
  number --authority-days "$lasting" 1 36500
  number --domain "$domain" 0 232
  place=${chosen[at]:-$(realpath -m "$directory")}
  local text
  for text in "$tag" "$place" "${chosen[interface]:-lo}"; do
    [[ $text =~ ^[A-Za-z0-9/._:-]*$ ]] || fail "'$text' may have letters, digits and / . _ : - alone"
  done
  [[ $place == /* ]] || fail "--at: '$place' must begin with /"
  mkdir -p "$directory" || fail "$directory cannot be made: choose a place where you may write"
  ca=$directory/.ca.new
  rm -rf "$ca"
  (umask 077 && mkdir "$ca" "$ca/issued") || fail "$directory cannot be written to"
  printf 'domain=%s\ninterface=%s\ntag=%s\nplace=%s\nplugins=%s\n' "$domain" "${chosen[interface]:-lo}" "$tag" "$place" \
    "$(find_plugins)" >"$ca/settings"
  cat >"$ca/openssl.cnf" <<EOT
[ca]
default_ca = authority
[authority]
database = \$ENV::SEALWATCH_CA/index.txt
new_certs_dir = \$ENV::SEALWATCH_CA/issued
serial = \$ENV::SEALWATCH_CA/serial
crlnumber = \$ENV::SEALWATCH_CA/crlnumber
certificate = \$ENV::SEALWATCH_CA/identity_ca.pem
private_key = \$ENV::SEALWATCH_CA/identity_ca.key
default_md = sha256
unique_subject = no
policy = names
x509_extensions = identity
[names]
organizationName = supplied
commonName = supplied
[identity]
basicConstraints = critical,CA:FALSE
keyUsage = critical,digitalSignature
EOT
  : >"$ca/index.txt"
  echo 1000 >"$ca/crlnumber"
  (
    umask 077
    make_authority identity "sealwatch identities" "$lasting"
    make_authority permissions "sealwatch permissions" "$lasting"
  )
  sign "$here/governance.xml.in" "$ca/governance.p7s" "s/@DOMAIN@/$domain/"
  mv "$ca" "$directory/ca"
  ca=$directory/ca
  list_revoked
}

sign() {  # TEMPLATE RESULT SED_SCRIPT
  sed "$3" "$1" >"$2.xml"
  quietly smime -sign -text -in "$2.xml" -signer "$ca/permissions_ca.pem" -inkey "$ca/permissions_ca.key" -out "$2"
  rm "$2.xml"
}

authority_end() { date -u -d "$(openssl x509 -in "$ca/identity_ca.pem" -noout -enddate | cut -d= -f2)" +%s; }

# The list of revoked certificates: as long as the authority holds, since an expired list would stop everybody.
list_revoked() {
  local left=$((($(authority_end) - $(date +%s)) / 86400 + 1)) folder
  SEALWATCH_CA=$ca quietly ca -config "$ca/openssl.cnf" -gencrl -crldays "$left" -out "$ca/revoked.pem"
  for folder in "$directory"/*/certificate.pem; do
    [ ! -e "$folder" ] || install -m 644 "$ca/revoked.pem" "$(dirname "$folder")/revoked.pem"
  done
}

# ---- identities ----------------------------------------------------------------------------------------------------------------

topic_list() { local topic; for topic in "$@"; do printf '<topic>sealwatch/%s</topic>' "$topic"; done; }

write_permissions() {  # NAME RIGHTS FOLDER
  local subject start end
  subject=$(openssl x509 -in "$3/certificate.pem" -noout -subject -nameopt RFC2253 | sed 's/^subject=//')
  start=$(date -u -d "$(openssl x509 -in "$3/certificate.pem" -noout -startdate | cut -d= -f2)" +%FT%T)
  end=$(date -u -d "$(openssl x509 -in "$3/certificate.pem" -noout -enddate | cut -d= -f2)" +%FT%T)
  topics_of "$1" "$2"
  {
    printf '<?xml version="1.0" encoding="UTF-8"?>\n'
    printf '<dds xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance" xsi:noNamespaceSchemaLocation="%s">\n' \
      http://www.omg.org/spec/DDS-Security/20170801/omg_shared_ca_permissions.xsd
    printf '<permissions><grant name="%s"><subject_name>%s</subject_name>\n' "$1" "$subject"
    printf '<validity><not_before>%s</not_before><not_after>%s</not_after></validity>\n' "$start" "$end"
    printf '<allow_rule><domains><id>%s</id></domains>\n' "$(setting domain)"
    # shellcheck disable=SC2086  # lists of words
    [ -z "$writes" ] || printf '<publish><topics>%s</topics></publish>\n' "$(topic_list $writes)"
    # shellcheck disable=SC2086
    printf '<subscribe><topics>%s</topics></subscribe>\n' "$(topic_list $reads)"
    printf '</allow_rule><default>DENY</default></grant></permissions></dds>\n'
  } >"$3/permissions.xml"
  sign "$3/permissions.xml" "$3/permissions.p7s" ''
  rm "$3/permissions.xml"
}

make_identity() {  # NAME RIGHTS
  local name=$1 folder=$directory/.$1.new left=$((($(authority_end) - $(date +%s)) / 86400))
  [ "$days" -le "$left" ] || fail "--days: $days is longer than the authorities hold, $left days"
  rm -rf "$folder"
  mkdir "$folder" || fail "$directory cannot be written to"
  (umask 077 && quietly ecparam -name prime256v1 -genkey -noout -out "$folder/key.pem")
  quietly req -new -sha256 -key "$folder/key.pem" -subj "/O=sealwatch/CN=$name" -out "$folder/request.pem"
  SEALWATCH_CA=$ca quietly ca -batch -config "$ca/openssl.cnf" -rand_serial -notext -days "$days" -in "$folder/request.pem" \
    -out "$folder/certificate.pem"
  rm "$folder/request.pem"
  write_permissions "$name" "$2" "$folder"
  install -m 644 "$ca/identity_ca.pem" "$ca/permissions_ca.pem" "$ca/governance.p7s" "$ca/revoked.pem" "$folder"
  sed -e "s|@NAME@|$name|g; s|@PLACE@|$(setting place)|g; s|@PLUGINS@|$(setting plugins)|g" \
    -e "s|@INTERFACE@|$(setting interface)|; s|@TAG@|$(setting tag)|" "$here/cyclonedds.xml.in" >"$folder/cyclonedds.xml"
  echo "$2" >"$folder/rights"
  chmod 644 "$folder"/*.pem "$folder"/*.p7s && chmod 600 "$folder/key.pem"
  give_key "$name" "$folder"
  rm -rf "$directory/.$name.old"
  [ ! -e "$directory/$name" ] || mv "$directory/$name" "$directory/.$name.old"
  mv "$folder" "$directory/$name"
  rm -rf "$directory/.$name.old"
  echo "$name: until $(date -u -d "+$days days" +%F), may write:${writes:- nothing}"
}

# The key belongs to who used it before, or to the service's user where systemd's units are installed.
give_key() {
  [ "$(id -u)" -eq 0 ] || return 0
  if [ -e "$directory/$1/key.pem" ]; then
    chown --reference="$directory/$1/key.pem" "$2/key.pem"
  elif is_layer "$1" && id "sealwatch-$1" >/dev/null 2>&1; then
    chown "sealwatch-$1" "$2/key.pem"
  fi
}

# Every certificate that was issued under this name and still holds, those of before a renewal too.
revoke_all() {  # NAME
  local serial
  while read -r serial; do
    SEALWATCH_CA=$ca quietly ca -config "$ca/openssl.cnf" -revoke "$ca/issued/$serial.pem"
  done < <(awk -F'\t' -v subject="/O=sealwatch/CN=$1" '$1 == "V" && $6 == subject { print $4 }' "$ca/index.txt")
}

known() { [ -e "$directory/$1/certificate.pem" ]; }
must_be_known() { known "$1" || fail "$directory/$1 is no identity; $me $directory list shows those that are"; }

all_names() {
  local file
  for file in "$directory"/*/certificate.pem; do
    [ ! -e "$file" ] || basename "$(dirname "$file")"
  done
}

show_list() {
  local name end
  for name in $(all_names); do
    end=$(openssl x509 -in "$directory/$name/certificate.pem" -noout -enddate | cut -d= -f2)
    printf '%-24s until %s  %s\n' "$name" "$(date -u -d "$end" +%F)" "$(cat "$directory/$name/rights")"
  done
}

command -v openssl >/dev/null || fail "there is no openssl: apt install openssl"
read_arguments "$@"
ca=$directory/ca
if [ -e "$ca" ]; then
  refuse_late_choices
elif [ "$command" = make ] && [ -z "$(all_names)" ]; then
  make_authorities
elif [ "$command" != list ]; then
  fail "$ca is not there: bring the authorities' folder back, or begin with $me and a new directory"
fi
case $command in
  make)
    for name in "${layers[@]}"; do known "$name" || make_identity "$name" layer; done
    for name in "${roles[@]}"; do known "$name" || make_identity "$name" "$(rights_of_role "$name")"; done ;;
  add)
    check_rights
    if known "${names[0]}" || is_layer "${names[0]}"; then
      fail "$directory/${names[0]} is taken: renew it, or choose another name"
    fi
    make_identity "${names[0]}" "$may" ;;
  renew)
    [ ${#names[@]} -gt 0 ] || mapfile -t names < <(all_names)
    for name in "${names[@]}"; do must_be_known "$name"; done
    for name in "${names[@]}"; do make_identity "$name" "$(cat "$directory/$name/rights")"; done ;;
  revoke)
    must_be_known "${names[0]}"
    revoke_all "${names[0]}"
    list_revoked
    rm -rf "${directory:?}/${names[0]}"
    echo "${names[0]} is revoked: bring revoked.pem to every identity's folder and restart the services" ;;
  list) show_list ;;
esac
