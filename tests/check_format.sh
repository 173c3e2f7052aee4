#!/usr/bin/env bash
# Compares every C++ file with what .clang-format makes of it; names the lines that differ. Mends nothing:
#   clang-format -i FILE...
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
if ! command -v clang-format >/dev/null; then
  echo "SKIPPED: clang-format is not installed (apps/install-packages.sh --tests installs it)"
  exit 77
fi
find modules apps tests \( -name '*.cpp' -o -name '*.h' \) -print0 | xargs -0 -P "$(nproc)" -n 60 clang-format --dry-run --Werror
