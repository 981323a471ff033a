#include "gnn/physics/solver/fabric_hessian.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "gnn/physics/energy/bending.h"

namespace cloth {
namespace {

/// A symmetric 2 x 2 matrix without its negative part.
struct Tension {
    double s00, s01, s11;

    void leave_out_compression() {
        const double mean = 0.5 * (s00 + s11);
        const double difference = 0.5 * (s00 - s11);
        const double radius = std::sqrt(difference * difference + s01 * s01);
        if (mean - radius >= 0.0) return;
        const double most = std::max(0.0, mean + radius);
        const double scale = radius > 0.0 ? 0.5 * most / radius : 0.0;
        s00 = scale * (s00 - (mean - radius));
        s11 = scale * (s11 - (mean - radius));
        s01 *= scale;
    }
};

/// Coefficients of the angle of a flat hinge: how far its four corners lift it (1/m).
std::array<double, 4> lift(const Points& rest, const Hinge& hinge) {
    const Vec3 origin = rest.row(hinge[0]);
    const Vec3 e = rest.row(hinge[1]).transpose() - origin;
    const Vec3 a = rest.row(hinge[2]).transpose() - origin;
    const Vec3 b = rest.row(hinge[3]).transpose() - origin;
    const double length = e.norm();
    const double by_a = length / e.cross(a).norm(), by_b = length / e.cross(b).norm();
    const double u = a.dot(e) / e.squaredNorm(), v = b.dot(e) / e.squaredNorm();
    return {(1.0 - u) * by_a + (1.0 - v) * by_b, u * by_a + v * by_b, -by_a, -by_b};
}

}  // namespace

template <class Real>
FabricHessian<Real>::FabricHessian(const Garment& garment, const QuasiNewtonSystem& system)
    : m_fabric(garment.fabric()) {
    add_faces(garment, system.row_of());
    add_bending(garment, system.row_of());
    m_blocks.resize(numbers * m_column.size());
    m_own.resize(numbers * system.free().size());
    m_deformations.resize(m_faces.size());
    m_inertia.resize(system.free().size());
}

template <class Real>
void FabricHessian<Real>::add_faces(const Garment& garment, const std::vector<int>& row_of) {
    const TriMesh& rest = garment.rest();
    const auto rows = static_cast<size_t>(
        std::count_if(row_of.begin(), row_of.end(), [](int row) { return row >= 0; }));
    std::vector<std::vector<int>> columns(rows);
    std::vector<std::vector<Corner>> corners(rows);
    for (Eigen::Index f = 0; f < rest.faces.rows(); ++f) {
        const auto vertices = rest.faces.row(f);
        const RestFace face(rest, f);
        const auto a = static_cast<Real>(face.inverse00), b = static_cast<Real>(face.inverse01);
        const auto c = static_cast<Real>(face.inverse11);
        m_faces.push_back(
            {{vertices[0], vertices[1], vertices[2]}, face, {{-a, -b - c}, {a, b}, {Real(0), c}}});
        for (int i = 0; i < 3; ++i) {
            const int row = row_of[static_cast<size_t>(vertices[i])];
            if (row < 0) continue;
            const int others[2] = {row_of[static_cast<size_t>(vertices[(i + 1) % 3])],
                                   row_of[static_cast<size_t>(vertices[(i + 2) % 3])]};
            for (const int other : others)
                if (other >= 0) columns[static_cast<size_t>(row)].push_back(other);
            corners[static_cast<size_t>(row)].push_back(
                {static_cast<int>(f), i, {others[0], others[1]}});
        }
    }
    m_row_begin.push_back(0);
    m_corner_begin.push_back(0);
    for (size_t row = 0; row < rows; ++row) {
        auto& of_row = columns[row];
        std::sort(of_row.begin(), of_row.end());
        of_row.erase(std::unique(of_row.begin(), of_row.end()), of_row.end());
        const auto place = [&of_row](int column) {
            return column < 0
                       ? column
                       : static_cast<int>(std::lower_bound(of_row.begin(), of_row.end(), column) -
                                          of_row.begin());
        };
        for (Corner& corner : corners[row]) {
            for (int& column : corner.column) column = place(column);
            m_corners.push_back(corner);
        }
        m_corner_begin.push_back(m_corners.size());
        m_column.insert(m_column.end(), of_row.begin(), of_row.end());
        m_row_begin.push_back(m_column.size());
    }
    m_bending.assign(m_column.size(), Real(0));
}

template <class Real>
void FabricHessian<Real>::add_bending(const Garment& garment, const std::vector<int>& row_of) {
    const size_t rows = m_row_begin.size() - 1;
    std::vector<std::map<int, double>> bending(rows);
    m_own_bending.assign(rows, Real(0));
    for (const Hinge& hinge : garment.hinges()) {
        const std::array<double, 4> c = lift(garment.rest().vertices, hinge);
        const double stiffness = hinge_stiffness(garment, hinge);
        for (size_t i = 0; i < 4; ++i)
            for (size_t j = 0; j < 4; ++j) {
                const int row = row_of[static_cast<size_t>(hinge[i])];
                const int column = row_of[static_cast<size_t>(hinge[j])];
                if (row < 0 || i == j) continue;
                const double number = stiffness * c[i] * c[j];
                if (column >= 0)
                    bending[static_cast<size_t>(row)][column] += number;
                else
                    m_own_bending[static_cast<size_t>(row)] -= static_cast<Real>(number);
            }
    }
    m_far_begin.push_back(0);
    for (size_t row = 0; row < rows; ++row) {
        const auto begin = m_column.begin() + static_cast<std::ptrdiff_t>(m_row_begin[row]);
        const auto end = m_column.begin() + static_cast<std::ptrdiff_t>(m_row_begin[row + 1]);
        for (const auto& [column, value] : bending[row]) {
            const auto near = std::lower_bound(begin, end, column);
            if (near != end && *near == column) {
                m_bending[static_cast<size_t>(near - m_column.begin())] = static_cast<Real>(value);
            } else {
                m_far_column.push_back(column);
                m_far_bending.push_back(static_cast<Real>(value));
            }
        }
        m_far_begin.push_back(m_far_column.size());
    }
}

template <class Real>
void FabricHessian<Real>::begin_step(const QuasiNewtonSystem& system, double dt) {
    for (size_t row = 0; row < m_inertia.size(); ++row)
        m_inertia[row] =
            static_cast<Real>(system.masses()[static_cast<Eigen::Index>(row)] / (dt * dt));
}

template <class Real>
void FabricHessian<Real>::linearise_faces(size_t half, const Points& x) {
    const size_t middle = m_faces.size() / 2;
    const size_t end = half == 0 ? middle : m_faces.size();
    const auto at = [&x](int vertex) {
        const double* const p = x.data() + 3 * vertex;
        return DoubleLanes{p[0], p[1], p[2], 0.0};
    };
    for (size_t f = half == 0 ? 0 : middle; f < end; ++f) {
        const Face& face = m_faces[f];
        const DoubleLanes origin = at(face.corner[0]);
        const DoubleLanes p = at(face.corner[1]) - origin, q = at(face.corner[2]) - origin;
        const DoubleLanes u = face.rest.inverse00 * p;
        const DoubleLanes v = face.rest.inverse01 * p + face.rest.inverse11 * q;
        const double g00 = 0.5 * (sum(DoubleLanes(u * u)) - 1.0);
        const double g11 = 0.5 * (sum(DoubleLanes(v * v)) - 1.0);
        const double trace = m_fabric.lambda * (g00 + g11);
        Tension tension{2.0 * m_fabric.mu * g00 + trace, m_fabric.mu * sum(DoubleLanes(u * v)),
                        2.0 * m_fabric.mu * g11 + trace};
        tension.leave_out_compression();
        m_deformations[f] = {__builtin_convertvector(u, Lanes<Real>),
                             __builtin_convertvector(v, Lanes<Real>), Real(tension.s00),
                             Real(tension.s01), Real(tension.s11)};
    }
}

/// That of corners i and j of a face: minus the forces on i where j moves.
template <class Real>
void FabricHessian<Real>::add_block(const Face& face, const Deformation& at, int i, int j,
                                    Real sign, Real* block) const {
    const Real area = sign * static_cast<Real>(face.rest.area);
    const Real mu = area * static_cast<Real>(m_fabric.mu);
    const Real lambda = area * static_cast<Real>(m_fabric.lambda);
    const Real* const g = face.gradient[i];
    const Real* const h = face.gradient[j];
    const Real g0h0 = g[0] * h[0], g0h1 = g[0] * h[1], g1h0 = g[1] * h[0], g1h1 = g[1] * h[1];
    const Real uu = (2 * mu + lambda) * g0h0 + mu * g1h1;
    const Real vv = (2 * mu + lambda) * g1h1 + mu * g0h0;
    const Real uv = lambda * g0h1 + mu * g1h0, vu = lambda * g1h0 + mu * g0h1;
    const Real pull = area * (at.s00 * g0h0 + at.s11 * g1h1 + at.s01 * (g0h1 + g1h0));
    const Lanes<Real> by_u = uu * at.u + vu * at.v, by_v = uv * at.u + vv * at.v;
    const Lanes<Real> x = {pull, 0, 0, 0}, y = {0, pull, 0, 0}, z = {0, 0, pull, 0};
    store<Real>(block, load(block) + at.u[0] * by_u + at.v[0] * by_v + x);
    store<Real>(block + 4, load(block + 4) + at.u[1] * by_u + at.v[1] * by_v + y);
    store<Real>(block + 8, load(block + 8) + at.u[2] * by_u + at.v[2] * by_v + z);
}

template <class Real>
void FabricHessian<Real>::linearise_row(size_t row) {
    const auto set = [](Real* block, Real value) {
        store<Real>(block, Lanes<Real>{value, 0, 0, 0});
        store<Real>(block + 4, Lanes<Real>{0, value, 0, 0});
        store<Real>(block + 8, Lanes<Real>{0, 0, value, 0});
    };
    const size_t begin = m_row_begin[row];
    Real* const own = m_own.data() + numbers * row;
    set(own, m_inertia[row] + m_own_bending[row]);
    for (size_t c = begin; c < m_row_begin[row + 1]; ++c)
        set(m_blocks.data() + numbers * c, m_bending[c]);
    for (size_t k = m_corner_begin[row]; k < m_corner_begin[row + 1]; ++k) {
        const Corner& corner = m_corners[k];
        const Face& face = m_faces[static_cast<size_t>(corner.face)];
        const Deformation& at = m_deformations[static_cast<size_t>(corner.face)];
        for (int other = 0; other < 2; ++other) {
            const int column = corner.column[other], j = (corner.first + 1 + other) % 3;
            if (column < 0)
                add_block(face, at, corner.first, j, Real(-1), own);
            else
                add_block(face, at, corner.first, j, Real(1),
                          m_blocks.data() + numbers * (begin + static_cast<size_t>(column)));
        }
    }
}

template <class Real>
Lanes<Real> FabricHessian<Real>::product(size_t row, const Real* direction) const {
    const auto times = [](const Real* block, const Lanes<Real>& d) -> Lanes<Real> {
        return load(block) * d[0] + load(block + 4) * d[1] + load(block + 8) * d[2];
    };
    const Lanes<Real> own = load(direction + 4 * row);
    Lanes<Real> sum = times(m_own.data() + numbers * row, own);
    for (size_t c = m_row_begin[row]; c < m_row_begin[row + 1]; ++c) {
        const Lanes<Real> relative = load(direction + 4 * m_column[c]) - own;
        sum += times(m_blocks.data() + numbers * c, relative);
    }
    for (size_t c = m_far_begin[row]; c < m_far_begin[row + 1]; ++c)
        sum += m_far_bending[c] * (load(direction + 4 * m_far_column[c]) - own);
    return sum;
}

template class FabricHessian<float>;
template class FabricHessian<double>;

}  // namespace cloth
