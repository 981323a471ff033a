#include "gnn/train/reference_file.h"

#include <torch/torch.h>

#include <filesystem>

#include "data/core/errors.h"

namespace cloth {

using torch::Tensor;

static Tensor to_tensor(const Points& points) {
    return torch::from_blob(const_cast<double*>(points.data()), {points.rows(), 3}, torch::kFloat64)
        .clone();
}

void save_reference(const std::string& file, const std::vector<Points>& positions,
                    const Points& velocities) {
    std::vector<Tensor> frames;
    frames.reserve(positions.size());
    for (const Points& points : positions) frames.push_back(to_tensor(points));
    torch::serialize::OutputArchive archive;
    archive.write("positions", torch::stack(frames));
    archive.write("velocities", to_tensor(velocities));
    try {
        std::filesystem::create_directories(std::filesystem::path(file).parent_path());
        archive.save_to(file + ".tmp");
        std::filesystem::rename(file + ".tmp", file);
    } catch (const std::exception& error) {
        throw LoadError(file, "", std::string("cannot be written: ") + error.what(),
                        "check free space and permissions");
    }
}

bool load_reference(const std::string& file, Eigen::Index vertices, int frames,
                    std::vector<Points>& positions, Points& velocities) {
    if (!std::filesystem::exists(file)) return false;
    Tensor x, v;
    try {
        torch::serialize::InputArchive archive;
        archive.load_from(file);
        archive.read("positions", x);
        archive.read("velocities", v);
    } catch (const c10::Error&) {
        return false;
    }
    const auto is = [&](const Tensor& tensor, std::vector<std::int64_t> shape) {
        return tensor.scalar_type() == torch::kFloat64 && tensor.sizes() == at::IntArrayRef(shape);
    };
    if (!is(x, {frames + 1, vertices, 3}) || !is(v, {vertices, 3})) return false;
    x = x.contiguous();
    v = v.contiguous();
    positions.clear();
    for (int frame = 0; frame <= frames; ++frame)
        positions.emplace_back(Eigen::Map<const Points>(
            x.data_ptr<double>() + static_cast<std::ptrdiff_t>(frame) * vertices * 3, vertices, 3));
    velocities = Eigen::Map<const Points>(v.data_ptr<double>(), vertices, 3);
    return true;
}

}  // namespace cloth
