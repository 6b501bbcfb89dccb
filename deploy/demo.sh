#!/usr/bin/env bash
# From a fresh Debian 12 machine to a forecast: installs packages, builds, starts the six services, plays nine years of
# monthly partial stroke tests of one actuator through them over DDS, and shows the forecast with its reasons.
#   deploy/demo.sh               with a life recorded by sealwatch's own virtual bench
#   deploy/demo.sh --data DIR    with the recordings (*.csv, *.mat) in DIR, of assets in config/assets that sidecars name
#                                (docs/recordings.md)
# Needs root or sudo for the packages, nothing else. Everything it makes is in build/ and demo/ of this checkout. Run it
# again as often as you like: one that fails leaves the state of the one before.
set -euo pipefail
started_in=$PWD
cd "$(dirname "$0")/.."

usage() { sed -n '2,8s/^# \{0,1\}//p' "$0"; exit "$1"; }
data=
while [ $# -gt 0 ]; do
  case "$1" in
    --data) [ $# -ge 2 ] || usage 2; data=$(cd "$started_in" && realpath -m -- "$2"); shift 2 ;;
    -h | --help) usage 0 ;;
    *) usage 2 >&2 ;;
  esac
done
recordings_in() { find "$1" -maxdepth 1 \( -name '*.csv' -o -name '*.mat' \) | sort; }
asset=XT03-MV2
[ -z "$data" ] || asset=ASSET_ID
if [ -n "$data" ] && [ -z "$(recordings_in "$data" 2>/dev/null)" ]; then
  echo "$0: no *.csv or *.mat in '$data'; give the folder that holds the recordings" >&2
  exit 2
fi

deploy/install_packages.sh build
echo "== build: takes five to ten minutes on two free cores the first time"
deploy/build.sh release --target monitoring -DSEALWATCH_TESTS=OFF
sealwatch=build/release/bin/sealwatch

# A discovery tag of its own keeps the demo apart from any other sealwatch on this machine.
export CYCLONEDDS_URI='<CycloneDDS><Domain Id="any"><General><Interfaces><NetworkInterface name="lo" multicast="true"/></Interfaces></General><Discovery><LeaseDuration>2s</LeaseDuration><Tag>sealwatch-demo</Tag></Discovery></Domain></CycloneDDS>'
# A place of its own until all recordings are played: they may be of an asset that nobody knows, or cut off.
unfinished=demo/unfinished
rm -rf $unfinished
mkdir -p $unfinished

if [ -z "$data" ]; then
  data=demo/recordings
  if [ ! -f demo/recordings/.complete ]; then
    echo "== bench: recording nine years of monthly tests of one ageing actuator"
    rm -rf demo/recordings
    "$sealwatch" simulate --asset config/assets/xt03-mv2.yaml --ageing --months 108 --missing 0.02 --cut 0.01 --rate 50 --seed 11 --out demo/recordings
    touch demo/recordings/.complete
  fi
fi

mapfile -t recordings < <(recordings_in "$data")
echo "== replay: ${#recordings[@]} tests through six services over DDS, as fast as they go"
"$sealwatch" replay --config config --with-services --state $unfinished/state --results $unfinished/results "${recordings[@]}" || {
  status=$?
  echo "$0: not all recordings were played; what came of them is in $unfinished, demo/state is as it was" >&2
  exit $status
}
rm -rf demo/state demo/results
mv $unfinished/state $unfinished/results demo
rmdir $unfinished

cat <<TXT

Look further (first: export PATH=\$PWD/build/release/bin:\$PATH):
  sealwatch forecast --config config --state demo/state --page demo/forecast.html
                                                     the forecast as a page for a browser
  sealwatch show $asset --state demo/state         what the advice was concluded from, down to the recording
  sealwatch up --config config --state demo/state    the services again, with what they remember
  sealwatch status                                   then, in another terminal: the latest advice on every actuator,
                                                     and the command that acknowledges its advice
  sealwatch watch                                    every message, live
  demo/results/*.jsonl                               all conclusions, a JSON line each
  demo/state/log/                                    what each service did, by PST id
  docs/tutorial.md                                   the same step by step, and what the figures mean
TXT
