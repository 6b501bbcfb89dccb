#!/usr/bin/env bash
# No plant, parameter or channel name stands outside the plants' own folders: the rest of the code asks their tables.
# The words are those of the tables themselves; what still stands elsewhere is counted in plant_words.allowed, which can
# only shrink. The virtual bench and the laboratory (services/verification) are of one plant each by their nature.
#   plant_words.sh SOURCE_DIR            prints each word that is one too many, and fails
#   plant_words.sh SOURCE_DIR --list     prints the counts as plant_words.allowed has them
set -euo pipefail
cd "$1"
plants=services/common/model/plants
allowed=tests/integration/plant_words.allowed

words() {  # of the tables: plants, channels, parameters
  local folder
  for folder in "$plants"/*/; do basename "$folder"; done
  grep -hoE '\.name = "[A-Za-z0-9_]+"' "$plants"/*/description.cpp | cut -d'"' -f2
  tr '\n' ' ' <<<"$(cat "$plants"/*/description.cpp)" | grep -oE '(scale|bounded)_parameter\( *"[A-Za-z0-9_]+"' | cut -d'"' -f2
}

# hits FILES...: file:line:word of each string that is one of the words, or one behind "sensor:", "input:" and the like
hits() {
  local pattern
  pattern="\"([a-z_]+:)?($(words | sort -u | paste -sd'|'))\""
  { grep -nHE "$pattern" "$@" || true; } | awk -v pattern="$pattern" '
    { place = $0; match(place, /^[^:]+:[0-9]+:/); head = substr(place, 1, RLENGTH); code = substr(place, RLENGTH + 1)
      sub(/^[ \t]*\/\/.*/, "", code); sub(/[ \t]\/\/.*$/, "", code)
      while (match(code, pattern)) { print head substr(code, RSTART + 1, RLENGTH - 2); code = substr(code, RSTART + RLENGTH - 1) } }'
}

counts() { cut -d: -f1 | sort | uniq -c | awk '{ print $1, $2 }' | sort -k2; }

mapfile -t files < <(find include services -name '*.hpp' -o -name '*.cpp' |
  grep -vE "^($plants|services/virtual_bench|services/verification)/" | sort)
[ ${#files[@]} -gt 50 ] || { echo "only ${#files[@]} files found under $1: wrong folder?"; exit 1; }
[ "$(words | sort -u | wc -l)" -gt 50 ] || { echo "only $(words | sort -u | wc -l) words found in $plants"; exit 1; }

# A test that cannot fail is no test.
bad=$(mktemp --suffix=.cpp)
trap 'rm -f "$bad"' EXIT
printf 'const char* a = "%s"; f("sensor:%s");  // "%s" in a comment\n' $(words | sort -u | sed -n '1p;2p;3p') >"$bad"
[ "$(hits "$bad" /dev/null | wc -l)" = 2 ] || { echo "the words are not seen where they stand"; exit 1; }

found=$(hits "${files[@]}")
[ "${2:-}" = --list ] && { counts <<<"$found"; exit 0; }
if ! difference=$(diff <(counts <<<"$found") <(grep -v '^#' "$allowed" | sort -k2)); then
  echo "$difference" | sed -nE 's/^> ([0-9]+) (.*)/\2: \1 allowed/p; s/^< ([0-9]+) (.*)/\2: \1 found/p' | sort
  for file in $(sed -nE 's/^< [0-9]+ (.*)/\1/p' <<<"$difference"); do grep "^$file:" <<<"$found"; done
  echo "ask the plant's table, by role or by a field of PlantDescription; where a count has fallen, lower it in $allowed"
  exit 1
fi
echo "$(words | sort -u | wc -l) words of the plants' tables stand in no string elsewhere but $(wc -l <<<"$found") in $(counts <<<"$found" | wc -l) files"
