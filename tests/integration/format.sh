#!/usr/bin/env bash
# Every C++ file is as clang-format (version 14) would write it.  format.sh SOURCE_DIR
set -euo pipefail
cd "$1"
mapfile -t files < <(find include services tests docs/examples -name '*.hpp' -o -name '*.cpp' | sort)
clang-format-14 --dry-run -Werror "${files[@]}" && echo "${#files[@]} files are formatted"
