#include "gnn/physics/quasi_newton_matrix.h"

#include <cmath>

namespace cloth {
namespace {

using Triplets = std::vector<Eigen::Triplet<double>>;

double dot(const Points& a, const Points& b) {
    return a.cwiseProduct(b).sum();
}

bool same_fabric(const Fabric& a, const Fabric& b) {
    return a.density == b.density && a.mu == b.mu && a.lambda == b.lambda;
}

// Half the cotangent of the angle at `apex` weighs the edge opposite to it.
void add_corner(const Points& x, int apex, int i, int j, Triplets& triplets) {
    const Vec3 a = x.row(i) - x.row(apex);
    const Vec3 b = x.row(j) - x.row(apex);
    const double weight = 0.5 * a.dot(b) / a.cross(b).norm();
    triplets.emplace_back(i, i, weight);
    triplets.emplace_back(j, j, weight);
    triplets.emplace_back(i, j, -weight);
    triplets.emplace_back(j, i, -weight);
}

}  // namespace

Eigen::SparseMatrix<double> cotangent_laplacian(const TriMesh& rest) {
    Triplets triplets;
    triplets.reserve(static_cast<size_t>(12 * rest.faces.rows()));
    for (Eigen::Index f = 0; f < rest.faces.rows(); ++f) {
        for (int corner = 0; corner < 3; ++corner)
            add_corner(rest.vertices, rest.faces(f, corner), rest.faces(f, (corner + 1) % 3),
                       rest.faces(f, (corner + 2) % 3), triplets);
    }
    Eigen::SparseMatrix<double> laplacian(rest.vertices.rows(), rest.vertices.rows());
    laplacian.setFromTriplets(triplets.begin(), triplets.end());
    return laplacian;
}

QuasiNewtonMatrix::QuasiNewtonMatrix(const Garment& garment)
    : m_vertex_count(garment.vertex_count()), m_pins(garment.pins()) {
    Triplets selection;
    for (int vertex = 0; vertex < m_vertex_count; ++vertex) {
        if (garment.is_pinned()[static_cast<size_t>(vertex)]) continue;
        selection.emplace_back(static_cast<int>(m_free.size()), vertex, 1.0);
        m_free.push_back(vertex);
    }
    Eigen::SparseMatrix<double> select(free_count(), m_vertex_count);
    select.setFromTriplets(selection.begin(), selection.end());
    m_laplacian = select * cotangent_laplacian(garment.rest()) * select.transpose();
    for (Points* array : {&m_residual, &m_preconditioned, &m_direction, &m_product, &m_p_direction})
        array->resize(free_count(), 3);
    m_contacts.reserve(m_free.size());
}

bool QuasiNewtonMatrix::prepare(const Garment& garment, double dt) {
    if (m_dt == dt && same_fabric(m_fabric, garment.fabric())) return true;
    m_dt = 0.0;
    m_matrix = garment.fabric().longitudinal() * m_laplacian;
    for (Eigen::Index row = 0; row < free_count(); ++row)
        m_matrix.coeffRef(row, row) +=
            garment.masses()[m_free[static_cast<size_t>(row)]] / (dt * dt);
    if (free_count() > 0 && !m_factor.factorise(m_matrix)) return false;
    m_fabric = garment.fabric();
    m_dt = dt;
    return true;
}

bool QuasiNewtonMatrix::fits(const Garment& garment) const {
    return garment.vertex_count() == m_vertex_count && garment.pins() == m_pins;
}

void QuasiNewtonMatrix::gather(const Points& all, Points& free) const {
    free.resize(free_count(), 3);
    for (Eigen::Index row = 0; row < free_count(); ++row)
        free.row(row) = all.row(m_free[static_cast<size_t>(row)]);
}

void QuasiNewtonMatrix::scatter(const Points& free, Points& all) const {
    all.setZero(m_vertex_count, 3);
    add_scaled(1.0, free, all);
}

void QuasiNewtonMatrix::add_scaled(double scale, const Points& free, Points& all) const {
    for (Eigen::Index row = 0; row < free_count(); ++row)
        all.row(m_free[static_cast<size_t>(row)]) += scale * free.row(row);
}

bool QuasiNewtonMatrix::set_contacts(const IncrementalPotential& potential, const Points& x) {
    m_contacts.clear();
    const SurfaceContacts& near = potential.contacts();
    const PotentialSettings& settings = potential.settings();
    for (Eigen::Index row = 0; row < free_count(); ++row) {
        const int i = m_free[static_cast<size_t>(row)];
        if (!near.has(i)) continue;
        const Vec3 normal = near.normal1.row(i);
        const double gap = settings.contact_distance - (x.row(i) - near.point1.row(i)).dot(normal);
        if (gap > 0.0)
            m_contacts.push_back(
                {static_cast<int>(row), 6.0 * settings.contact_weight * gap, normal});
    }
    return !m_contacts.empty();
}

void QuasiNewtonMatrix::add_contact_product(const Points& direction, Points& product) const {
    for (const Contact& contact : m_contacts) {
        const double along = direction.row(contact.row).dot(contact.normal);
        product.row(contact.row) += contact.stiffness * along * contact.normal.transpose();
    }
}

void QuasiNewtonMatrix::solve_with_contacts(const Points& b, int iterations, Points& out) {
    m_residual = b;
    solve(m_residual, m_preconditioned);
    m_direction = m_preconditioned;
    // P times the direction follows from the residuals, so that P itself is never multiplied.
    m_p_direction = m_residual;
    double power = dot(m_residual, m_preconditioned);
    out.setZero(b.rows(), 3);
    for (int k = 0; power > 0.0; ++k) {
        m_product = m_p_direction;
        add_contact_product(m_direction, m_product);
        const double step = power / dot(m_direction, m_product);
        out += step * m_direction;
        if (k + 1 >= iterations) break;
        m_residual -= step * m_product;
        solve(m_residual, m_preconditioned);
        const double next_power = dot(m_residual, m_preconditioned);
        const double beta = next_power / power;
        power = next_power;
        m_direction = m_preconditioned + beta * m_direction;
        m_p_direction = m_residual + beta * m_p_direction;
    }
}

}  // namespace cloth
