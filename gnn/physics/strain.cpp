#include "gnn/physics/strain.h"

#include <algorithm>

#include "gnn/physics/element_block.h"

namespace cloth {

namespace {

using FaceBlock = ElementBlock<3>;

/// Inverse rest matrices, areas and constants of the faces of one block.
struct FaceConstants {
    const double *inverse00, *inverse01, *inverse11, *area;
    double mu, lambda;
};

/// Energies of `count` faces; with_gradient: their gradients replace the positions.
template <bool with_gradient>
void evaluate(FaceBlock& block, const FaceConstants& constants, int count) {
    auto& x = block.x;
    for (int e = 0; e < count; ++e) {
        const double a = constants.inverse00[e], b = constants.inverse01[e];
        const double c = constants.inverse11[e], area = constants.area[e];
        const double px = x[3][e] - x[0][e], py = x[4][e] - x[1][e], pz = x[5][e] - x[2][e];
        const double qx = x[6][e] - x[0][e], qy = x[7][e] - x[1][e], qz = x[8][e] - x[2][e];
        // Columns of the deformation gradient.
        const double ux = a * px, uy = a * py, uz = a * pz;
        const double vx = b * px + c * qx, vy = b * py + c * qy, vz = b * pz + c * qz;
        const double g00 = 0.5 * (ux * ux + uy * uy + uz * uz - 1.0);
        const double g11 = 0.5 * (vx * vx + vy * vy + vz * vz - 1.0);
        const double g01 = 0.5 * (ux * vx + uy * vy + uz * vz);
        const double trace = g00 + g11;
        block.energy[e] = area * (constants.mu * (g00 * g00 + g11 * g11 + 2.0 * g01 * g01) +
                                  0.5 * constants.lambda * trace * trace);
        if (with_gradient) {
            const double s00 = area * (2.0 * constants.mu * g00 + constants.lambda * trace);
            const double s11 = area * (2.0 * constants.mu * g11 + constants.lambda * trace);
            const double s01 = area * 2.0 * constants.mu * g01;
            // dE/dF = F S, then dE/dDs = dE/dF Dm^-T.
            const double p0 = a * s00 + b * s01, p1 = a * s01 + b * s11;
            const double q0 = c * s01, q1 = c * s11;
            const double g1x = p0 * ux + p1 * vx, g2x = q0 * ux + q1 * vx;
            const double g1y = p0 * uy + p1 * vy, g2y = q0 * uy + q1 * vy;
            const double g1z = p0 * uz + p1 * vz, g2z = q0 * uz + q1 * vz;
            x[0][e] = -(g1x + g2x), x[1][e] = -(g1y + g2y), x[2][e] = -(g1z + g2z);
            x[3][e] = g1x, x[4][e] = g1y, x[5][e] = g1z;
            x[6][e] = g2x, x[7][e] = g2y, x[8][e] = g2z;
        }
    }
}

}  // namespace

StrainEnergy::StrainEnergy(const Garment& garment) : m_garment(&garment) {
    const size_t count = static_cast<size_t>(garment.face_count());
    m_inverse00.resize(count), m_inverse01.resize(count), m_inverse11.resize(count);
    m_area.resize(count);
    const TriMesh& rest = garment.rest();
    for (size_t f = 0; f < count; ++f) {
        const auto face = rest.faces.row(static_cast<Eigen::Index>(f));
        const Vec3 origin = rest.vertices.row(face[0]);
        const Vec3 p = rest.vertices.row(face[1]).transpose() - origin;
        const Vec3 q = rest.vertices.row(face[2]).transpose() - origin;
        const double length = p.norm();
        const double along = p.dot(q) / length;
        const double height = p.cross(q).norm() / length;
        m_inverse00[f] = 1.0 / length;
        m_inverse01[f] = -along / (length * height);
        m_inverse11[f] = 1.0 / height;
        m_area[f] = 0.5 * length * height;
    }
}

template <bool with_gradient>
double StrainEnergy::accumulate(const double* x, double* gradient) const {
    FaceBlock block;
    const int* faces = m_garment->rest().faces.data();
    const int count = static_cast<int>(m_area.size());
    double energy = 0.0;
    for (int first = 0; first < count; first += FaceBlock::size) {
        const int run = std::min(FaceBlock::size, count - first);
        const FaceConstants constants = {&m_inverse00[first],    &m_inverse01[first],
                                         &m_inverse11[first],    &m_area[first],
                                         m_garment->fabric().mu, m_garment->fabric().lambda};
        block.gather(x, faces, first, run);
        evaluate<with_gradient>(block, constants, run);
        if (with_gradient) block.scatter(gradient, faces, first, run);
        energy += block.total_energy(run);
    }
    return energy;
}

double StrainEnergy::value(const Points& x) const {
    return accumulate<false>(x.data(), nullptr);
}

double StrainEnergy::add_gradient(const Points& x, Points& gradient) const {
    return accumulate<true>(x.data(), gradient.data());
}

}  // namespace cloth
