#include "gnn/physics/solver/contact_product.h"

#include <algorithm>

namespace cloth {
namespace {

constexpr int fields_count = AffineFields::count;

/// The entries of a symmetric matrix of directions and one of fields, from the upper triangles.
constexpr int direction_pairs[6][2] = {{0, 0}, {0, 1}, {0, 2}, {1, 1}, {1, 2}, {2, 2}};
constexpr int directions = 6, field_pairs = fields_count * (fields_count + 1) / 2;

/// F' blocks F: for each pair of fields, and of directions, what four lanes add up to.
struct FieldStiffness {
    DoubleLanes of[field_pairs][directions] = {};

    void add(const DoubleLanes (&fields)[fields_count],
             const DoubleLanes (&stiffness)[directions]) {
        int pair = 0;
        for (int i = 0; i < fields_count; ++i)
            for (int j = i; j < fields_count; ++j, ++pair) {
                const DoubleLanes product = fields[i] * fields[j];
                for (int d = 0; d < directions; ++d) of[pair][d] += product * stiffness[d];
            }
    }
    void add_to(AffineFields::System& system) const {
        for (int d = 0; d < directions; ++d) {
            AffineFields::Weights weights;
            int pair = 0;
            for (int i = 0; i < fields_count; ++i)
                for (int j = i; j < fields_count; ++j, ++pair)
                    weights(i, j) = weights(j, i) = sum(of[pair][d]);
            const auto [row, column] = direction_pairs[d];
            AffineFields::add(weights, row, column, system);
            if (row != column) AffineFields::add(weights, column, row, system);
        }
    }
};

template <class Real>
DoubleLanes wide(const Real* p) {
    return widened(load(p));
}

template <class Real>
void add_to_row(const DoubleLanes& force, Real* row) {
    store<Real>(row, __builtin_convertvector(wide(row) + force, Lanes<Real>));
}

}  // namespace

template <class Real>
void ContactProduct<Real>::take(const ContactHessian& contacts,
                                const std::vector<unsigned char>& part_of, const Real* fields) {
    m_fields = fields;
    take_blocks(contacts, part_of);
    take_couplings(contacts);
    find_touches(part_of.size());
}

template <class Real>
void ContactProduct<Real>::take_blocks(const ContactHessian& contacts,
                                       const std::vector<unsigned char>& part_of) {
    for (auto& blocks : m_blocks) {
        blocks.clear();
        blocks.reserve(std::max(part_of.size(), contacts.blocks().size()));
    }
    for (const auto& [row, s] : contacts.blocks())
        m_blocks[part_of[static_cast<size_t>(row)]].push_back(
            {row, {{s.xx, s.xy, s.xz, 0.0}, {s.xy, s.yy, s.yz, 0.0}, {s.xz, s.yz, s.zz, 0.0}}});
}

template <class Real>
void ContactProduct<Real>::take_couplings(const ContactHessian& contacts) {
    const size_t most = (contacts.most_couplings() + width - 1) / width;
    m_fours.reserve(most);
    m_steps.reserve(most);
    m_motions.reserve(most);
    m_forces.reserve(4 * width * most);
    m_touches.reserve(4 * width * most);
    m_count = 0;
    m_fours.clear();
    contacts.for_each_coupling([&](const ContactHessian::Coupling& coupling) { put(coupling); });
    m_steps.resize(m_fours.size());
    m_motions.resize(m_fours.size());
    m_forces.resize(4 * width * m_fours.size());
}

template <class Real>
void ContactProduct<Real>::put(const ContactHessian::Coupling& coupling) {
    const size_t lane = m_count++ % width;
    if (lane == 0) m_fours.push_back({});
    Four& four = m_fours.back();
    for (size_t k = 0; k < 4; ++k) {
        four.row[k][lane] = coupling.row[k];
        four.weight[k][lane] = static_cast<Real>(coupling.weight[k]);
    }
    for (int k = 0; k < 3; ++k) four.normal[k][lane] = static_cast<Real>(coupling.normal[k]);
    four.along[lane] = static_cast<Real>(coupling.along);
    four.across[lane] = static_cast<Real>(coupling.across);
    if (!m_fields) return;
    DoubleLanes field = {};
    for (size_t k = 0; k < 4; ++k)
        field += coupling.weight[k] * wide(m_fields + 4 * static_cast<size_t>(coupling.row[k]));
    for (size_t k = 0; k < fields_count; ++k) four.field[k][lane] = static_cast<Real>(field[k]);
}

/// Sorts them by row, by counting.
template <class Real>
void ContactProduct<Real>::find_touches(size_t rows) {
    const auto for_each_touch = [&](const auto& visit) {
        for (size_t k = 0; k < m_count; ++k) {
            const Four& four = m_fours[k / width];
            const size_t lane = k % width;
            for (size_t corner = 0; corner < 4; ++corner)
                if (const Real weight = four.weight[corner][lane]; weight != Real(0))
                    visit(static_cast<size_t>(four.row[corner][lane]),
                          Touch{static_cast<int>(k), weight});
        }
    };
    m_begin.assign(rows + 1, 0);
    for_each_touch([&](size_t row, const Touch&) { ++m_begin[row]; });
    int end = 0;
    for (int& begin : m_begin) begin = end += begin;
    m_touches.resize(static_cast<size_t>(end));
    for_each_touch([&](size_t row, const Touch& touch) {
        m_touches[static_cast<size_t>(--m_begin[row])] = touch;
    });
}

/// The halves share the couplings, the top has none.
template <class Real>
size_t ContactProduct<Real>::first(size_t part) const {
    return part < Crew::top ? part * m_fours.size() / Crew::top : m_fours.size();
}

template <class Real>
void ContactProduct<Real>::add_to(size_t part, AffineFields::System& system) const {
    FieldStiffness all;
    const std::vector<Block>& blocks = m_blocks[part];
    for (size_t k = 0; k < blocks.size(); k += width) {
        DoubleLanes fields[width] = {}, stiffness[directions] = {};
        for (size_t lane = 0; lane < width && k + lane < blocks.size(); ++lane) {
            const Block& block = blocks[k + lane];
            fields[lane] = wide(m_fields + 4 * static_cast<size_t>(block.row));
            for (int d = 0; d < directions; ++d) {
                const auto [i, j] = direction_pairs[d];
                stiffness[d][lane] = block.columns[i][j];
            }
        }
        transpose(fields);
        all.add(fields, stiffness);
    }
    for (size_t k = first(part); k < first(part + 1); ++k) {
        const Four& four = m_fours[k];
        DoubleLanes fields[fields_count], stiffness[directions], normal[3];
        for (int i = 0; i < fields_count; ++i) fields[i] = wide(four.field[i]);
        for (int i = 0; i < 3; ++i) normal[i] = wide(four.normal[i]);
        const DoubleLanes across = wide(four.across), more = wide(four.along) - across;
        for (int d = 0; d < directions; ++d) {
            const auto [i, j] = direction_pairs[d];
            stiffness[d] = more * normal[i] * normal[j];
            if (i == j) stiffness[d] += across;
        }
        all.add(fields, stiffness);
    }
    all.add_to(system);
}

template <class Real>
void ContactProduct<Real>::find_motions(size_t part, const Real* z) {
    for (size_t k = first(part); k < first(part + 1); ++k) {
        const Four& four = m_fours[k];
        DoubleLanes sums[width] = {};
        for (size_t corner = 0; corner < 4; ++corner)
            for (size_t lane = 0; lane < width; ++lane)
                sums[lane] += static_cast<double>(four.weight[corner][lane]) *
                              wide(z + 4 * static_cast<size_t>(four.row[corner][lane]));
        transpose(sums);
        m_steps[k] = {sums[0], sums[1], sums[2]};
    }
}

template <class Real>
void ContactProduct<Real>::stand_still(size_t part) {
    for (size_t k = first(part); k < first(part + 1); ++k) m_steps[k] = {};
}

template <class Real>
typename ContactProduct<Real>::Coordinates ContactProduct<Real>::force_of(
    const Four& four, const Coordinates& motion) {
    const Coordinates normal = {wide(four.normal[0]), wide(four.normal[1]), wide(four.normal[2])};
    const DoubleLanes across = wide(four.across);
    const DoubleLanes apart = normal[0] * motion[0] + normal[1] * motion[1] + normal[2] * motion[2];
    const DoubleLanes more = (wide(four.along) - across) * apart;
    return {across * motion[0] + more * normal[0], across * motion[1] + more * normal[1],
            across * motion[2] + more * normal[2]};
}

template <class Real>
void ContactProduct<Real>::add_moments(size_t part, const Real* z, Moments& moments) const {
    DoubleLanes rows[fields_count], sums[fields_count][3] = {};
    for (int k = 0; k < fields_count; ++k) rows[k] = load(moments[k]);
    for (const Block& block : m_blocks[part]) {
        const size_t at = 4 * static_cast<size_t>(block.row);
        const DoubleLanes field = wide(m_fields + at), force = block * wide(z + at);
        for (int k = 0; k < fields_count; ++k) rows[k] += field[k] * force;
    }
    for (size_t k = first(part); k < first(part + 1); ++k) {
        const Coordinates force = force_of(m_fours[k], m_steps[k]);
        for (int i = 0; i < fields_count; ++i) {
            const DoubleLanes field = wide(m_fours[k].field[i]);
            for (size_t j = 0; j < 3; ++j) sums[i][j] += field * force[j];
        }
    }
    for (int k = 0; k < fields_count; ++k) {
        const DoubleLanes of_couplings = {sum(sums[k][0]), sum(sums[k][1]), sum(sums[k][2]), 0.0};
        store(moments[k], rows[k] + of_couplings);
    }
}

template <class Real>
double ContactProduct<Real>::add_product(size_t part, double beta,
                                         const AffineFields::Coefficients& c, const Real* d,
                                         Real* product) {
    const FieldRows<double> rows(c);
    DoubleLanes curvature = {};
    for (const Block& block : m_blocks[part]) {
        const size_t at = 4 * static_cast<size_t>(block.row);
        DoubleLanes u = wide(d + at);
        if (m_fields) u -= rows.at(wide(m_fields + at));
        const DoubleLanes force = block * u;
        add_to_row(force, product + at);
        curvature += u * force;
    }
    return sum(curvature) + push(part, beta, c);
}

template <class Real>
double ContactProduct<Real>::push(size_t part, double beta, const AffineFields::Coefficients& c) {
    DoubleLanes curvature = {}, coefficients[fields_count][3];
    for (int i = 0; i < fields_count; ++i)
        for (int j = 0; j < 3; ++j) coefficients[i][j] = DoubleLanes{} + c(i, j);
    for (size_t k = first(part); k < first(part + 1); ++k) {
        const Four& four = m_fours[k];
        Coordinates& motion = m_motions[k];
        Coordinates moved = m_steps[k];
        for (size_t j = 0; j < 3; ++j) {
            if (beta != 0.0) moved[j] += beta * motion[j];
            motion[j] = moved[j];
        }
        for (int i = 0; i < fields_count; ++i) {
            const DoubleLanes field = wide(four.field[i]);
            for (size_t j = 0; j < 3; ++j) moved[j] -= field * coefficients[i][j];
        }
        const Coordinates force = force_of(four, moved);
        for (size_t j = 0; j < 3; ++j) curvature += moved[j] * force[j];
        DoubleLanes forces[width] = {force[0], force[1], force[2]};
        transpose(forces);
        for (size_t lane = 0; lane < width; ++lane)
            store(m_forces.data() + 4 * (width * k + lane),
                  __builtin_convertvector(forces[lane], Lanes<Real>));
    }
    return sum(curvature);
}

template class ContactProduct<float>;
template class ContactProduct<double>;

}  // namespace cloth
