#include "gnn/train/torch_predictor.h"

#include <limits>

#include "data/core/errors.h"
#include "gnn/train/network.h"

namespace cloth {

namespace {

class TorchPredictor : public Predictor {
 public:
    TorchPredictor(const Weights& weights, torch::Device device)
        : m_network(weights.config, device, 0), m_name(weights.solver_name()) {
        m_network.import_weights(weights);
        m_network.use_plain_operations();
    }

    const ModelConfig& config() const override { return m_network.config(); }
    std::string name() const override { return m_name; }

    void predict(const ClothGraph& graph, const Features& features, Points& out) override {
        try {
            torch::NoGradGuard no_grad;
            const torch::Tensor result =
                m_network.forward(graph, features).to(torch::kCPU).contiguous();
            out = Eigen::Map<const MatrixF>(result.data_ptr<float>(), result.size(0), 3)
                      .cast<double>();
        } catch (const std::exception&) {
            // Out of memory, say: the per-frame path reports by numbers, it does not throw.
            out.setConstant(graph.vertex_count, 3, std::numeric_limits<double>::quiet_NaN());
        }
    }

 private:
    Network m_network;
    std::string m_name;
};

}  // namespace

std::unique_ptr<Predictor> make_torch_predictor(const Weights& weights, const std::string& device) {
    if (device != "cpu" && (device != "cuda" || !torch::cuda::is_available()))
        throw ArgumentError("device '" + device + "'", "is not available",
                            "use cpu, or cuda where LibTorch finds a GPU");
    return std::make_unique<TorchPredictor>(weights, torch::Device(device));
}

}  // namespace cloth
