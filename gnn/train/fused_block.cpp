#include "gnn/train/fused_block.h"

#include "gnn/train/message_slots.h"

namespace cloth {

namespace {

using torch::Tensor;
using torch::autograd::AutogradContext;
using torch::autograd::variable_list;

using namespace message_slots;

/// Shape of one call: what is constant between its forward and its backward pass.
struct Call : torch::CustomClassHolder {
    std::shared_ptr<const FusedRows> rows;
    bool with_out = false;
};

const int* index_of(const std::vector<int>& index) {
    return index.empty() ? nullptr : index.data();
}

MessageBlockWeights block_weights(const variable_list& t) {
    MessageBlockWeights weights;
    weights.width = static_cast<int>(t[w2].size(0));
    for (int k = 0; k < max_inputs && !is_absent(t[x0 + k]); ++k) {
        weights.in[k] = static_cast<int>(t[x0 + k].size(1));
        weights.w1[k] = data_of(t[w10 + k]);
        weights.inputs = k + 1;
    }
    weights.b1 = data_of(t[b1]);
    weights.w2 = data_of(t[w2]);
    weights.b2 = data_of(t[b2]);
    weights.w3 = data_of(t[w3]);
    weights.b3 = data_of(t[b3]);
    weights.gamma = data_of(t[gamma]);
    weights.beta = data_of(t[beta]);
    return weights;
}

MessageBlockRows block_rows(const variable_list& t, const FusedRows& tables) {
    MessageBlockRows rows;
    rows.rows = tables.rows;
    for (int k = 0; k < max_inputs; ++k) rows.x[k] = data_of(t[x0 + k]);
    rows.x_index[0] = index_of(tables.x_index);
    for (int k = 0; k < 2 && !is_absent(t[p0 + k]); ++k) {
        rows.p[k] = data_of(t[p0 + k]);
        rows.p_index[k] = index_of(tables.product_index[k]);
        rows.products = k + 1;
    }
    rows.sum_index = index_of(tables.sum_index);
    rows.sum_scale = tables.sum_scale;
    return rows;
}

MessageBlockScratch& scratch() {
    thread_local MessageBlockScratch buffer;
    return buffer;
}

struct FusedFunction : torch::autograd::Function<FusedFunction> {
    static variable_list forward(AutogradContext* context, Tensor t_x0, Tensor t_x1, Tensor t_x2,
                                 Tensor t_x3, Tensor t_p0, Tensor t_p1, Tensor t_w10, Tensor t_w11,
                                 Tensor t_w12, Tensor t_w13, Tensor t_b1, Tensor t_w2, Tensor t_b2,
                                 Tensor t_w3, Tensor t_b3, Tensor t_gamma, Tensor t_beta,
                                 c10::intrusive_ptr<Call> call) {
        variable_list tensors = {t_x0,  t_x1, t_x2, t_x3, t_p0, t_p1, t_w10,   t_w11, t_w12,
                                 t_w13, t_b1, t_w2, t_b2, t_w3, t_b3, t_gamma, t_beta};
        for (Tensor& tensor : tensors) tensor = tensor.contiguous();
        context->save_for_backward(tensors);
        context->saved_data["call"] = c10::IValue::make_capsule(call);
        const FusedRows& tables = *call->rows;
        const MessageBlockWeights weights = block_weights(tensors);
        Tensor sum = torch::zeros({tables.sums, weights.width}, tensors[w2].options());
        Tensor out = call->with_out ? tensors[x0].clone() : Tensor();
        message_block_forward(weights, block_rows(tensors, tables), data_of(out), data_of(sum),
                              scratch());
        // an output must be defined; an unwanted one is empty
        return {call->with_out ? out : torch::empty({0}, tensors[w2].options()), sum};
    }

    static variable_list backward(AutogradContext* context, variable_list d_outputs) {
        const variable_list tensors = context->get_saved_variables();
        const auto call =
            c10::static_intrusive_pointer_cast<Call>(context->saved_data["call"].toCapsule());
        const FusedRows& tables = *call->rows;
        Tensor d_out =
            call->with_out && d_outputs[0].defined() ? d_outputs[0].contiguous() : Tensor();
        Tensor d_sum = d_outputs[1].defined() ? d_outputs[1].contiguous() : Tensor();
        variable_list gradients(slot_count + 1);
        for (int slot = 0; slot < slot_count; ++slot)
            if (!is_absent(tensors[slot]) && context->needs_input_grad(slot))
                gradients[slot] = slot == x0 && d_out.defined() ? d_out.clone()
                                                                : torch::zeros_like(tensors[slot]);
        MessageBlockGradients to;
        for (int k = 0; k < max_inputs; ++k) {
            to.x[k] = data_of(gradients[x0 + k]);
            to.w1[k] = data_of(gradients[w10 + k]);
        }
        for (int k = 0; k < 2; ++k) to.p[k] = data_of(gradients[p0 + k]);
        to.b1 = data_of(gradients[b1]);
        to.w2 = data_of(gradients[w2]);
        to.b2 = data_of(gradients[b2]);
        to.w3 = data_of(gradients[w3]);
        to.b3 = data_of(gradients[b3]);
        to.gamma = data_of(gradients[gamma]);
        to.beta = data_of(gradients[beta]);
        message_block_backward(block_weights(tensors), block_rows(tensors, tables), data_of(d_out),
                               data_of(d_sum), to, scratch());
        return gradients;
    }
};

}  // namespace

bool fused_block_supports(const Tensor& latent) {
    return latent.device().is_cpu() && latent.scalar_type() == torch::kFloat32 &&
           latent.size(-1) % 16 == 0;
}

FusedOutput fused_message_block(const std::vector<Tensor>& x, const std::vector<Tensor>& products,
                                const FusedWeights& weights, std::shared_ptr<const FusedRows> rows,
                                bool with_out) {
    auto call = c10::make_intrusive<Call>();
    call->rows = std::move(rows);
    call->with_out = with_out;
    return message_slots::apply<FusedFunction>(x, products, weights, call);
}

}  // namespace cloth
