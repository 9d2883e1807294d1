#!/usr/bin/env bash
# Builds the site of the docs in out/docs/site; every warning is an error.
#   tools/docs.sh                      installs and builds what it needs
#   tools/docs.sh COMMANDS.md FOLDER   from the reference that mvtp-manual wrote, into FOLDER
set -euo pipefail
cd "$(dirname "$0")/.."

if [ $# -eq 0 ]; then
  tools/install_packages.sh
  cmake --preset release >/dev/null
  cmake --build --preset release --target mvtp_manual_pages
  set -- build/release/tools/manual/markdown/commands.md out/docs
fi
folder=$(realpath -m "$2")
export MVTP_DOCS_PAGES=$folder/pages MVTP_DOCS_SITE=$folder/site

tools/docs/stage.py --reference "$1" -o "$MVTP_DOCS_PAGES"
# What a public header of the planner gathers from its rooms is documented with it.
headers=$(sed -n 's/^  [a-z_]*\.hpp *\([^ ]*\).*/\1/p' cmake/PublicHeaders.cmake)
gathered=$(sed -n 's/^#include "\(planner\/[^"]*\)".*/\1/p' planner/*.hpp)
{
  cat tools/docs/Doxyfile
  echo "INPUT = $(sort -u <<<"$headers"$'\n'"$gathered" | tr '\n' ' ')"
  echo "OUTPUT_DIRECTORY = $MVTP_DOCS_PAGES/docs/reference"
} | doxygen -
mkdocs build --strict --clean
echo "Open $MVTP_DOCS_SITE/index.html in a browser." >&2
