#!/usr/bin/env bash
# Installs what is needed, builds it, and compares solvers on the T-shirt: a video and a report.
# Quick the second time. Further arguments are handed to `compare`, which has more solvers and motions:
#   demos/run.sh --frames 90 --reference-frames 30 --solvers \
#     bullet,bullet-fine,xpbd-40,default,default~tshirt_1000+1,quasi-newton,small,hood_fast_own+0
set -euo pipefail
cd "$(dirname "$0")/.."

demos/install_packages.sh demo
echo "== configure and build"
cmake --preset demo >/dev/null
cmake --build --preset demo --target compare

out="out/compare"
echo "== T-shirt on motion 01_01: comparing solvers"
build/demo/demos/compare --garment tshirt --motion 01_01 --frames 60 --reference-frames 5 \
  --solvers bullet,default,xpbd-40,small --out "$out" "$@"
echo "video:  $PWD/$out/comparison.mp4"
echo "report: $PWD/$out/report.html"
