#include "gnn/physics/energy/bending.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "gnn/physics/energy/angle.h"
#include "gnn/physics/energy/element_block.h"

namespace cloth {

namespace {

using HingeBlock = ElementBlock<4>;

/// Constants of the hinges of one block.
struct HingeConstants {
    const double *stiffness, *rest_angle;
    double min_normal, min_edge;
};

/// Energies of `count` hinges; with_gradient: their gradients replace the positions.
/// n0 = e x a and n1 = b x e are the area vectors of the two faces; (n0 x n1) . e = -|e|^2 (n0 .
/// b).
template <bool with_gradient>
void evaluate(HingeBlock& block, const HingeConstants& constants, int count) {
    auto& x = block.x;
    for (int h = 0; h < count; ++h) {
        const double ex = x[3][h] - x[0][h], ey = x[4][h] - x[1][h], ez = x[5][h] - x[2][h];
        const double ax = x[6][h] - x[0][h], ay = x[7][h] - x[1][h], az = x[8][h] - x[2][h];
        const double bx = x[9][h] - x[0][h], by = x[10][h] - x[1][h], bz = x[11][h] - x[2][h];
        const double mx = ey * az - ez * ay, my = ez * ax - ex * az, mz = ex * ay - ey * ax;
        const double nx = by * ez - bz * ey, ny = bz * ex - bx * ez, nz = bx * ey - by * ex;
        const double squared = std::max(ex * ex + ey * ey + ez * ez, constants.min_edge);
        const double length = std::sqrt(squared);
        const double sine = -length * (mx * bx + my * by + mz * bz);
        const double cosine = mx * nx + my * ny + mz * nz;
        const double angle = wrap_angle(fast_atan2(sine, cosine) - constants.rest_angle[h]);
        const double moment = constants.stiffness[h] * angle;
        block.energy[h] = 0.5 * moment * angle;
        if (with_gradient) {
            const double scale = moment * length;
            const double p = scale / std::max(mx * mx + my * my + mz * mz, constants.min_normal);
            const double q = scale / std::max(nx * nx + ny * ny + nz * nz, constants.min_normal);
            const double u = (ax * ex + ay * ey + az * ez) / squared;
            const double v = (bx * ex + by * ey + bz * ez) / squared;
            const double p0 = p * (1.0 - u), q0 = q * (1.0 - v), p1 = p * u, q1 = q * v;
            x[0][h] = p0 * mx + q0 * nx, x[1][h] = p0 * my + q0 * ny, x[2][h] = p0 * mz + q0 * nz;
            x[3][h] = p1 * mx + q1 * nx, x[4][h] = p1 * my + q1 * ny, x[5][h] = p1 * mz + q1 * nz;
            x[6][h] = -p * mx, x[7][h] = -p * my, x[8][h] = -p * mz;
            x[9][h] = -q * nx, x[10][h] = -q * ny, x[11][h] = -q * nz;
        }
    }
}

}  // namespace

double hinge_stiffness(const Garment& garment, const Hinge& hinge) {
    const Points& rest = garment.rest().vertices;
    const Vec3 origin = rest.row(hinge[0]);
    const Vec3 e = rest.row(hinge[1]).transpose() - origin;
    const double doubled_areas = e.cross(rest.row(hinge[2]).transpose() - origin).norm() +
                                 e.cross(rest.row(hinge[3]).transpose() - origin).norm();
    return garment.fabric().bending * e.squaredNorm() / (2.0 * doubled_areas);
}

BendingEnergy::BendingEnergy(const Garment& garment) : m_garment(&garment) {
    double edge = garment.mean_edge_length(), area = garment.face_areas().mean();
    m_min_edge = 1e-8 * edge * edge;
    m_min_normal = 1e-8 * area * area;
    m_stiffness.reserve(garment.hinges().size());
    for (const Hinge& hinge : garment.hinges())
        m_stiffness.push_back(hinge_stiffness(garment, hinge));
}

template <bool with_gradient>
double BendingEnergy::accumulate(const double* x, int begin, int end, double* gradient) const {
    if (m_stiffness.empty()) return 0.0;
    HingeBlock block;
    const int* hinges = m_garment->hinges().front().data();
    double energy = 0.0;
    for (int first = begin; first < end; first += HingeBlock::size) {
        const int run = std::min(HingeBlock::size, end - first);
        const HingeConstants constants = {
            &m_stiffness[first], &m_garment->hinge_rest_angles()[first], m_min_normal, m_min_edge};
        block.gather(x, hinges, first, run);
        evaluate<with_gradient>(block, constants, run);
        if (with_gradient) block.scatter(gradient, hinges, first, run);
        energy += block.total_energy(run);
    }
    return energy;
}

double BendingEnergy::value(const Points& x) const {
    return accumulate<false>(x.data(), 0, count(), nullptr);
}

double BendingEnergy::add_gradient(const Points& x, Points& gradient) const {
    return accumulate<true>(x.data(), 0, count(), gradient.data());
}

double BendingEnergy::add_gradient(const Points& x, int part, int parts, Points& gradient) const {
    return accumulate<true>(x.data(), HingeBlock::begin_of(part, parts, count()),
                            HingeBlock::begin_of(part + 1, parts, count()), gradient.data());
}

namespace {

using Block = Eigen::Matrix3d;

Block cross_matrix(const Vec3& v) {
    Block m;
    m << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
    return m;
}

/// One wing of a hinge: the face spanned by the edge e and the arm a to its opposite corner. The
/// angle's gradient with respect to a is -w, and `u` of the moment w goes to the far end of e.
struct Wing {
    Vec3 w;        ///< |e| n / |n|^2 (1/m), n the area vector
    double u;      ///< a . e / |e|^2
    Block w_by_e;  ///< dw/de (1/m^2)
    Block w_by_a;  ///< dw/da (1/m^2)
    Vec3 u_by_e;   ///< du/de (1/m)

    /// @param side  1 where n = e x a, -1 where n = a x e
    Wing(const Vec3& e, const Vec3& a, double side, double min_edge, double min_normal) {
        const Vec3 n = side * e.cross(a);
        const double edge = std::max(e.squaredNorm(), min_edge), length = std::sqrt(edge);
        const double normal = std::max(n.squaredNorm(), min_normal);
        const Block reflection =
            (Block::Identity() - 2.0 * n * n.transpose() / normal) * (side * length / normal);
        w = length / normal * n;
        u = a.dot(e) / edge;
        w_by_e = n * e.transpose() / (length * normal) - reflection * cross_matrix(a);
        w_by_a = reflection * cross_matrix(e);
        u_by_e = (a - 2.0 * u * e) / edge;
    }
};

/// First and second derivative of a hinge's angle with respect to the edge e, the arm a and the arm
/// b, all seen from corner 0 (9 numbers): grad = (u_a w_a + u_b w_b, -w_a, -w_b).
struct AngleDerivatives {
    Eigen::Matrix<double, 9, 1> gradient;
    Eigen::Matrix<double, 9, 9> hessian;

    AngleDerivatives(const Wing& a, const Wing& b) {
        gradient << a.u * a.w + b.u * b.w, -a.w, -b.w;
        hessian.setZero();
        hessian.block<3, 3>(0, 0) = a.w * a.u_by_e.transpose() + a.u * a.w_by_e +
                                    b.w * b.u_by_e.transpose() + b.u * b.w_by_e;
        hessian.block<3, 3>(3, 0) = -a.w_by_e;
        hessian.block<3, 3>(6, 0) = -b.w_by_e;
        hessian.block<3, 3>(0, 3) = -a.w_by_e.transpose();
        hessian.block<3, 3>(0, 6) = -b.w_by_e.transpose();
        hessian.block<3, 3>(3, 3) = -a.w_by_a;
        hessian.block<3, 3>(6, 6) = -b.w_by_a;
    }
};

/// Adds a Hessian in e, a, b to the corners: corner 0 moves all three the other way.
void add_hinge(const Eigen::Matrix<double, 9, 9>& h, const std::array<BlockSlot, 16>& slots,
               double* values) {
    Block row_sum[3], column_sum[3], total = Block::Zero();
    for (int i = 0; i < 3; ++i) {
        row_sum[i] = h.block<3, 3>(3 * i, 0) + h.block<3, 3>(3 * i, 3) + h.block<3, 3>(3 * i, 6);
        column_sum[i] = h.block<3, 3>(0, 3 * i) + h.block<3, 3>(3, 3 * i) + h.block<3, 3>(6, 3 * i);
        total += row_sum[i];
    }
    add_block(values, slots[0], total);
    for (int i = 0; i < 3; ++i) {
        add_block(values, slots[static_cast<size_t>(4 * (i + 1))], -row_sum[i]);
        add_block(values, slots[static_cast<size_t>(i + 1)], -column_sum[i]);
        for (int j = 0; j < 3; ++j)
            add_block(values, slots[static_cast<size_t>(4 * (i + 1) + j + 1)],
                      h.block<3, 3>(3 * i, 3 * j));
    }
}

}  // namespace

void BendingEnergy::add_hessian(const Points& x, const BlockPattern& pattern, HessianKind kind,
                                double* values) const {
    for (size_t h = 0; h < m_stiffness.size(); ++h) {
        const Hinge& hinge = m_garment->hinges()[h];
        const Vec3 origin = x.row(hinge[0]);
        const Vec3 e = x.row(hinge[1]).transpose() - origin;
        const Vec3 a = x.row(hinge[2]).transpose() - origin;
        const Vec3 b = x.row(hinge[3]).transpose() - origin;
        const AngleDerivatives angle(Wing(e, a, 1.0, m_min_edge, m_min_normal),
                                     Wing(e, b, -1.0, m_min_edge, m_min_normal));
        Eigen::Matrix<double, 9, 9> hessian =
            m_stiffness[h] * angle.gradient * angle.gradient.transpose();
        if (kind == HessianKind::exact) {
            const double rest = m_garment->hinge_rest_angles()[static_cast<Eigen::Index>(h)];
            hessian += m_stiffness[h] * wrap_angle(dihedral_angle(x, hinge) - rest) * angle.hessian;
        }
        add_hinge(hessian, pattern.hinge(h), values);
    }
}

}  // namespace cloth
