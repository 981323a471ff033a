#include "gnn/physics/solver/contact_shares.h"

#include <algorithm>

namespace cloth {
namespace {

using Weights = AffineFields::Weights;

/// F' blocks F: weights of the fields, for each pair of directions.
struct FieldStiffness {
    Weights xx = Weights::Zero(), xy = Weights::Zero(), xz = Weights::Zero(), yy = Weights::Zero(),
            yz = Weights::Zero(), zz = Weights::Zero();

    void add(const DoubleLanes& field, const double (&columns)[3][4]) {
        const AffineFields::Row f(field[0], field[1], field[2], field[3]);
        const Weights weights = f * f.transpose();
        xx += columns[0][0] * weights;
        xy += columns[0][1] * weights;
        xz += columns[0][2] * weights;
        yy += columns[1][1] * weights;
        yz += columns[1][2] * weights;
        zz += columns[2][2] * weights;
    }
    void add_to(AffineFields::System& system) const {
        const Weights* const all[3][3] = {{&xx, &xy, &xz}, {&xy, &yy, &yz}, {&xz, &yz, &zz}};
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) AffineFields::add(*all[i][j], i, j, system);
    }
};

template <class Real>
void add_to_row(const DoubleLanes& force, Real* row) {
    const DoubleLanes sum = widened(load(row)) + force;
    store<Real>(row, __builtin_convertvector(sum, Lanes<Real>));
}

}  // namespace

template <class Real>
ContactShares<Real>::Columns::Columns(const Stiffness& s)
    : of{{s.xx, s.xy, s.xz, 0.0}, {s.xy, s.yy, s.yz, 0.0}, {s.xz, s.yz, s.zz, 0.0}} {
}

template <class Real>
DoubleLanes ContactShares<Real>::Share::motion(const Real* direction) const {
    DoubleLanes sum = weight[0] * widened(load(direction + 4 * row[0]));
    for (int k = 1; k < 4; ++k) sum += weight[k] * widened(load(direction + 4 * row[k]));
    return sum;
}

template <class Real>
void ContactShares<Real>::Share::add(const DoubleLanes& force, Real* product) const {
    for (int k = 0; k < 4; ++k) add_to_row(weight[k] * force, product + 4 * row[k]);
}

template <class Real>
void ContactShares<Real>::reserve(const ContactHessian& contacts, size_t rows) {
    m_blocks.reserve(std::max(rows, contacts.blocks().size()));
    m_shares.reserve(contacts.most_couplings());
    m_between.reserve(contacts.most_couplings());
    m_motions.reserve(4 * contacts.most_couplings());
}

template <class Real>
void ContactShares<Real>::take(const ContactHessian& contacts, size_t part,
                               const std::vector<unsigned char>& part_of, const Real* fields) {
    m_blocks.clear();
    m_shares.clear();
    m_between.clear();
    for (const ContactHessian::Block& block : contacts.blocks())
        if (part_of[static_cast<size_t>(block.row)] == part)
            m_blocks.push_back({block.row, Columns(block.stiffness)});
    contacts.for_each_coupling(
        [&](const ContactHessian::Coupling& coupling) { take(coupling, part, part_of, fields); });
    m_motions.assign(4 * m_between.size(), 0.0);
}

template <class Real>
void ContactShares<Real>::take(const ContactHessian::Coupling& coupling, size_t part,
                               const std::vector<unsigned char>& part_of, const Real* fields) {
    DoubleLanes field = {};
    unsigned parts = 0;  // a bit for each part that has rows of it
    int own = 0;
    Share share{none, false, {}, {}, Columns(coupling.stiffness), {}};
    for (size_t k = 0; k < coupling.row.size(); ++k) {
        if (coupling.weight[k] == 0.0) continue;
        const int row = coupling.row[k];
        const double weight = coupling.weight[k];
        const unsigned char its_part = part_of[static_cast<size_t>(row)];
        field += weight * widened(load(fields + 4 * row));
        parts |= 1u << its_part;
        if (its_part != part) continue;
        share.row[own] = row;
        share.weight[own++] = weight;
    }
    if (parts & (parts - 1)) {
        share.between = static_cast<int>(m_between.size());
        m_between.push_back(share.stiffness);
    }
    if (own == 0) return;
    for (int k = own; k < 4; ++k) share.row[k] = share.row[0];
    share.first = (parts & ((1u << part) - 1)) == 0;
    store(share.field, field);
    m_shares.push_back(share);
}

template <class Real>
void ContactShares<Real>::add_to(const Real* fields, AffineFields::System& system) const {
    FieldStiffness all;
    for (const Block& block : m_blocks)
        all.add(widened(load(fields + 4 * block.row)), block.stiffness.of);
    for (const Share& share : m_shares)
        if (share.first) all.add(load(share.field), share.stiffness.of);
    all.add_to(system);
}

template <class Real>
void ContactShares<Real>::add_moments(const Real* fields, const Real* z, Moments& moments) const {
    DoubleLanes sums[AffineFields::count];
    for (int k = 0; k < AffineFields::count; ++k) sums[k] = load(moments[k]);
    const auto add = [&](const DoubleLanes& field, const DoubleLanes& force) {
        for (int k = 0; k < AffineFields::count; ++k) sums[k] += field[k] * force;
    };
    for (const Block& block : m_blocks)
        add(widened(load(fields + 4 * block.row)),
            block.stiffness * widened(load(z + 4 * block.row)));
    for (const Share& share : m_shares) add(load(share.field), share.stiffness * share.motion(z));
    for (int k = 0; k < AffineFields::count; ++k) store(moments[k], sums[k]);
}

template <class Real>
double ContactShares<Real>::add_product(const Real* fields, const FieldRows<double>& c,
                                        const Real* direction, Real* product) {
    DoubleLanes curvature = {};
    for (const Block& block : m_blocks) {
        const DoubleLanes u =
            widened(load(direction + 4 * block.row)) - c.at(widened(load(fields + 4 * block.row)));
        const DoubleLanes force = block.stiffness * u;
        add_to_row(force, product + 4 * block.row);
        curvature += u * force;
    }
    for (const Share& share : m_shares) {
        DoubleLanes motion = share.motion(direction);
        if (share.first) motion -= c.at(load(share.field));
        if (share.between != none) {
            store(m_motions.data() + 4 * share.between, motion);
            continue;
        }
        const DoubleLanes force = share.stiffness * motion;
        share.add(force, product);
        curvature += motion * force;
    }
    return sum(curvature);
}

template <class Real>
DoubleLanes ContactShares<Real>::motion_between(const Parts& parts, size_t k) {
    return load(parts[0].m_motions.data() + 4 * k) + load(parts[1].m_motions.data() + 4 * k) +
           load(parts[2].m_motions.data() + 4 * k);
}

template <class Real>
double ContactShares<Real>::curvature_between(const Parts& parts) {
    DoubleLanes curvature = {};
    const std::vector<Columns>& between = parts[0].m_between;
    for (size_t k = 0; k < between.size(); ++k) {
        const DoubleLanes motion = motion_between(parts, k);
        curvature += motion * (between[k] * motion);
    }
    return sum(curvature);
}

template <class Real>
void ContactShares<Real>::add_product_between(const Parts& parts, Real* product) const {
    for (const Share& share : m_shares)
        if (share.between != none)
            share.add(share.stiffness * motion_between(parts, static_cast<size_t>(share.between)),
                      product);
}

template class ContactShares<float>;
template class ContactShares<double>;

}  // namespace cloth
