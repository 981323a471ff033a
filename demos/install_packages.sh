#!/usr/bin/env bash
# Installs the Debian 12 packages that building and running FastCloth needs. Does nothing, without
# the network, when they are there already. Needs root or sudo only when something is missing.
#   CLOTH_WITH_TORCH=0  leaves LibTorch out
set -euo pipefail

packages=(
  g++ cmake ninja-build pkg-config ccache
  libbullet-dev libfcl-dev libeigen3-dev libassimp-dev assimp-testmodels
  libosmesa6-dev libfreetype-dev fonts-dejavu-core libpng-dev
  libavcodec-dev libavformat-dev libavutil-dev libswscale-dev
  libcgal-dev libsuitesparse-dev nlohmann-json3-dev
  libgtest-dev libbenchmark-dev libcli11-dev
)
if [ "${CLOTH_WITH_TORCH:-1}" != 0 ]; then
  # without OpenBLAS LibTorch multiplies matrices by the reference BLAS, ten times slower
  packages+=(libtorch-dev libopenblas0)
fi

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
