#!/usr/bin/env bash
# Installs what is needed, builds, runs every test. Quick the second time.
#   tests/run.sh [PRESET [CTEST ARGUMENTS...]]
#     preset of CMakePresets.json: release (default), ci, dev, asan, notorch;
#     tsan: the tests with several threads; coverage: prints the share of lines
set -euo pipefail
cd "$(dirname "$0")/.."
# compiled objects are found again in another checkout
export CCACHE_BASEDIR="$PWD" CCACHE_NOHASHDIR=1 CCACHE_SLOPPINESS=pch_defines,time_macros
preset="${1:-release}"
shift || true

case "$preset" in
  notorch) demos/install_packages.sh notorch ;;
  asan | tsan | coverage) demos/install_packages.sh checks ;;
  *) demos/install_packages.sh ;;
esac

echo "== configure and build: $preset"
cmake --preset "$preset" -DCMAKE_CXX_COMPILER_LAUNCHER=ccache >/dev/null
cmake --build --preset "$preset"

echo "== tests: $preset"
selection=()
jobs="$(nproc)"
# Tests run side by side: a thread that spins while it waits for its team takes another test's core.
export OMP_WAIT_POLICY="${OMP_WAIT_POLICY:-passive}"
case "$preset" in
  asan)
    # Long runs through code that short tests run, too: the other presets have them.
    long_runs='Remesh.DoesNotTakeABorderThatSlid|SelfResolver.TearsNoClothThatMayPass'
    long_runs+='|CouplingEnergy.Landings$|CouplingEnergy.Trampolines|CouplingEnergy.RodsOnStiffCloth'
    long_runs+='|CouplingEnergy.AnchorsOnStiffCloth|ClothContacts.WhatFallsOnANetMakesNoEnergy'
    long_runs+='|ClothContacts.WhatLiesOnTheUpperSheet'
    long_runs+='|SkinGoals.TheTanglesOfAFastCape|BulletScale.HangingSheets'
    long_runs+='|SheetOnSheet.SlidesAboveIt|CoarseLevels.AreSoundOnTornSheets'
    long_runs+='|Untangling.WhatCannotBeUndone|FitGarment.SampledPeople|AnchoredBodies.ARodAlong'
    selection=(-L unit -E "$long_runs")
    # LibTorch-free, but third-party libraries keep caches for life
    export ASAN_OPTIONS="${ASAN_OPTIONS:-detect_leaks=0}"
    ;;
  coverage)
    selection=(-L unit -LE slow)
    find build/coverage -name '*.gcda' -delete
    ;;
  tsan)
    selection=(-R Thread)
    # Archer tells ThreadSanitizer where OpenMP's threads wait for each other; the runtime itself and
    # other libraries are not instrumented.
    export OMP_TOOL_LIBRARIES=/usr/lib/llvm-14/lib/libarcher.so
    export TSAN_OPTIONS="${TSAN_OPTIONS:-ignore_noninstrumented_modules=1}"
    jobs=1  # a thread that gets no core before the work is done cannot race
    tests/tsan_sees_races.sh
    ;;
esac
ctest --test-dir "build/$preset" --output-on-failure --no-tests=error --parallel "$jobs" \
  "${selection[@]}" "$@"

if [ "$preset" = coverage ]; then
  echo "== lines that the tests ran"
  gcovr --root . --filter '(bullet_ext|collision|data|gnn|render)/' --print-summary build/coverage |
    tail -n 6
fi
