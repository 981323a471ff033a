#include "gnn/physics/energy/strain.h"

#include <algorithm>
#include <cmath>

#include "gnn/physics/energy/element_block.h"

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

RestFace::RestFace(const TriMesh& rest, Eigen::Index face) {
    const auto corners = rest.faces.row(face);
    const Vec3 origin = rest.vertices.row(corners[0]);
    const Vec3 p = rest.vertices.row(corners[1]).transpose() - origin;
    const Vec3 q = rest.vertices.row(corners[2]).transpose() - origin;
    const double length = p.norm();
    const double along = p.dot(q) / length;
    const double height = p.cross(q).norm() / length;
    inverse00 = 1.0 / length;
    inverse01 = -along / (length * height);
    inverse11 = 1.0 / height;
    area = 0.5 * length * height;
}

StrainEnergy::StrainEnergy(const Garment& garment) : m_garment(&garment) {
    const size_t count = static_cast<size_t>(garment.face_count());
    m_inverse00.resize(count), m_inverse01.resize(count), m_inverse11.resize(count);
    m_area.resize(count);
    for (size_t f = 0; f < count; ++f) {
        const RestFace face(garment.rest(), static_cast<Eigen::Index>(f));
        m_inverse00[f] = face.inverse00;
        m_inverse01[f] = face.inverse01;
        m_inverse11[f] = face.inverse11;
        m_area[f] = face.area;
    }
}

template <bool with_gradient>
double StrainEnergy::accumulate(const double* x, int begin, int end, double* gradient) const {
    FaceBlock block;
    const int* faces = m_garment->rest().faces.data();
    double energy = 0.0;
    for (int first = begin; first < end; first += FaceBlock::size) {
        const int run = std::min(FaceBlock::size, end - first);
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
    return accumulate<false>(x.data(), 0, count(), nullptr);
}

double StrainEnergy::add_gradient(const Points& x, Points& gradient) const {
    return accumulate<true>(x.data(), 0, count(), gradient.data());
}

double StrainEnergy::add_gradient(const Points& x, int part, int parts, Points& gradient) const {
    return accumulate<true>(x.data(), FaceBlock::begin_of(part, parts, count()),
                            FaceBlock::begin_of(part + 1, parts, count()), gradient.data());
}

namespace {

/// A deformation gradient F (3 x 2) in its own axes: F = sigma0 u0 v0^T + sigma1 u1 v1^T.
struct Axes {
    Eigen::Matrix3d u;  ///< columns u0, u1 and the normal
    Eigen::Matrix2d v;  ///< columns v0, v1
    Eigen::Vector2d sigma;
};

/// Left axes of F v; where F collapses, any that complete an orthonormal frame.
Eigen::Matrix3d left_axes(const Vec3& p, const Vec3& q) {
    const double tiny = 1e-12;
    Eigen::Matrix3d u;
    u.col(0) = p.norm() > tiny ? Vec3(p.normalized()) : Vec3(Vec3::UnitX());
    const Vec3 rest = q - u.col(0).dot(q) * u.col(0);
    u.col(1) = rest.norm() > tiny ? Vec3(rest.normalized()) : u.col(0).unitOrthogonal();
    u.col(2) = u.col(0).cross(u.col(1));
    return u;
}

/// Singular values by the eigenvectors of the symmetric 2 x 2 matrix F^T F, larger value first.
Axes principal_axes(const Eigen::Matrix<double, 3, 2>& f) {
    const Eigen::Matrix2d c = f.transpose() * f;
    const double angle = 0.5 * std::atan2(2.0 * c(0, 1), c(0, 0) - c(1, 1));
    Axes axes;
    axes.v << std::cos(angle), -std::sin(angle), std::sin(angle), std::cos(angle);
    const Eigen::Matrix<double, 3, 2> fv = f * axes.v;
    axes.u = left_axes(fv.col(0), fv.col(1));
    axes.sigma << fv.col(0).norm(), fv.col(1).norm();
    return axes;
}

/// The Hessian of the energy density with respect to F (N/m), diagonal but for the stretches when
/// written in the principal axes.
struct PrincipalStiffness {
    Eigen::Matrix2d stretch;  ///< of sigma0 and sigma1
    double twist, flip;       ///< of (u1 v0 - u0 v1) / sqrt 2 and (u1 v0 + u0 v1) / sqrt 2
    Eigen::Vector2d bend;     ///< of n v0 and n v1: the second Piola-Kirchhoff stress

    void project();
};

void PrincipalStiffness::project() {
    twist = std::max(0.0, twist);
    flip = std::max(0.0, flip);
    bend = bend.cwiseMax(0.0);
    const double mean = 0.5 * (stretch(0, 0) + stretch(1, 1));
    const double half = 0.5 * (stretch(0, 0) - stretch(1, 1));
    const double radius = std::hypot(half, stretch(0, 1));
    if (mean - radius >= 0.0) return;
    // Only the larger eigenvalue stays: lambda w w^T with w along (half + radius, stretch01).
    Eigen::Vector2d w(half + radius, stretch(0, 1));
    if (w.squaredNorm() < 1e-20 * radius * radius) w = Eigen::Vector2d(0.0, 1.0);
    w.normalize();
    stretch = std::max(0.0, mean + radius) * w * w.transpose();
}

/// For stresses s_i = 2 mu g_i + lambda (g_0 + g_1), g_i = (sigma_i^2 - 1) / 2, the eigenvalues
/// (sigma_0 s_0 +- sigma_1 s_1) / (sigma_0 +- sigma_1) need no division.
PrincipalStiffness principal_stiffness(const Eigen::Vector2d& sigma, const Fabric& fabric) {
    const double g0 = 0.5 * (sigma[0] * sigma[0] - 1.0), g1 = 0.5 * (sigma[1] * sigma[1] - 1.0);
    const double s0 = 2.0 * fabric.mu * g0 + fabric.lambda * (g0 + g1);
    const double s1 = 2.0 * fabric.mu * g1 + fabric.lambda * (g0 + g1);
    const double longitudinal = fabric.longitudinal();
    const double coupling = fabric.lambda * sigma[0] * sigma[1];
    PrincipalStiffness h;
    h.stretch << s0 + longitudinal * sigma[0] * sigma[0], coupling, coupling,
        s1 + longitudinal * sigma[1] * sigma[1];
    h.twist = 0.5 * (s0 + s1) + 0.5 * fabric.mu * std::pow(sigma[0] - sigma[1], 2);
    h.flip = 0.5 * (s0 + s1) + 0.5 * fabric.mu * std::pow(sigma[0] + sigma[1], 2);
    h.bend << s0, s1;
    return h;
}

/// Block of two corners whose shape functions have the gradients p and q in the axes v (1/m).
Eigen::Matrix3d corner_block(const PrincipalStiffness& h, const Eigen::Vector2d& p,
                             const Eigen::Vector2d& q) {
    const double sum = 0.5 * (h.flip + h.twist), difference = 0.5 * (h.flip - h.twist);
    Eigen::Matrix3d block = Eigen::Matrix3d::Zero();
    block(0, 0) = h.stretch(0, 0) * p[0] * q[0] + sum * p[1] * q[1];
    block(1, 1) = h.stretch(1, 1) * p[1] * q[1] + sum * p[0] * q[0];
    block(0, 1) = h.stretch(0, 1) * p[0] * q[1] + difference * p[1] * q[0];
    block(1, 0) = h.stretch(0, 1) * p[1] * q[0] + difference * p[0] * q[1];
    block(2, 2) = h.bend[0] * p[0] * q[0] + h.bend[1] * p[1] * q[1];
    return block;
}

}  // namespace

void StrainEnergy::add_hessian(const Points& x, const BlockPattern& pattern, HessianKind kind,
                               double* values) const {
    for (size_t f = 0; f < m_area.size(); ++f) {
        const auto face = m_garment->rest().faces.row(static_cast<Eigen::Index>(f));
        Eigen::Matrix<double, 3, 2> ds;
        ds << (x.row(face[1]) - x.row(face[0])).transpose(),
            (x.row(face[2]) - x.row(face[0])).transpose();
        Eigen::Matrix2d inverse;
        inverse << m_inverse00[f], m_inverse01[f], 0.0, m_inverse11[f];
        const Axes axes = principal_axes(ds * inverse);
        PrincipalStiffness stiffness = principal_stiffness(axes.sigma, m_garment->fabric());
        if (kind == HessianKind::projected) stiffness.project();
        Eigen::Matrix<double, 2, 3> shape;  // gradients of the corners' shape functions
        shape.rightCols<2>() = axes.v.transpose() * inverse.transpose();
        shape.col(0) = -shape.col(1) - shape.col(2);
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j)
                add_block(values, pattern.face(f)[static_cast<size_t>(3 * i + j)],
                          m_area[f] * axes.u * corner_block(stiffness, shape.col(i), shape.col(j)) *
                              axes.u.transpose());
    }
}

}  // namespace cloth
