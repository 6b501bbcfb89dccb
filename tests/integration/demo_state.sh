#!/usr/bin/env bash
# deploy/demo.sh --data: recordings that cannot be played leave the state of an earlier demo as it was; good ones replace
# it. In a checkout of its own, where nothing is installed or built.
#   demo_state.sh SOURCE_DIR BIN_DIR
set -euo pipefail
source_dir=$1
bin=$2
place=$(mktemp -d)
trap 'rm -rf "$place"' EXIT
fail() { echo "$1"; [ ! -f "$place/log" ] || tail -20 "$place/log"; exit 1; }

checkout=$place/checkout
mkdir -p "$checkout"/{deploy,demo/state,demo/results,build/release}
cp "$source_dir/deploy/demo.sh" "$checkout/deploy"
for script in install_packages build; do
  printf '#!/bin/sh\n' >"$checkout/deploy/$script.sh"
  chmod +x "$checkout/deploy/$script.sh"
done
ln -s "$source_dir/config" "$checkout/config"
ln -s "$bin" "$checkout/build/release/bin"
echo earlier >"$checkout/demo/state/kept"
echo earlier >"$checkout/demo/results/kept"
demo() { "$checkout/deploy/demo.sh" --data "$1" >"$place/log" 2>&1; }

mkdir "$place/empty" "$place/bad"
printf 'time[s],pressure_a[Pa]\n0,nothing\n' >"$place/bad/test.csv"
for data in empty bad; do
  ! demo "$place/$data" || fail "a demo of recordings that cannot be played says nothing ($data)"
  [ -f "$checkout/demo/state/kept" ] && [ -f "$checkout/demo/results/kept" ] || fail "the earlier state is gone ($data)"
done
grep -q 'demo/state is as it was' "$place/log" || fail "it does not say that the earlier state is there"

"$bin/sealwatch" simulate --asset "$source_dir/config/assets/xt03-mv2.yaml" --months 2 --rate 50 --out "$place/good" >"$place/log"
demo "$place/good" || fail "a demo of good recordings fails"
[ ! -e "$checkout/demo/state/kept" ] && [ ! -e "$checkout/demo/results/kept" ] || fail "the earlier state is among the new"
[ -f "$checkout/demo/state/advisory_generation.db" ] && ls "$checkout"/demo/results/*.jsonl >/dev/null ||
  fail "the new state is not in its place"
[ ! -e "$checkout/demo/unfinished" ] || fail "demo/unfinished is left"
echo "a demo that fails leaves the earlier one's state, one that succeeds replaces it"
