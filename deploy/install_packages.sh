#!/usr/bin/env bash
# Installs the Debian 12 packages that sealwatch needs; does nothing when they are all there.
#   deploy/install_packages.sh build    what building and running needs
#   deploy/install_packages.sh test     that, and what the tests and benchmarks compare with
set -euo pipefail

build_packages=(
  g++ cmake ninja-build ccache pkg-config          # compiler and build
  cyclonedds-dev cyclonedds-tools                  # DDS and its IDL compiler
  libeigen3-dev libceres-dev libboost-dev          # linear algebra, optimiser, ODE for the bench and distributions
  libyaml-cpp-dev libspdlog-dev libcli11-dev       # configuration, logs, command line
  libfmt-dev                                       # text for people
  libsoci-dev libsqlite3-dev                       # journals
  libmatio-dev zlib1g-dev nlohmann-json3-dev libexpected-dev  # MATLAB files, JSON, error values
  libudunits2-dev                                  # units of foreign logs
  libzip-dev libpugixml-dev                        # Functional Mock-up Units: archive and description
  libsystemd-dev                                   # readiness and watchdog
  libssl-dev                                       # SHA-256 of the audit trail
  openssl                                          # identities for DDS Security
)
test_packages=(
  libgtest-dev libgmock-dev libbenchmark-dev       # tests and benchmarks
  libsundials-dev python3-scipy                    # independent solvers to compare with
  clang clang-format clang-tidy libclang-rt-14-dev # fuzzing, formatting, linting
  sqlite3 man-db dpkg-dev file                     # what tests look with, and what cpack packs with
  postgresql-15                                    # a server of the tests' own
  doxygen                                          # API reference of the public headers
)

case "${1:-}" in
  build) packages=("${build_packages[@]}") ;;
  test) packages=("${build_packages[@]}" "${test_packages[@]}") ;;
  *) echo "usage: $0 build|test" >&2; exit 2 ;;
esac

missing=()
for package in "${packages[@]}"; do
  dpkg-query -W -f '${Status}' "$package" 2>/dev/null | grep -q 'ok installed' || missing+=("$package")
done
if [ ${#missing[@]} -eq 0 ]; then
  echo "== packages: all ${#packages[@]} are installed"
  exit 0
fi

as_root=()
if [ "$(id -u)" -ne 0 ]; then
  command -v sudo >/dev/null || { echo "$0: run as root, or install sudo, to install: ${missing[*]}" >&2; exit 2; }
  as_root=(sudo)
fi
echo "== packages: installing ${missing[*]}"
"${as_root[@]}" apt-get update -qq
"${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "${missing[@]}" >/dev/null
