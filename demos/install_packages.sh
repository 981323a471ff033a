#!/usr/bin/env bash
# Installs the Debian 12 packages that building and running FastCloth needs. Does nothing, without
# the network, when they are there already. Needs root or sudo only when something is missing.
#   demos/install_packages.sh          everything
#   demos/install_packages.sh notorch  all but LibTorch, which training needs
#   demos/install_packages.sh checks   as notorch, and the tools of .ci/run: format, lint, sanitizers
#   demos/install_packages.sh demo     what demos/run.sh builds: the runtime, pictures and videos
#   demos/install_packages.sh viewer   as demo, and the window of demos/viewer
set -euo pipefail

packages=(
  g++ cmake ninja-build pkg-config ccache
  libbullet-dev libfcl-dev libeigen3-dev libassimp-dev assimp-testmodels nlohmann-json3-dev libcli11-dev
  libosmesa6-dev libfreetype-dev fonts-dejavu-core libpng-dev
  libavcodec-dev libavformat-dev libavutil-dev libswscale-dev
)
viewer=(libglfw3-dev libimgui-dev libepoxy-dev)
# the viewer's window is tested on Xvfb's screen, by xdotool's mouse
tests=(libcgal-dev libgtest-dev libbenchmark-dev "${viewer[@]}" xvfb xdotool)
# clang only recommends the sanitizers' runtime
checks=(clang-14 libclang-rt-14-dev clang-format-14 clang-tidy-14 libomp-14-dev gcovr)
# without OpenBLAS LibTorch multiplies matrices by the reference BLAS, ten times slower
training=(libtorch-dev libopenblas0 libgloo-dev)
case "${1:-all}" in
  demo) ;;
  viewer) packages+=("${viewer[@]}") ;;
  notorch) packages+=("${tests[@]}") ;;
  checks) packages+=("${tests[@]}" "${checks[@]}") ;;
  all) packages+=("${tests[@]}" "${training[@]}") ;;
  *)
    echo "usage: demos/install_packages.sh [all|notorch|checks|demo|viewer]" >&2
    exit 2
    ;;
esac

missing=()
for package in "${packages[@]}"; do
  dpkg-query -W -f='${Status}' "$package" 2>/dev/null | grep -q 'ok installed' || missing+=("$package")
done
if [ ${#missing[@]} -eq 0 ]; then
  exit 0
fi

as_root=()
if [ "$(id -u)" -ne 0 ]; then
  if ! command -v sudo >/dev/null; then
    echo "These Debian packages are missing: ${missing[*]}" >&2
    echo "Run this script as root, or install sudo." >&2
    exit 1
  fi
  as_root=(sudo)
fi
echo "Installing: ${missing[*]}"
"${as_root[@]}" apt-get update -qq
"${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends \
  "${missing[@]}"
