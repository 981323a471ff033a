#!/usr/bin/env bash
# ThreadSanitizer, as tests/run.sh tsan sets it up, reports a race between OpenMP's threads, and none
# where a loop has none.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
cat > "$work/race.cpp" <<'CODE'
#include <vector>
int main(int arguments, char**) {
    std::vector<int> own(10000);
    int shared = 0;
    for (int round = 0; round < 20; ++round) {
#pragma omp parallel for num_threads(4)
        for (int i = 0; i < 10000; ++i) own[i] += i;
        if (arguments == 1) continue;
#pragma omp parallel num_threads(4)
        shared += own[round];  // each thread for certain, however busy the machine is
    }
    return own[1] == 20 && shared >= 0 ? 0 : 1;
}
CODE
clang++-14 -O1 -g -fopenmp -fsanitize=thread "$work/race.cpp" -o "$work/race"
if ! "$work/race" > "$work/log" 2>&1; then
  cat "$work/log"
  echo "ThreadSanitizer reports a race where there is none" >&2
  exit 1
fi
if "$work/race" racing > "$work/log" 2>&1 || ! grep -q "data race" "$work/log"; then
  cat "$work/log"
  echo "ThreadSanitizer does not see a race" >&2
  exit 1
fi
echo "ThreadSanitizer sees races"
