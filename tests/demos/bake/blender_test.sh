#!/bin/sh
# Bakes a cape in all formats and lets Blender read them: blender_test.sh BAKE
set -e
if ! command -v blender > /dev/null; then
  echo "skipped: there is no blender; 'apt-get install blender' brings it"
  exit 77
fi
folder="$(mktemp -d)"
trap 'rm -rf "$folder"' EXIT
source="$(cd "$(dirname "$0")/../../.." && pwd)"
for out in cape.pc2 cape.mdd cape.usda cape.glb cape; do
  "$1" --character /usr/share/assimp/models/X/BCN_Epileptic.X --pin 0.39 1.0 --frames 12 \
       --garment "$source/data/assets/garments/cape.obj" --out "$folder/$out"
done
cd "$folder"
blender --background --factory-startup --python-exit-code 1 --python "$source/tests/demos/bake/blender_test.py"
