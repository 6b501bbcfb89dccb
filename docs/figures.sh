#!/usr/bin/env bash
# Draws the pictures of the documentation with the program itself, from tests that its virtual bench records (fixed seeds).
#   docs/figures.sh [BUILD]            writes docs/figures/*.svg (BUILD: build/release)
#   docs/figures.sh --check [BUILD]    says which of them are not what the program draws now (exit status 1)
# Takes about half a minute on two cores. Numbers may differ by a pixel and a half, or in the third digit of a text.
set -euo pipefail
cd "$(dirname "$0")/.."
check=
[ "${1:-}" != --check ] || { check=yes; shift; }
build=${1:-build/release}
sealwatch=$build/bin/sealwatch
draw=$build/tests/figures/sealwatch-figures
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
asset=config/assets/xt03-mv2.yaml
quietly() { "$@" >"$scratch/output" 2>&1 || { cat "$scratch/output" >&2; exit 3; }; }
with_physics() { cp "$asset" "$scratch/$1.yaml"; echo "physics: [$2]" >>"$scratch/$1.yaml"; }

# One partial stroke test of a seal at 80 %, and the same test of an actuator with dry friction.
with_physics friction '{id: coulomb_friction, element: piston, parameters: {F_c: 4000.0, v_s: 1.0e-4}}'
for name in plain friction; do
  file=$scratch/$name.yaml
  [ $name = friction ] || file=$asset
  quietly "$sealwatch" simulate --asset "$file" --months 1 --condition 0.8 --rate 100 --seed 3 --out "$scratch/$name"
done

# The tutorial's leak.
with_physics leaking '{id: external_leakage, element: chamber_a, parameters: {G: 4.0e-14}}'
quietly "$sealwatch" simulate --asset "$scratch/leaking.yaml" --months 6 --rate 100 --seed 5 --out "$scratch/leaking"
quietly "$sealwatch" explain --asset "$asset" --fit "$scratch"/leaking/2009-0[4-7]*.csv \
  --holdout "$scratch"/leaking/2009-0[89]*.csv --time-limit 3600 --out "$scratch/report"

# The demo's life.
quietly "$sealwatch" simulate --asset "$asset" --ageing --months 108 --missing 0.02 --cut 0.01 --rate 50 --seed 11 --out "$scratch/life"
quietly "$sealwatch" replay --config config --offline --quiet --page "$scratch/forecast.html" "$scratch"/life/*.csv

out=docs/figures
[ -z "$check" ] || out=$scratch/drawn
mkdir -p "$out"
quietly "$draw" "$scratch"/plain/*.csv "$scratch"/friction/*.csv "$scratch/report/report.html" "$scratch/forecast.html" "$out"
[ -n "$check" ] || exit 0

# Two drawings are the same where their texts are and their numbers nearly are.
same() {
  awk '
    function near(a, b) { d = a - b; if (d < 0) d = -d; m = a < 0 ? -a : a; return d <= 1.5 || d <= 0.005 * m }
    function pieces(line, list) { gsub(/-?[0-9]+(\.[0-9]+)?(e[-+]?[0-9]+)?/, "\n&\n", line); return split(line, list, "\n") }
    FNR == NR { kept[FNR] = $0; lines = FNR; next }
    { n = pieces($0, now); m = pieces(kept[FNR], then)
      if (n != m) { print FNR ": " kept[FNR] " | " $0; exit 1 }
      for (k = 1; k <= n; ++k) {
        number = now[k] ~ /^-?[0-9]/ && then[k] ~ /^-?[0-9]/
        if (number ? !near(now[k], then[k]) : now[k] != then[k]) { print FNR ": " then[k] " | " now[k]; exit 1 }
      } }
    END { if (FNR != lines) { print "other length"; exit 1 } }' "$1" "$2"
}
faults=0
for file in docs/figures/*.svg; do
  ! grep -q '<foreignObject' "$file" || { echo "$file has HTML in it, which few viewers of SVG draw"; faults=1; }
done
for file in "$out"/*.svg; do
  name=docs/figures/$(basename "$file")
  difference=$(same "$name" "$file" 2>&1) || { echo "$name is not what the program draws (line $difference)"; faults=1; }
done
[ $faults = 0 ] || { echo "run docs/figures.sh, look at the pictures, and commit them"; exit 1; }
echo "the pictures are current"
