#pragma once

namespace cloth::test {

/// Fused multiply-add peak of `threads` cores (FLOP/s, float32): independent chains that never
/// leave the registers, with the widest vectors the processor has; the best of several short runs.
double measured_peak(int threads);

/// What a plain matrix product of Eigen reaches on one core: (rows x k) times (k x n), FLOP/s.
double plain_product(int rows, int k, int n);

}  // namespace cloth::test
