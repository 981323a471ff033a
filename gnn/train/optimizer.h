#pragma once

#include <torch/torch.h>

#include <deque>

namespace cloth {

/// Adam (Kingma and Ba 2015) on one flat tensor, with gradient clipping.
class Adam {
 public:
    Adam(std::int64_t count, torch::Device device);

    /// Clips the gradient to `clip_norm`, or, if that is 0, to twice the running median of the last
    /// norms, then takes one step. A gradient that is not finite changes nothing: false.
    bool step(torch::Tensor& parameters, torch::Tensor& gradient, double rate, double clip_norm);

    double last_norm() const { return m_last_norm; }  ///< before clipping

    void save(torch::serialize::OutputArchive& archive) const;
    void load(torch::serialize::InputArchive& archive);

 private:
    double clip_factor(double clip_norm);

    torch::Tensor m_mean, m_square;
    std::int64_t m_steps = 0;
    std::deque<double> m_norms;
    double m_last_norm = 0.0;
};

}  // namespace cloth
