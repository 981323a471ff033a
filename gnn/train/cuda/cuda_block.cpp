#include "gnn/train/cuda/cuda_block.h"

#include <stdexcept>
#include <string>

#include "gnn/train/cuda/message_kernels.h"
#include "gnn/train/message_slots.h"

namespace cloth {

namespace {

using torch::Tensor;
using torch::autograd::AutogradContext;
using torch::autograd::variable_list;

using namespace message_slots;

/// Shape of one call: what is constant between its forward and its backward pass.
struct Call : torch::CustomClassHolder {
    Tensor x_index, product_index[2], sum_index;
    std::int64_t rows = 0, sums = 0;
    float sum_scale = 1.0f;
    bool with_out = false;
};

void check(int error) {
    if (error != 0) throw std::runtime_error("message block: CUDA error " + std::to_string(error));
}

const std::int64_t* index_of(const Tensor& index) {
    return index.defined() ? index.data_ptr<std::int64_t>() : nullptr;
}

cuda::FirstLayer first_layer_of(const Call& call, const variable_list& t) {
    cuda::FirstLayer layer;
    layer.rows = call.rows;
    layer.width = static_cast<int>(t[w2].size(0));
    layer.x_index = index_of(call.x_index);
    for (int k = 0; k < 2; ++k) {
        layer.p[k] = data_of(t[static_cast<size_t>(p0 + k)]);
        layer.p_index[k] = index_of(call.product_index[k]);
    }
    layer.bias = data_of(t[b1]);
    return layer;
}

cuda::Norm norm_of(const Call& call, const variable_list& t, const Tensor& h3) {
    cuda::Norm norm;
    norm.rows = call.rows;
    norm.width = static_cast<int>(t[w2].size(0));
    norm.h = data_of(h3);
    norm.gamma = data_of(t[gamma]);
    norm.beta = data_of(t[beta]);
    norm.x_index = index_of(call.x_index);
    norm.sum_index = index_of(call.sum_index);
    norm.sum_scale = call.sum_scale;
    return norm;
}

/// Of the inputs without an index; undefined if there are none.
Tensor rest_of(const variable_list& t) {
    Tensor rest;
    for (size_t k = 1; k < max_inputs && !is_absent(t[x0 + k]); ++k)
        rest = rest.defined() ? torch::addmm(rest, t[x0 + k], t[w10 + k].t())
                              : torch::mm(t[x0 + k], t[w10 + k].t());
    return rest;
}

struct CudaFunction : torch::autograd::Function<CudaFunction> {
    static variable_list forward(AutogradContext* context, Tensor t_x0, Tensor t_x1, Tensor t_x2,
                                 Tensor t_x3, Tensor t_p0, Tensor t_p1, Tensor t_w10, Tensor t_w11,
                                 Tensor t_w12, Tensor t_w13, Tensor t_b1, Tensor t_w2, Tensor t_b2,
                                 Tensor t_w3, Tensor t_b3, Tensor t_gamma, Tensor t_beta,
                                 c10::intrusive_ptr<Call> call) {
        variable_list t = {t_x0,  t_x1, t_x2, t_x3, t_p0, t_p1, t_w10,   t_w11, t_w12,
                           t_w13, t_b1, t_w2, t_b2, t_w3, t_b3, t_gamma, t_beta};
        for (Tensor& tensor : t) tensor = tensor.contiguous();
        const auto width = t[w2].size(0);
        const auto options = t[w2].options().requires_grad(false);
        const Tensor x = torch::mm(t[x0], t[w10].t()), rest = rest_of(t);
        cuda::FirstLayer layer = first_layer_of(*call, t);
        layer.x = data_of(x);
        layer.rest = data_of(rest);
        const Tensor h1 = torch::empty({call->rows, width}, options);
        check(cuda::first_layer(layer, data_of(h1)));
        const Tensor h2 = torch::addmm(t[b2], h1, t[w2].t()).relu_();
        const Tensor h3 = torch::addmm(t[b3], h2, t[w3].t());
        const Tensor sum = torch::zeros({call->sums, width}, options);
        const Tensor out = call->with_out ? t[x0].clone() : torch::empty({0}, options);
        check(cuda::norm_and_add(norm_of(*call, t, h3), data_of(out), data_of(sum)));
        t.insert(t.end(), {h1, h2, h3});
        context->save_for_backward(t);
        context->saved_data["call"] = c10::IValue::make_capsule(call);
        return {out, sum};
    }

    static variable_list backward(AutogradContext* context, variable_list d_outputs) {
        const variable_list t = context->get_saved_variables();
        const Tensor &h1 = t[slot_count], &h2 = t[slot_count + 1], &h3 = t[slot_count + 2];
        const auto call =
            c10::static_intrusive_pointer_cast<Call>(context->saved_data["call"].toCapsule());
        const auto given = [](const Tensor& d) { return d.defined() ? d.contiguous() : Tensor(); };
        const Tensor d_out = call->with_out ? given(d_outputs[0]) : Tensor();
        const Tensor d_sum = given(d_outputs[1]);
        variable_list d(slot_count + 1);
        const Tensor columns = torch::zeros({5, t[w2].size(0)}, t[w2].options());
        const Slot of_columns[] = {gamma, beta, b3, b2, b1};
        for (int k = 0; k < 5; ++k) d[of_columns[k]] = columns[k];
        const Tensor d3 = torch::empty_like(h3);
        check(cuda::norm_backward(norm_of(*call, t, h3), data_of(d_out), data_of(d_sum),
                                  data_of(d3), data_of(d[gamma]), data_of(d[beta]),
                                  data_of(d[b3])));
        d[w3] = torch::mm(d3.t(), h2);
        const Tensor d2 = torch::mm(d3, t[w3]);
        check(cuda::relu_backward(call->rows, static_cast<int>(d2.size(1)), data_of(h2),
                                  data_of(d2), data_of(d[b2])));
        d[w2] = torch::mm(d2.t(), h1);
        const Tensor d1 = torch::mm(d2, t[w2]);
        first_layer_gradients(*call, t, h1, d1, d);
        if (d_out.defined() && d[x0].defined()) d[x0] = d[x0] + d_out;
        return d;
    }

    /// From d1, the gradient of h1, those of all that the first layer reads.
    static void first_layer_gradients(const Call& call, const variable_list& t, const Tensor& h1,
                                      const Tensor& d1, variable_list& d) {
        const auto target = [&](const Tensor& index, std::int64_t rows) {
            return index.defined() ? torch::zeros({rows, d1.size(1)}, d1.options()) : Tensor();
        };
        const Tensor dx = target(call.x_index, t[x0].size(0));
        for (size_t k = 0; k < 2; ++k)
            if (!is_absent(t[p0 + k])) d[p0 + k] = target(call.product_index[k], t[p0 + k].size(0));
        float* const dp[] = {data_of(d[p0]), data_of(d[p1])};
        check(cuda::first_layer_backward(first_layer_of(call, t), data_of(h1), data_of(d1),
                                         data_of(dx), dp, data_of(d[b1])));
        for (size_t k = 0; k < 2; ++k)
            if (!is_absent(t[p0 + k]) && !d[p0 + k].defined()) d[p0 + k] = d1;
        for (size_t k = 0; k < max_inputs && !is_absent(t[x0 + k]); ++k) {
            const Tensor& of = k == 0 && dx.defined() ? dx : d1;
            d[w10 + k] = torch::mm(of.t(), t[x0 + k]);
            d[x0 + k] = torch::mm(of, t[w10 + k]);
        }
    }
};

}  // namespace

bool cuda_block_supports(const Tensor& latent) {
    return latent.device().is_cuda() && latent.scalar_type() == torch::kFloat32 &&
           latent.size(-1) <= 512;
}

FusedOutput cuda_message_block(const std::vector<Tensor>& x, const std::vector<Tensor>& products,
                               const FusedWeights& weights, const MessageTable& table,
                               bool with_out) {
    auto call = c10::make_intrusive<Call>();
    call->x_index = table.x_index;
    call->product_index[0] = table.product_index[0];
    call->product_index[1] = table.product_index[1];
    call->sum_index = table.sum_index;
    call->rows = table.rows->rows;
    call->sums = table.rows->sums;
    call->sum_scale = table.rows->sum_scale;
    call->with_out = with_out;
    return message_slots::apply<CudaFunction>(x, products, weights, call);
}

}  // namespace cloth
