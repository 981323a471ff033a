#!/usr/bin/env bash
# clang-tidy 14 with the profile .clang-tidy finds nothing in the libraries. Needs a configured
# build folder, for the compiler's arguments; one that compiles in batches (build/asan does) takes half
# the time. Tests and demos are left out to keep it short; LibTorch needs half a minute per file.
#   tests/check_tidy.sh [BUILD [FILES...]]   build/asan and all files by default
set -euo pipefail
cd "$(dirname "$0")/.."
build="${1:-build/asan}"
shift || true
files=("$@")
if [ ${#files[@]} -eq 0 ]; then
  mapfile -t files < <(sed -nE \
    's#^ *"file": "(.*/(bullet_ext|collision|gnn/graph|gnn/model|gnn/physics|gnn/skinning)/[^"]*)",?$#\1#p' \
    "$build/compile_commands.json" | grep -vE '/tests/|cmake_pch')
fi
# the files are to include what they use, so no precompiled headers
commands="$(mktemp -d)"
trap 'rm -rf "$commands"' EXIT
sed -E 's/ -Winvalid-pch//; s/ -fpch-preprocess//; s/( -Xclang)? -include(-pch)?( -Xclang)? [^ ]*cmake_pch\.hxx(\.pch)?//g' \
  "$build/compile_commands.json" > "$commands/compile_commands.json"
# it counts suppressed warnings of other people's headers on standard error
printf '%s\0' "${files[@]}" |
  xargs -0 -n 1 -P "$(nproc)" clang-tidy-14 -p "$commands" --quiet \
    --extra-arg=-Wno-unknown-warning-option 2> >(grep -v 'warnings\? generated\.' >&2)
echo "clang-tidy: ${#files[@]} files"
