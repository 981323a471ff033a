#!/bin/sh
# Two processes train together: started by --processes or by the environment they get the same bits, also
# if one of them, or the one that watches over them, was killed meanwhile.
# Usage: distributed_training.sh TRAIN FOLDER
set -eu
train=$1
out=$2
unset RANK WORLD_SIZE MASTER_ADDR MASTER_PORT
rm -rf "$out"
mkdir -p "$out"

. "$(dirname "$0")/trainings.sh"
options="$options --iterations 60 --batch 2"

lives() {
    grep -q "^State:.*[^Z] (" "/proc/$1/status" 2>/dev/null
}

run straight --processes 2

# By the environment, as on two machines; the port may be taken by others meanwhile.
started=no
for port in 29517 29871 30433; do
    rm -rf "$out/environment"
    WORLD_SIZE=2 RANK=1 MASTER_ADDR=127.0.0.1 MASTER_PORT=$port run environment &
    if WORLD_SIZE=2 RANK=0 MASTER_ADDR=127.0.0.1 MASTER_PORT=$port run environment && wait $!; then
        started=yes
        break
    fi
    kill $! 2>/dev/null || true
done
[ $started = yes ] || fail "it cannot be started by the environment"
cmp "$out/straight/weights.safetensors" "$out/environment/weights.safetensors"

# One of those that train is killed, or the one that watches over them.
for victim in trainer watcher; do
    start_killed --processes 2
    watcher=$training
    children=$(cat "/proc/$watcher/task/$watcher/children")
    if [ $victim = trainer ]; then
        kill -KILL "${children%% *}"
    else
        kill -KILL "$watcher"
    fi
    wait "$watcher" && fail "the loss of the $victim was not noticed"
    for child in $children; do
        for _ in $(seq 300); do
            lives "$child" || break
            sleep 0.1
        done
        lives "$child" && fail "a process outlives the $victim"
    done
done
run killed --processes 2 --resume
cmp "$out/straight/weights.safetensors" "$out/killed/weights.safetensors"

# What contradicts itself is refused.
if WORLD_SIZE=3 RANK=0 MASTER_ADDR=127.0.0.1 MASTER_PORT=29517 run refused --processes 2; then
    fail "--processes and WORLD_SIZE contradict each other"
fi
if run refused --processes 2 --batch 3; then fail "two processes share a batch of three"; fi
grep -q "cannot be shared by 2 processes" "$out/refused.log" || fail "the message is missing"
echo "equal bits"
