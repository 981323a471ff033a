#!/bin/sh
# Options of `train` that cannot work, or would change nothing, are refused at once, and files of a training
# are not overwritten. Usage: train_options.sh TRAIN FOLDER
set -eu
train=$1
out=$2
rm -rf "$out"
mkdir -p "$out"

# refused TEXT OPTIONS...: it ends with an error that has the text.
refused() {
    text=$1
    shift
    if "$train" --iterations 1 --garment-share 0 --validation-share 0 --out "$out/none" "$@" \
        >"$out/log" 2>&1; then
        echo "accepted: $*"
        exit 1
    fi
    if ! grep -qF -e "$text" "$out/log"; then
        echo "$*: the message has no '$text':"
        cat "$out/log"
        exit 1
    fi
}

refused "--width 20: is no multiple of 16" --width 20 --validation-share 0.1
refused "--levels: is for variants with coarse levels" --variant fast --levels 3
refused "--healed-last: has no effect with noise" --recipe paper --healed-last 0.1
refused "--own-refined: has no effect with noise" --kicks 0 --noise 3e-3 --own-refined 0.2
refused "--own-iterations: has no effect where all next" --healed-first 1 --healed-last 1 --own-iterations 3
refused "--own-iterations: has no effect where no own" --own-refined 0 --own-iterations 3
refused "--skinned-noise: has no effect" --skinned-noise 1e-3
refused "--skinned-at-rest: has no effect" --skinned-at-rest 1
refused "--garment: has no effect with --garment-share 0" --garment tshirt_1000
refused "--target-iterations: takes whole numbers only. Remedy: give 7" --target-iterations 6.9
refused "--rollout: takes whole numbers only" --rollout 2.5
refused "--rollout: 1e+300 is out of range. Remedy: use 1 to 100" --rollout 1e300
refused "--rollout: nan is out of range" --rollout nan
refused "the folder cannot be made" --out "$out/log/training"

# What would be overwritten.
for file in weights.safetensors metrics.csv rollouts.csv; do
    mkdir -p "$out/$file.kept"
    echo kept >"$out/$file.kept/$file"
    refused "has $file of a training already" --out "$out/$file.kept"
    grep -q kept "$out/$file.kept/$file"
done
refused "has weights.safetensors of a training already" --resume --out "$out/weights.safetensors.kept"
echo "refused"
