# For scripts that kill trainings: $train is the program, $out the folder of all trainings.
options="--width 16 --steps 2 --garment-share 0 --pool 4 --save-every 0 --validation-share 0"

# run FOLDER ARGUMENTS...
run() {
    folder=$1
    shift
    # shellcheck disable=SC2086
    "$train" $options --out "$out/$folder" "$@" 2>>"$out/$folder.log"
}

fail() {
    echo "$1"
    cat "$out"/*.log
    exit 1
}

# Starts a training in the folder `killed`, which is $training, and waits until it has saved a
# checkpoint.
start_killed() {
    touch "$out/before"
    sleep 0.05
    # shellcheck disable=SC2086
    "$train" $options --resume --out "$out/killed" "$@" 2>>"$out/killed.log" &
    training=$!
    for _ in $(seq 600); do
        if [ "$out/killed/checkpoint.pt" -nt "$out/before" ]; then return 0; fi
        sleep 0.1
    done
    fail "no checkpoint within a minute"
}
