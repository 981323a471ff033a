#include "data/body/amass_motion.h"

#include <cmath>

#include "data/core/errors.h"
#include "data/files/npz_file.h"

namespace cloth {

namespace {

const char* const as_in_amass = "use the file as AMASS has it";

/// The rotation about v by its length (Rodrigues).
Eigen::Quaterniond rotation_by(const Vec3& v) {
    const double angle = v.stableNorm();
    if (angle < 1e-12) return Eigen::Quaterniond::Identity();
    return Eigen::Quaterniond(Eigen::AngleAxisd(angle, v / angle)).normalized();
}

double frame_time_of(const NpzFile& file) {
    const std::string name = file.has("mocap_framerate") ? "mocap_framerate" : "mocap_frame_rate";
    const double rate = file.number(name);
    if (!(rate >= 1.0 && rate <= 10000.0))
        file.fail(name, "is not between 1 and 10000 frames per second", as_in_amass);
    return 1.0 / rate;
}

}  // namespace

AmassMotion AmassMotion::load(const std::string& path) {
    const NpzFile file(path);
    AmassMotion motion;
    motion.frame_time = frame_time_of(file);
    const NpyArray poses = file.numbers("poses", 2), places = file.numbers("trans", 2);
    const auto frames = static_cast<size_t>(poses.shape[0]),
               values = static_cast<size_t>(poses.shape[1]);
    if (frames == 0 || values == 0 || values % 3 != 0)
        file.fail("poses", "is not of three numbers for each joint, or of no frame", as_in_amass);
    if (places.shape[0] != poses.shape[0] || places.shape[1] != 3)
        file.fail("trans", "is not of three numbers for each frame of poses", as_in_amass);
    // z is up there, y is here.
    const Eigen::Quaterniond up(Eigen::AngleAxisd(-M_PI / 2.0, Vec3::UnitX()));
    motion.translations = Eigen::Map<const Points>(places.numbers.data(), places.shape[0], 3) *
                          up.toRotationMatrix().transpose();
    for (size_t frame = 0; frame < frames; ++frame) {
        std::vector<Eigen::Quaterniond> rotations;
        for (size_t j = 0; j < values; j += 3)
            rotations.push_back(
                rotation_by(Eigen::Map<const Vec3>(&poses.numbers[frame * values + j])));
        rotations[0] = (up * rotations[0]).normalized();
        motion.rotations.push_back(std::move(rotations));
    }
    if (file.has("betas")) {
        const NpyArray betas = file.numbers("betas", 1);
        motion.betas = Eigen::Map<const VectorX>(betas.numbers.data(),
                                                 static_cast<Eigen::Index>(betas.numbers.size()));
    }
    if (file.has("gender")) motion.gender = file.text("gender");
    return motion;
}

}  // namespace cloth
