#!/usr/bin/env bash
# Installs what is needed, builds, runs every test. Quick the second time.
#   tests/run.sh [PRESET]   preset of CMakePresets.json: release (default), ci, dev, asan, notorch
set -euo pipefail
cd "$(dirname "$0")/.."
# compiled objects are found again in another checkout
export CCACHE_BASEDIR="$PWD" CCACHE_NOHASHDIR=1
preset="${1:-release}"

case "$preset" in
  asan | notorch) demos/install_packages.sh notorch ;;
  *) demos/install_packages.sh ;;
esac

echo "== configure and build: $preset"
cmake --preset "$preset" -DCMAKE_CXX_COMPILER_LAUNCHER=ccache >/dev/null
cmake --build --preset "$preset"

echo "== tests: $preset"
labels=()
if [ "$preset" = asan ]; then
  labels=(-L unit)
  # LibTorch-free, but third-party libraries keep caches for life
  export ASAN_OPTIONS="${ASAN_OPTIONS:-detect_leaks=0}"
fi
ctest --test-dir "build/$preset" --output-on-failure --parallel "$(nproc)" "${labels[@]}"
