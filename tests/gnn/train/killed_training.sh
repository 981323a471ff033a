#!/bin/sh
# A training that is killed, stopped and resumed ends with the bits of one that was left alone.
# Usage: killed_training.sh TRAIN FOLDER
set -eu
train=$1
out=$2
rm -rf "$out"
mkdir -p "$out"

run() {
    folder=$1
    shift
    "$train" --width 16 --steps 2 --garment-share 0 --pool 4 --iterations 150 --save-every 0 \
        --validation-share 0 --nice 1 --out "$out/$folder" "$@" 2>>"$out/$folder.log"
}

# Waits until the training has saved a checkpoint since the last call.
await_checkpoint() {
    for _ in $(seq 600); do
        if [ "$out/killed/checkpoint.pt" -nt "$out/before" ]; then return 0; fi
        sleep 0.1
    done
    echo "no checkpoint within a minute"
    cat "$out/killed.log"
    exit 1
}

run alone

for signal in KILL TERM; do
    touch "$out/before"
    sleep 0.05
    "$train" --width 16 --steps 2 --garment-share 0 --pool 4 --iterations 150 --save-every 0 \
        --validation-share 0 --resume --out "$out/killed" 2>>"$out/killed.log" &
    training=$!
    await_checkpoint
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

run killed --resume
cmp "$out/alone/weights.safetensors" "$out/killed/weights.safetensors"
grep -q "left, done on" "$out/alone.log"
echo "equal bits"
