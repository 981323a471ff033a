#!/bin/sh
# A training that is killed, stopped and resumed ends with the bits of one that was left alone.
# Usage: killed_training.sh TRAIN FOLDER
set -eu
train=$1
out=$2
rm -rf "$out"
mkdir -p "$out"

. "$(dirname "$0")/trainings.sh"
options="$options --iterations 150"

run alone --nice 1

for signal in KILL TERM; do
    start_killed
    kill -$signal "$training"
    status=0
    wait "$training" || status=$?
    if [ $signal = TERM ] && [ $status -ne 0 ]; then
        echo "stopped by SIGTERM it ended with status $status"
        exit 1
    fi
done

# Without --resume a training is not overwritten.
if run killed; then
    echo "a training was overwritten"
    exit 1
fi

run killed --resume --nice 1
cmp "$out/alone/weights.safetensors" "$out/killed/weights.safetensors"
grep -q "left, done on" "$out/alone.log"
echo "equal bits"
