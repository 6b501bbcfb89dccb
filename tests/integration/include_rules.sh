#!/usr/bin/env bash
# Who may include whom (the rules below). Prints each include that breaks a rule and fails; checks itself on a bad file first.
#   include_rules.sh SOURCE_DIR
set -euo pipefail
cd "$1"

# forbid WHERE(regex of files) WHAT(regex of the included path) WHY
forbid() {
  local where=$1 what=$2 why=$3
  awk -v where="$where" -v what="$what" -v why="$why" '
    FILENAME ~ where && match($0, /^[ \t]*#[ \t]*include[ \t]*[<"][^>"]+/) {
      included = substr($0, RSTART, RLENGTH); sub(/^.*[<"]/, "", included)
      if (included ~ what) { printf "%s:%d: includes %s: %s\n", FILENAME, FNR, included, why; bad = 1 }
    }
    END { exit bad }' "${files[@]}"
}

owner() {  # owner WHAT FOLDERS...: only these folders may include it
  local what=$1; shift
  local allowed; allowed=$(IFS='|'; echo "$*")
  local others=()
  for file in "${files[@]}"; do [[ $file =~ ^($allowed) ]] || others+=("$file"); done
  local all=("${files[@]}"); files=("${others[@]}")
  local status=0
  forbid . "$what" "only $allowed may" || status=1
  files=("${all[@]}")
  return $status
}

# headers FOLDER(regex) OTHERS(regex): of ours, include/sealwatch/FOLDER may include itself and the others only.
headers() {
  local allowed="$1${2:+|$2}"
  [ "$1" != message ] || allowed+='|estimation/fit_report|forecast/forecast'
  awk -v where="^include/sealwatch/$1/" -v allowed="^sealwatch/($allowed)[/.]" '
    FILENAME ~ where && match($0, /^[ \t]*#[ \t]*include[ \t]*[<"]sealwatch\/[^>"]+/) {
      included = substr($0, RSTART, RLENGTH); sub(/^.*[<"]/, "", included)
      if (included !~ allowed) { printf "%s:%d: includes %s, which its folder may not\n", FILENAME, FNR, included; bad = 1 }
    }
    END { exit bad }' "${files[@]}" || failed=1
}

rules() {
  local failed=0
  forbid '^include/' '^services/' 'headers in include/ know nothing of services/' || failed=1
  forbid '^include/' '^(dds|yaml-cpp|soci|ceres|spdlog|fmt|nlohmann|CLI|matio|boost|sqlite3|zip|pugixml)' 'mathematics and plain types stand alone' || failed=1
  # From top to bottom, each may include itself and what stands beside it here.
  headers core ''
  headers config core
  headers message core
  headers '(model|ode|signal)' 'core|config|model|ode|signal'
  headers trace core
  headers forecast 'core|config|message'
  headers estimation 'core|config|message|model|ode|signal|forecast|port'
  headers mismatch 'core|config|message|model|ode|signal|forecast|estimation'
  headers port 'core|config|message|model|ode|signal|forecast|estimation|mismatch'
  local layers='data_acquisition|data_manipulation|state_detection|health_assessment|prognostic_assessment|advisory_generation'
  for layer in ${layers//|/ }; do
    local others; others=$(echo "$layers" | tr '|' '\n' | grep -v "^$layer\$" | paste -sd'|')
    forbid "^services/$layer/" "^services/($others)/" 'a layer never includes another layer' || failed=1
    forbid "^services/$layer/([^m]|m[^a])[^/]*$" '^services/common/(transport|runtime|store|estimation)/' 'a layer reaches transport, runtime, journal and estimation through ports that main injects' || failed=1
  done
  forbid '^services/common/' '^services/([^c]|c[^o]|co[^m])' 'nothing under services/common knows a service' || failed=1
  forbid '^services/([^v]|v[^e])' '^services/verification/([^c]|command/[^ao])' 'the product knows nothing of the laboratory but its arguments' || failed=1
  owner '^ceres/' services/common/estimation/ || failed=1
  owner '^dds/' services/common/transport/ || failed=1
  owner '^yaml-cpp/' services/common/runtime/ services/common/recording/ || failed=1
  owner '^(zip\.h|pugixml\.hpp|dlfcn\.h)' services/common/fmi/ || failed=1
  owner '^spdlog/' services/common/runtime/ || failed=1
  owner '^fmt/' services/common/text/ || failed=1
  owner '^soci/' services/common/store/ || failed=1
  owner '^openssl/' services/common/store/ || failed=1
  owner '^matio' services/common/recording/ || failed=1
  owner '^udunits' services/common/units/ || failed=1
  # Each has a command line of its own; the bench's has nothing in common with that of the layers.
  owner '^CLI/' services/cli/ services/common/runtime/ services/virtual_bench/run_bench services/verification/ || failed=1
  owner '^nlohmann/' services/common/message/ services/common/report/ services/cli/ services/verification/ || failed=1
  return $failed
}

mapfile -t files < <(find include services -name '*.hpp' -o -name '*.cpp' | sort)
[ ${#files[@]} -gt 50 ] || { echo "only ${#files[@]} files found under $1: wrong folder?"; exit 1; }

# A rule that cannot fail is no rule: each of these forbidden includes must be seen.
trap 'rm -rf "$bad"' EXIT
bad=$(mktemp -d)
good_files=("${files[@]}")
must_see() {  # must_see FILE INCLUDE
  mkdir -p "$bad/${1%/*}"
  echo "#include $2" >"$bad/$1"
  (cd "$bad"; files=("$1"); ! rules >/dev/null) || { echo "the rules do not see that $1 includes $2"; exit 1; }
}
must_see include/sealwatch/core/bad.hpp '<ceres/ceres.h>'
must_see include/sealwatch/message/bad.hpp '"sealwatch/mismatch/explanation.hpp"'
must_see include/sealwatch/message/bad.hpp '"sealwatch/estimation/actuator_fit.hpp"'
must_see include/sealwatch/trace/bad.hpp '"sealwatch/model/physics.hpp"'
must_see include/sealwatch/config/bad.hpp '"sealwatch/message/common.hpp"'
must_see include/sealwatch/forecast/bad.hpp '"sealwatch/estimation/actuator_fit.hpp"'
must_see include/sealwatch/signal/bad.hpp '"sealwatch/forecast/forecast.hpp"'
must_see services/cli/bad_format.cpp '<fmt/format.h>'
must_see services/common/mismatch/bad.cpp '"services/cli/terminal.hpp"'
must_see services/common/estimation/bad.cpp '"services/virtual_bench/sensors.hpp"'
must_see services/cli/bad.cpp '"services/verification/trial/mismatch_trial.hpp"'
must_see services/state_detection/bad.cpp '"services/health_assessment/grade.hpp"'
files=("${good_files[@]}")

rules && echo "${#files[@]} files keep the include rules"
