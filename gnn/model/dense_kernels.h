#pragma once

// Small dense products on tiles that stay in cache, written with GCC's vector extension so that one
// text serves AVX2 and AVX-512: the caller inlines them into a function compiled for its target.
// `Block` is the number of rows whose sums are kept in registers (8 for 32 registers, 4 for 16).

namespace cloth::kernels {

typedef float Lanes __attribute__((vector_size(64), aligned(4), may_alias));
constexpr int lane_count = 16;

#define CLOTH_INLINE inline __attribute__((always_inline))

CLOTH_INLINE const Lanes& load(const float* p) {
    return *reinterpret_cast<const Lanes*>(p);
}
CLOTH_INLINE Lanes& at(float* p) {
    return *reinterpret_cast<Lanes*>(p);
}

/// C (block x n, leading ldc) += A (block x k, leading lda) B (k x n, leading ldb), n = 16 Columns.
template <int Block, int Columns>
CLOTH_INLINE void multiply_panel(int k, const float* a, int lda, const float* b, int ldb, float* c,
                                 int ldc) {
    Lanes sum[Block][Columns];
    for (int r = 0; r < Block; ++r)
        for (int j = 0; j < Columns; ++j) sum[r][j] = load(c + r * ldc + j * lane_count);
    for (int i = 0; i < k; ++i) {
        Lanes row[Columns];
        for (int j = 0; j < Columns; ++j) row[j] = load(b + i * ldb + j * lane_count);
        for (int r = 0; r < Block; ++r) {
            const float value = a[r * lda + i];
            for (int j = 0; j < Columns; ++j) sum[r][j] += value * row[j];
        }
    }
    for (int r = 0; r < Block; ++r)
        for (int j = 0; j < Columns; ++j) at(c + r * ldc + j * lane_count) = sum[r][j];
}

/// C (rows x n) += A (rows x k) B (k x n); n a multiple of 16.
template <int Block>
CLOTH_INLINE void multiply(int rows, int k, int n, const float* a, int lda, const float* b, int ldb,
                           float* c, int ldc) {
    int j = 0;
    for (; j + 32 <= n; j += 32) {
        int r = 0;
        for (; r + Block <= rows; r += Block)
            multiply_panel<Block, 2>(k, a + r * lda, lda, b + j, ldb, c + r * ldc + j, ldc);
        for (; r < rows; ++r)
            multiply_panel<1, 2>(k, a + r * lda, lda, b + j, ldb, c + r * ldc + j, ldc);
    }
    for (; j < n; j += 16) {
        int r = 0;
        for (; r + Block <= rows; r += Block)
            multiply_panel<Block, 1>(k, a + r * lda, lda, b + j, ldb, c + r * ldc + j, ldc);
        for (; r < rows; ++r)
            multiply_panel<1, 1>(k, a + r * lda, lda, b + j, ldb, c + r * ldc + j, ldc);
    }
}

/// C (Block x n) += A^T B for one panel: A (rows x *, leading lda), B (rows x n).
template <int Block, int Columns>
CLOTH_INLINE void multiply_transposed_panel(int rows, const float* a, int lda, const float* b,
                                            int ldb, float* c, int ldc) {
    Lanes sum[Block][Columns];
    for (int r = 0; r < Block; ++r)
        for (int j = 0; j < Columns; ++j) sum[r][j] = load(c + r * ldc + j * lane_count);
    for (int t = 0; t < rows; ++t) {
        Lanes row[Columns];
        for (int j = 0; j < Columns; ++j) row[j] = load(b + t * ldb + j * lane_count);
        for (int r = 0; r < Block; ++r) {
            const float value = a[t * lda + r];
            for (int j = 0; j < Columns; ++j) sum[r][j] += value * row[j];
        }
    }
    for (int r = 0; r < Block; ++r)
        for (int j = 0; j < Columns; ++j) at(c + r * ldc + j * lane_count) = sum[r][j];
}

/// C (m x n) += A^T B with A (rows x m), B (rows x n); m and n multiples of 16.
template <int Block>
CLOTH_INLINE void multiply_transposed(int rows, int m, int n, const float* a, int lda,
                                      const float* b, int ldb, float* c, int ldc) {
    for (int i = 0; i < m; i += Block) {
        int j = 0;
        for (; j + 32 <= n; j += 32)
            multiply_transposed_panel<Block, 2>(rows, a + i, lda, b + j, ldb, c + i * ldc + j, ldc);
        for (; j < n; j += 16)
            multiply_transposed_panel<Block, 1>(rows, a + i, lda, b + j, ldb, c + i * ldc + j, ldc);
    }
}

}  // namespace cloth::kernels
