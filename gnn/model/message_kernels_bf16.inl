// The forward pass on bfloat16, included by message_kernels.inl. A product works on pairs of
// inputs: an activation pair is one 32-bit number that is broadcast, a row of a panel holds the
// pairs of its outputs. Without AVX512-BF16 the same numbers are widened and multiplied in float32.
//
// Rows are rounded once when they are gathered; each layer writes what the next one reads.

/// Pairs of bfloat16, the even input in the lower half.
typedef unsigned Pairs __attribute__((vector_size(4 * lanes)));
typedef unsigned PairsInMemory __attribute__((vector_size(4 * lanes), aligned(4), may_alias));
typedef unsigned Pair __attribute__((may_alias));
typedef unsigned short Halves __attribute__((vector_size(2 * lanes), aligned(2), may_alias));

CLOTH_INLINE Lanes add_products(Lanes sum, Pair a, const Pairs& b) {
#if defined(__AVX512BF16__)
    return reinterpret_cast<Lanes>(
        _mm512_dpbf16_ps(reinterpret_cast<__m512>(sum),
                         reinterpret_cast<__m512bh>(_mm512_set1_epi32(static_cast<int>(a))),
                         reinterpret_cast<__m512bh>(b)));
#else
    const unsigned parts[2] = {a & 0xffff0000u, a << 16};
    float odd, even;
    __builtin_memcpy(&odd, parts, 4);
    __builtin_memcpy(&even, parts + 1, 4);
    sum += odd * reinterpret_cast<Lanes>(b & 0xffff0000u);
    return sum + even * reinterpret_cast<Lanes>(b << 16);
#endif
}

/// Rounds numbers to nearest, ties to even.
CLOTH_INLINE Halves rounded(const Lanes& values) {
#if defined(__AVX512BF16__)
    return reinterpret_cast<Halves>(_mm512_cvtneps_pbh(reinterpret_cast<__m512>(values)));
#else
    const Pairs bits = reinterpret_cast<Pairs>(values);
    const Pairs nearest = bits + 0x7fffu + (bits >> 16 & 1u);
    return __builtin_convertvector((values == values ? nearest : bits | 0x400000u) >> 16, Halves);
#endif
}

template <int Columns>
CLOTH_INLINE void store_row(const Lanes (&values)[Columns], Bfloat16* to) {
#if defined(__AVX512BF16__)
    if (Columns == 2) {
        *reinterpret_cast<PairsInMemory*>(to) = reinterpret_cast<Pairs>(_mm512_cvtne2ps_pbh(
            reinterpret_cast<__m512>(values[Columns - 1]), reinterpret_cast<__m512>(values[0])));
        return;
    }
#endif
    for (int j = 0; j < Columns; ++j)
        *reinterpret_cast<Halves*>(to + j * lanes) = rounded(values[j]);
}

template <int Columns>
CLOTH_INLINE void store_row(const Lanes (&values)[Columns], float* to) {
    for (int j = 0; j < Columns; ++j) at(to + j * lanes) = values[j];
}

/// One input of a layer: consecutive rows.
struct RoundedInput {
    const Bfloat16* x;
    int width;
    const Bfloat16* panels;
};

/// As Layer, with rounded inputs.
struct RoundedLayer {
    RoundedInput input[MessageBlockWeights::max_inputs];
    int inputs;
    int outputs;
    const float* bias;  // or null
    const float* p[2];
    const int* p_index[2];
    int products;
    bool with_relu;
};

template <int Block, int Columns>
CLOTH_INLINE void add_input(const RoundedInput& input, int first, int column, int outputs,
                            Lanes (&sum)[Block][Columns]) {
    const int panel = column / panel_width * panel_width;
    const int ldb = smaller(panel_width, outputs - panel), pairs = input.width / 2;
    const Pair* a = reinterpret_cast<const Pair*>(input.x) + static_cast<long>(first) * pairs;
    const Pair* b = reinterpret_cast<const Pair*>(input.panels) + panel * pairs + column - panel;
    for (int i = 0; i < pairs; ++i) {
        Pairs row[Columns];
        for (int j = 0; j < Columns; ++j)
            row[j] = *reinterpret_cast<const PairsInMemory*>(b + i * ldb + j * lanes);
        for (int r = 0; r < Block; ++r)
            for (int j = 0; j < Columns; ++j)
                sum[r][j] = add_products(sum[r][j], a[r * pairs + i], row[j]);
    }
}

template <int Block, int Columns, typename To>
CLOTH_INLINE void rounded_block(const RoundedLayer& layer, int first, int column, To* y) {
    const int d = layer.outputs;
    Lanes sum[Block][Columns];
    for (int r = 0; r < Block; ++r)
        for (int j = 0; j < Columns; ++j)
            sum[r][j] = layer.bias ? load(layer.bias + column + j * lanes) : Lanes{};
    for (int k = 0; k < layer.products; ++k)
        for (int r = 0; r < Block; ++r) {
            const float* p = layer.p[k] + row_of(layer.p_index[k], first + r) * d + column;
            for (int j = 0; j < Columns; ++j) sum[r][j] += load(p + j * lanes);
        }
    for (int k = 0; k < layer.inputs; ++k)
        add_input<Block, Columns>(layer.input[k], first, column, d, sum);
    for (int r = 0; r < Block; ++r) {
        if (layer.with_relu)
            for (int j = 0; j < Columns; ++j) sum[r][j] = sum[r][j] > 0.0f ? sum[r][j] : Lanes{};
        store_row<Columns>(sum[r], y + static_cast<long>(first + r) * d + column);
    }
}

template <int Columns, typename To>
CLOTH_INLINE void rounded_column(const RoundedLayer& layer, int rows, int column, To* y) {
    int r = 0;
    for (; r + block <= rows; r += block) rounded_block<block, Columns>(layer, r, column, y);
    for (; r < rows; ++r) rounded_block<1, Columns>(layer, r, column, y);
}

template <typename To>
CLOTH_INLINE void evaluate(const RoundedLayer& layer, int rows, To* y) {
    int column = 0;
    for (; column + lanes * columns <= layer.outputs; column += lanes * columns)
        rounded_column<columns>(layer, rows, column, y);
    for (; column < layer.outputs; column += lanes) rounded_column<1>(layer, rows, column, y);
}

/// Rounds rows, those of a list or consecutive ones.
CLOTH_INLINE void gather_rounded(const float* x, const int* index, int rows, int width,
                                 Bfloat16* to) {
    for (int r = 0; r < rows; ++r, to += width) {
        const float* from = x + row_of(index, r) * width;
        int i = 0;
        for (; i + 2 * lanes <= width; i += 2 * lanes) {
            const Lanes two[2] = {load(from + i), load(from + i + lanes)};
            store_row<2>(two, to + i);
        }
        for (; i < width; i += lanes) {
            const Lanes one[1] = {load(from + i)};
            store_row<1>(one, to + i);
        }
    }
}

/// Buffers of one tile, cut from the caller's scratch.
struct RoundedTile {
    Bfloat16 *a, *b;                               // (tile x D): activations
    float *y, *inverse;                            // third layer (tile x D), 1 / deviation (tile)
    float* bias;                                   // b3 less its mean (D)
    Bfloat16* x[MessageBlockWeights::max_inputs];  // gathered inputs (tile x in)
};

CLOTH_INLINE RoundedTile make_rounded_tile(const MessageBlockWeights& w, int d, float* scratch) {
    RoundedTile tile{};
    const auto take = [&scratch](int numbers) {
        float* result = scratch;
        scratch += numbers;
        return result;
    };
    tile.y = take(tile_rows * d);
    tile.inverse = take(tile_rows);
    tile.bias = take(d);
    tile.a = reinterpret_cast<Bfloat16*>(take(tile_rows / 2 * d));
    tile.b = reinterpret_cast<Bfloat16*>(take(tile_rows / 2 * d));
    for (int k = 0; k < w.inputs; ++k)
        tile.x[k] = reinterpret_cast<Bfloat16*>(take(tile_rows / 2 * w.in[k]));
    float mean = 0.0f;
    for (int i = 0; i < d; ++i) mean += w.b3[i];
    mean /= static_cast<float>(d);
    for (int i = 0; i < d; i += lanes) at(tile.bias + i) = load(w.b3 + i) - mean;
    return tile;
}

/// The third layer's panels and bias are centred: y has no mean to subtract.
CLOTH_INLINE void centred_statistics(int d, const float* y, float* inverse) {
    Lanes t[lanes];
    for (int r = 0; r < lanes; ++r) {
        t[r] = load(y + r * d) * load(y + r * d);
        for (int i = lanes; i < d; i += lanes) t[r] += load(y + r * d + i) * load(y + r * d + i);
    }
    const Lanes variance = sums_of(t) * (1.0f / static_cast<float>(d)) + norm_epsilon;
    for (int r = 0; r < lanes; ++r) inverse[r] = 1.0f / __builtin_sqrtf(variance[r]);
}

CLOTH_INLINE void evaluate_rounded_tile(const MessageBlockWeights& w, const MessageBlockRows& rows,
                                        int d, int first, int count, const RoundedTile& tile) {
    const Bfloat16* panels = w.panels.bfloat16;
    RoundedLayer layer{};
    layer.outputs = d;
    layer.bias = w.b1;
    layer.with_relu = true;
    for (int k = 0; k < w.inputs; ++k) {
        const int n = w.in[k];
        if (rows.x[k]) {
            const int* index = rows.x_index[k] ? rows.x_index[k] + first : nullptr;
            const float* x = index ? rows.x[k] : rows.x[k] + static_cast<long>(first) * n;
            gather_rounded(x, index, count, n, tile.x[k]);
            layer.input[layer.inputs++] = {tile.x[k], n, panels};
        }
        panels += static_cast<long>(n) * d;
    }
    layer.products = rows.products;
    for (int k = 0; k < rows.products; ++k) {
        layer.p_index[k] = rows.p_index[k] ? rows.p_index[k] + first : nullptr;
        layer.p[k] = layer.p_index[k] ? rows.p[k] : rows.p[k] + static_cast<long>(first) * d;
    }
    evaluate(layer, count, tile.a);
    RoundedLayer second{};
    second.inputs = 1;
    second.outputs = d;
    second.input[0] = {tile.a, d, panels};
    second.bias = w.b2;
    second.with_relu = true;
    evaluate(second, count, tile.b);
    RoundedLayer third{};
    third.inputs = 1;
    third.outputs = d;
    third.input[0] = {tile.b, d, panels + static_cast<long>(d) * d};
    third.bias = tile.bias;
    evaluate(third, count, tile.y);
    for (int r = 0; r < count; r += lanes) centred_statistics(d, tile.y + r * d, tile.inverse + r);
}

/// Width 0: known at run time only.
template <int Width>
void forward_rounded(const MessageBlockWeights& w, const MessageBlockRows& rows, float* out,
                     float* sum, float* scratch) {
    const int d = Width ? Width : w.width;
    const RoundedTile tile = make_rounded_tile(w, d, scratch);
    for (int first = 0; first < rows.rows; first += tile_rows) {
        const int count = smaller(tile_rows, rows.rows - first);
        evaluate_rounded_tile(w, rows, d, first, count, tile);
        for (int r = 0; r < count; ++r) {
            const long edge = row_of(rows.x_index[0], first + r) * d;
            float* sum_row = sum ? sum + row_of(rows.sum_index, first + r) * d : nullptr;
            const float inverse = tile.inverse[r];
            for (int i = 0; i < d; i += lanes) {
                const Lanes message =
                    load(tile.y + r * d + i) * inverse * load(w.gamma + i) + load(w.beta + i);
                if (out) at(out + edge + i) = load(rows.x[0] + edge + i) + message;
                if (sum) at(sum_row + i) += rows.sum_scale * message;
            }
        }
    }
}

void forward_bf16(const MessageBlockWeights& w, const MessageBlockRows& rows, float* out,
                  float* sum, float* scratch) {
#if defined(__AVX512BF16__)
    // Products are so fast here that loops over a row's few vectors count: 12 % at width 32.
    if (w.width == 16) return forward_rounded<16>(w, rows, out, sum, scratch);
    if (w.width == 32) return forward_rounded<32>(w, rows, out, sum, scratch);
    if (w.width == 64) return forward_rounded<64>(w, rows, out, sum, scratch);
    if (w.width == 128) return forward_rounded<128>(w, rows, out, sum, scratch);
#endif
    forward_rounded<0>(w, rows, out, sum, scratch);
}

void dense_bf16(int rows, int in, int out, const float* x, const Bfloat16* panels,
                const float* bias, bool with_relu, float* y, float* scratch) {
    Bfloat16* tile = reinterpret_cast<Bfloat16*>(scratch);
    RoundedLayer layer{};
    layer.inputs = 1;
    layer.outputs = out;
    layer.input[0] = {tile, in, panels};
    layer.bias = bias;
    layer.with_relu = with_relu;
    for (int first = 0; first < rows; first += tile_rows) {
        const int count = smaller(tile_rows, rows - first);
        gather_rounded(x + static_cast<long>(first) * in, nullptr, count, in, tile);
        evaluate(layer, count, y + static_cast<long>(first) * out);
    }
}
