#include "gnn/train/reference_fingerprint.h"

namespace cloth {

namespace {

/// FNV-1a over the bytes of numbers.
class Fingerprint {
 public:
    template <typename Derived>
    void add(const Eigen::PlainObjectBase<Derived>& numbers) {
        add_bytes(numbers.data(),
                  sizeof(typename Derived::Scalar) * static_cast<size_t>(numbers.size()));
    }
    void add(double number) { add_bytes(&number, sizeof number); }
    void add(const std::vector<int>& numbers) {
        add_bytes(numbers.data(), sizeof(int) * numbers.size());
    }
    void add(const Pose& pose) { add(Eigen::Matrix<double, 3, 4>(pose.affine())); }

    std::uint64_t value() const { return m_hash; }

 private:
    void add_bytes(const void* data, size_t bytes) {
        for (size_t i = 0; i < bytes; ++i)
            m_hash = (m_hash ^ static_cast<const unsigned char*>(data)[i]) * 1099511628211ull;
    }

    std::uint64_t m_hash = 14695981039346656037ull;
};

void add_obstacle(const Obstacle& obstacle, bool is_first, Fingerprint& print) {
    if (is_first) {
        if (obstacle.faces) print.add(*obstacle.faces);
        print.add(static_cast<double>(obstacle.shape));
        print.add(obstacle.half_extents);
        print.add(obstacle.radius);
        print.add(obstacle.friction);
        print.add(obstacle.x0);
        print.add(obstacle.pose0);
    }
    print.add(obstacle.x1);
    print.add(obstacle.pose1);
}

}  // namespace

std::uint64_t reference_fingerprint(const TrainingScene& scene, int frames) {
    Fingerprint print;
    const Garment& garment = scene.garment();
    const ClothState& start = scene.parts().start;
    print.add(garment.rest().vertices);
    print.add(garment.rest().faces);
    print.add(garment.pins());
    print.add(start.x);
    print.add(start.v);
    const Fabric& fabric = garment.fabric();
    for (const double value :
         {fabric.density, fabric.mu, fabric.lambda, fabric.bending, scene.dt()})
        print.add(value);
    Boundary boundary;
    for (int frame = 0; frame < frames; ++frame) {
        scene.parts().world->boundary(start.time + frame * scene.dt(), scene.dt(), boundary);
        for (const Obstacle& obstacle : boundary.obstacles)
            add_obstacle(obstacle, frame == 0, print);
        print.add(boundary.pin_targets);
        print.add(boundary.gravity);
        print.add(boundary.accelerations);
    }
    return print.value();
}

}  // namespace cloth
