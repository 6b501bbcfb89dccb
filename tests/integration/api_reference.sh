#!/usr/bin/env bash
# The API reference of the public headers, made without a warning.   api_reference.sh SOURCE_DIR OUTPUT_DIR
set -euo pipefail
command -v doxygen >/dev/null || { echo "doxygen is not installed (deploy/install_packages.sh test): skipped"; exit 77; }
cd "$1"
mkdir -p "$2"
{ cat deploy/doxygen/Doxyfile; echo "OUTPUT_DIRECTORY = \"$2\""; } | doxygen -
echo "$2/html/index.html"
