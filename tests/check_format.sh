#!/usr/bin/env bash
# Every C++ file of the repository is formatted as .clang-format says, by clang-format 14.
#   tests/check_format.sh          names the places that are not, and fails
#   tests/check_format.sh --fix    formats them
set -euo pipefail
cd "$(dirname "$0")/.."
arguments=(--dry-run -Werror)
[ "${1:-}" = --fix ] && arguments=(-i)
git ls-files -z '*.h' '*.cpp' '*.cu' | xargs -0 -n 50 -P "$(nproc)" clang-format-14 "${arguments[@]}"
echo "format: $(git ls-files '*.h' '*.cpp' '*.cu' | wc -l) files"
