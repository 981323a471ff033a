#include "gnn/train/optimizer.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace cloth {

using torch::Tensor;

Adam::Adam(std::int64_t count, torch::Device device)
    : m_mean(torch::zeros({count}, torch::kFloat32).to(device)),
      m_square(torch::zeros_like(m_mean)) {
}

double Adam::clip_factor(double clip_norm) {
    double limit = clip_norm;
    if (limit == 0.0) {
        m_norms.push_back(m_last_norm);
        if (m_norms.size() > 100) m_norms.pop_front();
        std::vector<double> sorted(m_norms.begin(), m_norms.end());
        std::nth_element(sorted.begin(), sorted.begin() + sorted.size() / 2, sorted.end());
        limit = 2.0 * sorted[sorted.size() / 2];
    }
    return m_last_norm > limit ? limit / m_last_norm : 1.0;
}

bool Adam::step(Tensor& parameters, Tensor& gradient, double rate, double clip_norm) {
    torch::NoGradGuard no_grad;
    const double beta1 = 0.9, beta2 = clip_norm == 0.0 ? 0.99 : 0.999, epsilon = 1e-8;
    m_last_norm = gradient.norm().item<double>();
    if (!std::isfinite(m_last_norm)) return false;
    gradient.mul_(clip_factor(clip_norm));
    ++m_steps;
    m_mean.mul_(beta1).add_(gradient, 1.0 - beta1);
    m_square.mul_(beta2).addcmul_(gradient, gradient, 1.0 - beta2);
    const double t = static_cast<double>(m_steps);
    const double correction = std::sqrt(1.0 - std::pow(beta2, t)) / (1.0 - std::pow(beta1, t));
    parameters.addcdiv_(m_mean, m_square.sqrt().add_(epsilon), -rate * correction);
    return true;
}

void Adam::save(torch::serialize::OutputArchive& archive) const {
    archive.write("adam.mean", m_mean);
    archive.write("adam.square", m_square);
    archive.write("adam.steps", torch::tensor(m_steps));
    archive.write("adam.norms", torch::tensor(std::vector<double>(m_norms.begin(), m_norms.end()),
                                              torch::kFloat64));
}

void Adam::load(torch::serialize::InputArchive& archive) {
    Tensor mean, square, steps, norms;
    archive.read("adam.mean", mean);
    archive.read("adam.square", square);
    archive.read("adam.steps", steps);
    archive.read("adam.norms", norms);
    m_mean.copy_(mean);
    m_square.copy_(square);
    m_steps = steps.item<std::int64_t>();
    const double* data = norms.data_ptr<double>();
    m_norms.assign(data, data + norms.numel());
}

}  // namespace cloth
