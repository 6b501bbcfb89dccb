#!/usr/bin/env bash
# Who may include whom, and what has one owner (the rules below). Prints each line that breaks a rule and fails; checks
# itself on bad files first.
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

# only WHERE(regex of files) WHAT(regex of the included path) WHY: of ours they include what is named and nothing else.
only() {
  local where=$1 what=$2 why=$3
  awk -v where="$where" -v what="^($what)" -v why="$why" '
    FILENAME ~ where && match($0, /^[ \t]*#[ \t]*include[ \t]*[<"](sealwatch|services)\/[^>"]+/) {
      included = substr($0, RSTART, RLENGTH); sub(/^.*[<"]/, "", included)
      if (included !~ what) { printf "%s:%d: includes %s: %s\n", FILENAME, FNR, included, why; bad = 1 }
    }
    END { exit bad }' "${files[@]}"
}

# never_reaches WHERE WHAT WHY: nor do the headers that they include, or that those include.
never_reaches() {
  local where=$1 what=$2 why=$3
  awk -v where="$where" -v what="$what" -v why="$why" '
    match($0, /^[ \t]*#[ \t]*include[ \t]*[<"](sealwatch|services)\/[^>"]+/) {
      included = substr($0, RSTART, RLENGTH); sub(/^.*[<"]/, "", included); sub(/^sealwatch/, "include/sealwatch", included)
      includes[FILENAME] = includes[FILENAME] " " included
    }
    function follow(file, from,    list, count, k) {
      if (seen[from, file]++) return
      if (file ~ what) { printf "%s: reaches %s: %s\n", from, file, why; bad = 1 }
      count = split(includes[file], list, " ")
      for (k = 1; k <= count; ++k) follow(list[k], from)
    }
    END { for (file in includes) if (file ~ where) follow(file, file); exit bad }' "${files[@]}"
}

# written_only WHAT(regex of a line of code) WHY FOLDERS...: what has one owner stands in these files or folders alone.
written_only() {
  local what=$1 why=$2; shift 2
  local allowed; allowed=$(IFS='|'; echo "$*")
  awk -v what="$what" -v why="$why" -v allowed="^($allowed)" '
    FILENAME !~ allowed && $0 !~ /^[ \t]*\/\// && $0 ~ what { printf "%s:%d: %s\n", FILENAME, FNR, why; bad = 1 }
    END { exit bad }' "${files[@]}"
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
    forbid "^services/$layer/" "^services/($others|virtual_bench|client|cli|verification)/" \
      'a layer never includes another layer, the bench or what stands above the layers' || failed=1
    forbid "^services/$layer/([^m]|m[^a])[^/]*$" '^services/common/(transport|runtime|store|estimation)/' 'a layer reaches transport, runtime, journal and estimation through ports that main injects' || failed=1
  done
  forbid '^services/common/' '^services/([^c]|c[^o]|co[^m])' 'nothing under services/common knows a service' || failed=1
  forbid '^services/([^v]|v[^e])' '^services/verification/([^c]|command/[^ao])' 'the product knows nothing of the laboratory but its arguments' || failed=1
  # The bench and the truth check the estimator. Of its model they know names, parameters and laws (the truth not even
  # those), and no line of its integration, sensors or signal processing.
  local names='sealwatch/(config|core)/|sealwatch/forecast/degradation\.|sealwatch/model/plant_description\.|services/common/text/'
  only '^services/virtual_bench/' \
    "$names|sealwatch/(message|port)/|sealwatch/model/(eha|physics)\\.|services/common/model/physics_terms\\.|services/common/(core|runtime|transport)/|services/virtual_bench/" \
    'the bench shares equations and laws with the estimator, and nothing that solves or measures' || failed=1
  only '^services/verification/truth/' \
    "$names|services/verification/truth/|services/virtual_bench/(random|rosenbrock|profile|controller)\\." \
    'the truth has equations, sensors and forms of laws of its own' || failed=1
  never_reaches '^services/(virtual_bench|verification/truth)/' \
    '^include/sealwatch/(ode|signal|mismatch|trace)/|^include/sealwatch/estimation/([^f]|f[^i]|fi[^t])|^services/common/(estimation|mismatch|signal|trace|dense)/|^services/common/model/([^p]|p[^h])' \
    'integrator, steps and sensors are its own' || failed=1
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
  written_only '3\.0 \* [a-z_]+\[k [-+] [0-9]\] [-+] 3\.0|1\.4826.*sqrt\(20' \
    'noise is told from third differences by signal/noise_floor alone' services/common/signal/noise_floor || failed=1
  written_only 'v?snprintf|setprecision|std::format\(|std::put_money|[^a-z]f?printf\([^"]*".*%[-+0-9.*]*[aefgAEFG]' \
    'numbers become text in services/common/text' services/common/text/ services/common/fmi/fmi2_instance.cpp || failed=1
  return $failed
}

mapfile -t files < <(find include services -name '*.hpp' -o -name '*.cpp' | sort)
[ ${#files[@]} -gt 50 ] || { echo "only ${#files[@]} files found under $1: wrong folder?"; exit 1; }

# A rule that cannot fail is no rule: each of these forbidden includes must be seen.
trap 'rm -rf "$bad"' EXIT
bad=$(mktemp -d)
good_files=("${files[@]}")
must_see_line() {  # must_see_line FILE LINE [OTHER_FILE ITS_LINE]
  mkdir -p "$bad/${1%/*}" "$bad/${3:-.}"
  echo "$2" >"$bad/$1"
  local two=("$1")
  if [ $# -gt 2 ]; then rmdir "$bad/$3"; echo "$4" >"$bad/$3"; two+=("$3"); fi
  (cd "$bad"; files=("${two[@]}"); ! rules >/dev/null) || { echo "the rules do not see in $1: $2"; exit 1; }
}
must_see() { must_see_line "$1" "#include $2"; }  # must_see FILE INCLUDE
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
must_see services/state_detection/bad.cpp '"services/virtual_bench/sensors.hpp"'
must_see services/virtual_bench/bad.cpp '"sealwatch/ode/bdf.hpp"'
must_see services/virtual_bench/bad.cpp '"services/common/model/sensor_filter.hpp"'
must_see services/virtual_bench/bad.cpp '"services/common/estimation/channel_noise.hpp"'
must_see services/verification/truth/bad.cpp '"sealwatch/model/eha.hpp"'
must_see services/verification/truth/bad.cpp '"services/virtual_bench/sensors.hpp"'
must_see_line services/virtual_bench/bad.cpp '#include "services/common/text/worse.hpp"' \
  services/common/text/worse.hpp '#include "sealwatch/signal/filters.hpp"'
must_see_line services/cli/bad.cpp '  std::snprintf(text, sizeof text, "%.3g", value);'
must_see_line services/cli/bad.cpp '  std::printf("%s %.3g\n", name, value);'
must_see_line services/common/model/bad.cpp '  d = values[k] - 3.0 * values[k - 1] + 3.0 * values[k - 2] - values[k - 3];'
files=("${good_files[@]}")

rules && echo "${#files[@]} files keep the include rules"
