#include "gnn/train/skinning_trainer.h"

#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <sstream>

#include "collision/proximity/metrics.h"
#include "data/core/check_range.h"
#include "data/core/errors.h"
#include "data/files/garment_assets.h"
#include "gnn/skinning/skinning_network.h"
#include "gnn/train/checkpoint_file.h"
#include "gnn/train/metrics_file.h"
#include "gnn/train/training_worlds.h"

namespace cloth {

using torch::Tensor;

namespace {

SkinningTrainerSettings checked(SkinningTrainerSettings settings) {
    if (settings.iterations <= 0 && settings.minutes <= 0.0)
        throw ArgumentError("training", "has no end", "give iterations or minutes");
    if (settings.loss == LossKind::both)
        throw ArgumentError("SkinningTrainerSettings.loss", "cannot be both", "use energy or log");
    const auto check = [](const std::string& field, double value, double low, double high) {
        check_range("SkinningTrainerSettings." + field, value, low, high);
    };
    check("sequences", settings.sequences, 1, 64);
    check("frames", settings.frames, 1, 64);
    check("learning_rate", settings.learning_rate, 1e-7, 0.1);
    check("contact_first", settings.contact_first, 1e3, 1e6);
    check("contact_last", settings.contact_last, 1e3, 1e6);
    check("iterations", static_cast<double>(settings.iterations), 0.0, 1e9);
    check("minutes", settings.minutes, 0.0, 1e6);
    check("threads", settings.threads, 1, 256);
    check("report_every", settings.report_every, 1, 1e6);
    check("validate_every", settings.validate_every, 0, 1e6);
    check("save_every", settings.save_every, 0.0, 1e4);
    if (settings.motions.empty()) settings.motions = training_motions();
    std::filesystem::create_directories(settings.out);
    torch::set_num_threads(settings.threads);
    at::globalContext().setFlushDenormal(true);
    return settings;
}

Garment garment_of(const std::string& name) {
    const Garment loaded = load_garment(name);
    return {loaded.name(), loaded.rest(), Fabric::soft_cotton()};
}

SkinningWeights untrained(const SkinningTrainerSettings& settings, const Garment& garment,
                          const std::shared_ptr<const Body>& body) {
    const AnimatedBody animated(body, load_motion_by_name(settings.validation_motion));
    return untrained_skinning(garment, load_garment_start(settings.garment).x, animated,
                              settings.model);
}

std::vector<TensorShape> layer_shapes(const SkinningConfig& config) {
    std::vector<TensorShape> shapes = tensor_shapes(config);
    shapes.erase(std::remove_if(
                     shapes.begin(), shapes.end(),
                     [](const TensorShape& shape) { return shape.first.rfind("layer.", 0) != 0; }),
                 shapes.end());
    return shapes;
}

std::string describe(const SkinningTrainerSettings& settings, const SkinningConfig& config) {
    std::ostringstream text;
    text << config.to_json() << " loss " << static_cast<int>(settings.loss) << " sequences "
         << settings.sequences << " frames " << settings.frames << " rate "
         << settings.learning_rate << " contact " << settings.contact_first << ' '
         << settings.contact_last << " seed " << settings.seed << " motions "
         << settings.motions.size() << " validation " << settings.validate_every << ' '
         << settings.validation_motion;
    return text.str();
}

std::vector<float> to_floats(const VectorX& values) {
    const Eigen::VectorXf floats = values.cast<float>();
    return {floats.data(), floats.data() + floats.size()};
}

void add(const EnergyTerms& terms, double factor, EnergyTerms& sum) {
    sum.strain += factor * terms.strain;
    sum.bending += factor * terms.bending;
    sum.gravity += factor * terms.gravity;
    sum.inertia += factor * terms.inertia;
    sum.contact += factor * terms.contact;
    sum.friction += factor * terms.friction;
}

using PointsF = Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor>;

}  // namespace

SkinningTrainer::SkinningTrainer(SkinningTrainerSettings settings)
    : m_settings(checked(std::move(settings))),
      m_body(std::make_shared<const Body>(Body::load_default())),
      m_garment(std::make_unique<Garment>(garment_of(m_settings.garment))),
      m_weights(untrained(m_settings, *m_garment, m_body)),
      m_skin(m_weights.skin(PoseFeatures(m_weights.config, *m_body).joints())),
      m_worn(m_weights.points("worn")),
      m_parameters(layer_shapes(m_weights.config),
                   "layer." + std::to_string(m_weights.config.layers.size()), torch::kCPU,
                   m_settings.seed),
      m_adam(m_parameters.count(), torch::kCPU),
      m_random(m_settings.seed),
      m_clips(std::make_unique<SkinningClips>(m_body, m_settings.motions, m_weights.config)),
      m_validation(std::make_unique<SkinningClips>(
          m_body, std::vector<std::string>{m_settings.validation_motion}, m_weights.config)),
      m_loss(*m_garment, m_weights.config.dt) {
    SceneRandom random(m_settings.seed);
    m_clips->statistics(random, 4000, m_mean, m_deviation);
    m_weights.tensors["input.mean"].data = to_floats(m_mean);
    m_weights.tensors["input.deviation"].data = to_floats(m_deviation);
}

Tensor SkinningTrainer::forward(const std::vector<VectorX>& features) const {
    const auto rows = static_cast<Eigen::Index>(features.size());
    Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> input(rows,
                                                                                m_mean.size());
    for (Eigen::Index k = 0; k < rows; ++k)
        input.row(k) = ((features[static_cast<size_t>(k)] - m_mean).array() / m_deviation.array())
                           .cast<float>()
                           .max(-SkinningNetwork::most_deviations)
                           .min(SkinningNetwork::most_deviations)
                           .transpose();
    Tensor hidden = torch::from_blob(input.data(), {rows, input.cols()}, torch::kFloat32).clone();
    const size_t last = m_weights.config.layers.size();
    for (size_t k = 0; k <= last; ++k) {
        const std::string layer = "layer." + std::to_string(k);
        hidden = torch::nn::functional::linear(hidden, m_parameters.view(layer + ".weight"),
                                               m_parameters.view(layer + ".bias"));
        if (k < last) hidden = torch::silu(hidden);
    }
    return hidden;
}

/// Where the garment is in each frame of a window (|V| x 3, m).
/// @param outputs  frames x 3 |V|
void SkinningTrainer::pose(const SkinningWindow& window, const float* outputs,
                           std::vector<Points>& x) const {
    x.resize(window.matrices.size());
    for (size_t k = 0; k < x.size(); ++k) {
        const Eigen::Map<const PointsF> output(outputs + k * static_cast<size_t>(3 * m_worn.rows()),
                                               m_worn.rows(), 3);
        x[k] = skin_points(m_worn + m_weights.config.scale * output.cast<double>(), m_skin,
                           window.matrices[k]);
    }
}

/// Losses and their gradients by the outputs of all frames of a window but the first two.
double SkinningTrainer::learn_window(const SkinningWindow& window, const float* outputs,
                                     float* gradient) {
    const double dt = m_weights.config.dt;
    const double share = std::min(1.0, 2.0 * progress());
    const double weight =
        m_settings.contact_first + share * (m_settings.contact_last - m_settings.contact_first);
    const double frames = m_settings.sequences * m_settings.frames;
    std::vector<Points> x;
    pose(window, outputs, x);
    double sum = 0.0;
    LossValue loss;
    for (size_t k = 2; k < x.size(); ++k) {
        const double time = window.first_time + static_cast<double>(k - 1) * dt;
        m_loss.evaluate(m_settings.loss, window.body->obstacle(time, time + dt), weight, x[k - 2],
                        x[k - 1], x[k], loss);
        if (!std::isfinite(loss.value) || !loss.gradient.allFinite()) continue;
        Eigen::Map<PointsF>(gradient + k * static_cast<size_t>(m_worn.size()), m_worn.rows(), 3) =
            (m_weights.config.scale / frames * unskinned(loss.gradient, m_skin, window.matrices[k]))
                .cast<float>();
        sum += loss.value / frames;
        if (k != 2) continue;
        add(m_loss.terms(x[k]), 1.0, m_sum);
        ++m_summed;
    }
    return sum;
}

double SkinningTrainer::iterate() {
    const int frames = m_settings.frames + 2;
    std::vector<SkinningWindow> windows;
    std::vector<VectorX> features;
    for (int k = 0; k < m_settings.sequences; ++k) {
        windows.push_back(m_clips->random_window(m_random, frames));
        features.insert(features.end(), windows.back().features.begin(),
                        windows.back().features.end());
    }
    m_parameters.gradient().zero_();
    const Tensor output = forward(features);
    const Tensor seed = torch::zeros_like(output);
    const std::int64_t stride = frames * output.size(1);
    double loss = 0.0;
    for (int k = 0; k < m_settings.sequences; ++k)
        loss += learn_window(windows[static_cast<size_t>(k)], output.data_ptr<float>() + k * stride,
                             seed.data_ptr<float>() + k * stride);
    output.backward(seed);
    const double rate =
        m_settings.learning_rate * (0.02 + 0.98 * 0.5 * (1.0 + std::cos(M_PI * progress())));
    m_adam.step(m_parameters.flat(), m_parameters.gradient(), rate, 0.0);
    m_loss_sum += loss;
    ++m_losses;
    ++m_iteration;
    return loss;
}

std::vector<Points> SkinningTrainer::displacements(const std::vector<VectorX>& features) {
    const torch::NoGradGuard no_grad;
    const Tensor output = forward(features);
    std::vector<Points> result;
    for (std::int64_t k = 0; k < output.size(0); ++k)
        result.push_back(m_weights.config.scale *
                         Eigen::Map<const PointsF>(output.data_ptr<float>() + k * output.size(1),
                                                   m_worn.rows(), 3)
                             .cast<double>());
    return result;
}

SkinningValidation SkinningTrainer::validate() {
    const torch::NoGradGuard no_grad;
    const double dt = m_weights.config.dt;
    const int count = std::min(120, m_validation->frame_count(0));
    const SkinningWindow window = m_validation->window(0, 0, count);
    const Tensor output = forward(window.features);
    std::vector<Points> x;
    pose(window, output.data_ptr<float>(), x);
    SkinningValidation result;
    LossValue loss;
    Boundary boundary;
    boundary.obstacles.resize(1);
    const double frames = count - 2;
    for (size_t k = 2; k < x.size(); ++k) {
        const double time = window.first_time + static_cast<double>(k - 1) * dt;
        boundary.obstacles[0] = window.body->obstacle(time, time + dt);
        m_loss.evaluate(LossKind::energy, boundary.obstacles[0], m_settings.contact_last, x[k - 2],
                        x[k - 1], x[k], loss);
        result.energy += loss.value / frames;
        add(m_loss.terms(x[k]), 1.0 / frames, result.terms);
        result.stretch = std::max(result.stretch, measure_stretch(*m_garment, x[k]).p99);
        result.inside +=
            measure_penetration(m_proximity, boundary, *m_garment, x[k]).fraction_inside / frames;
    }
    return result;
}

SkinningWeights SkinningTrainer::weights() const {
    SkinningWeights weights = m_weights;
    m_parameters.copy_to(weights.tensors);
    return weights;
}

double SkinningTrainer::progress() const {
    if (m_settings.iterations > 0)
        return static_cast<double>(m_iteration) / static_cast<double>(m_settings.iterations);
    return std::min(1.0, m_seconds / (60.0 * m_settings.minutes));
}

bool SkinningTrainer::is_done() const {
    const bool counted = m_settings.iterations > 0 && m_iteration >= m_settings.iterations;
    const bool timed = m_settings.minutes > 0.0 && m_seconds >= 60.0 * m_settings.minutes;
    return counted || timed;
}

static MetricsFile metrics_of(const std::string& folder) {
    return {folder + "/metrics.csv",
            {"iteration", "minutes", "loss", "strain", "bending", "gravity", "inertia", "contact",
             "friction", "validation_energy", "validation_strain", "validation_bending",
             "validation_inertia", "validation_contact", "validation_stretch_p99",
             "validation_inside"}};
}

void SkinningTrainer::write_row(const SkinningValidation* validation) {
    const double none = std::nan(""), count = std::max(1, m_summed);
    const double loss = m_loss_sum / std::max(1, m_losses);
    const SkinningValidation seen = validation ? *validation : SkinningValidation{};
    const auto known = [&](double value) { return cell(validation ? value : none); };
    metrics_of(m_settings.out)
        .append({cell(m_iteration), cell(m_seconds / 60.0), cell(loss), cell(m_sum.strain / count),
                 cell(m_sum.bending / count), cell(m_sum.gravity / count),
                 cell(m_sum.inertia / count), cell(m_sum.contact / count),
                 cell(m_sum.friction / count), known(seen.energy), known(seen.terms.strain),
                 known(seen.terms.bending), known(seen.terms.inertia), known(seen.terms.contact),
                 known(seen.stretch), known(seen.inside)});
    std::fprintf(stderr, "iteration %lld, %.1f min: loss %.4f\n",
                 static_cast<long long>(m_iteration), m_seconds / 60.0, loss);
    if (validation)
        std::fprintf(stderr, "  %s: energy %.4f J, stretch %.3f, inside %.3f\n",
                     m_settings.validation_motion.c_str(), seen.energy, seen.stretch, seen.inside);
    m_sum = {};
    m_loss_sum = 0.0;
    m_losses = m_summed = 0;
}

void SkinningTrainer::run(const std::atomic<bool>& stop) {
    using Clock = std::chrono::steady_clock;
    metrics_of(m_settings.out).keep_rows_up_to(m_iteration);
    const double before = m_seconds;
    const auto start = Clock::now();
    double saved = m_seconds;
    while (!is_done()) {
        iterate();
        m_seconds = before + std::chrono::duration<double>(Clock::now() - start).count();
        const bool last = is_done();
        const bool validates =
            m_settings.validate_every > 0 && (last || m_iteration % m_settings.validate_every == 0);
        if (validates) {
            const SkinningValidation validation = validate();
            write_row(&validation);
        } else if (m_iteration % m_settings.report_every == 0) {
            write_row(nullptr);
        }
        // Rows are means of the iterations since the last one, which a checkpoint does not hold.
        if (m_losses > 0) continue;
        if (stop) break;
        if (m_seconds - saved < 60.0 * m_settings.save_every) continue;
        save();
        saved = m_seconds;
    }
    save();
}

void SkinningTrainer::save() {
    torch::serialize::OutputArchive archive;
    archive.write("settings", c10::IValue(describe(m_settings, m_weights.config)));
    std::ostringstream random;
    random << m_random.engine();
    archive.write("random", c10::IValue(random.str()));
    archive.write("iteration", torch::tensor(m_iteration));
    archive.write("seconds", torch::tensor(m_seconds, torch::kFloat64));
    archive.write("parameters", m_parameters.flat().detach());
    m_adam.save(archive);
    save_checkpoint(archive, m_settings.out);
    weights().save(m_settings.out + "/weights.safetensors");
}

bool SkinningTrainer::resume() {
    return load_checkpoint(m_settings.out, ProcessGroup(), torch::kCPU,
                           [&](auto& archive, const std::string& file) { load(archive, file); });
}

void SkinningTrainer::load(torch::serialize::InputArchive& archive, const std::string& file) {
    static const std::vector<SettingLabel> labels = {
        {"loss", {"--loss"}},
        {"sequences", {"--sequences"}},
        {"frames", {"--frames"}},
        {"rate", {"--learning-rate"}},
        {"contact", {"first contact weight", "last contact weight"}},
        {"seed", {"--seed"}},
        {"motions", {"number of --motions"}},
        {"validation", {"--validate-every", "--validation-motion"}}};
    check_checkpoint_settings(archive, file, describe(m_settings, m_weights.config), labels);
    c10::IValue random;
    archive.read("random", random);
    std::istringstream(random.toStringRef()) >> m_random.engine();
    Tensor iteration, seconds, parameters;
    archive.read("iteration", iteration);
    archive.read("seconds", seconds);
    archive.read("parameters", parameters);
    const torch::NoGradGuard no_grad;
    m_iteration = iteration.item<std::int64_t>();
    m_seconds = seconds.item<double>();
    m_parameters.flat().copy_(parameters);
    m_adam.load(archive);
}

}  // namespace cloth
