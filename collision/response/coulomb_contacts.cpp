#include "collision/response/coulomb_contacts.h"

#include <algorithm>
#include <utility>

namespace cloth {

CoulombContacts::CoulombContacts(VectorX inverse_masses)
    : m_inverse_masses(std::move(inverse_masses)) {
}

void CoulombContacts::add(const Contact& contact) {
    Solved solved;
    solved.vertex = contact.vertex;
    solved.weight = contact.weight;
    solved.normal << contact.normal, 0.0;
    solved.target << contact.target, 0.0;
    solved.height = contact.height;
    solved.friction = contact.friction;
    solved.push = contact.push;
    solved.rub << contact.rub, 0.0;
    for (size_t k = 0; k < 4; ++k) {
        solved.response[k] = contact.weight[k] * m_inverse_masses[contact.vertex[k]];
        solved.mobility += contact.weight[k] * solved.response[k];
    }
    m_contacts.push_back(solved);
}

/// Returns how far the point that moved farthest did.
double CoulombContacts::sweep() {
    double largest = 0.0;
    for (Solved& contact : m_contacts) {
        if (!(contact.mobility > 0.0)) continue;
        Vec4 place = Vec4::Zero();
        for (size_t k = 0; k < 4; ++k)
            place += contact.weight[k] * m_y[static_cast<size_t>(contact.vertex[k])];
        const double missing = contact.height - contact.normal.dot(place);
        const double push = std::max(0.0, contact.push + missing / contact.mobility);
        if (push == 0.0 && contact.push == 0.0) continue;
        const Vec4 off = place - contact.target;
        Vec4 rub =
            contact.rub - (off - contact.normal.dot(off) * contact.normal) / contact.mobility;
        const double most = contact.friction * push, length = rub.norm();
        if (length > most) rub *= most / length;
        const Vec4 change = (push - contact.push) * contact.normal + rub - contact.rub;
        contact.push = push;
        contact.rub = rub;
        largest = std::max(largest, change.norm() * contact.mobility);
        for (size_t k = 0; k < 4; ++k)
            m_y[static_cast<size_t>(contact.vertex[k])] += contact.response[k] * change;
    }
    return largest;
}

void CoulombContacts::solve(int sweeps, double enough, Points& y) {
    m_y.resize(static_cast<size_t>(y.rows()));
    for (Eigen::Index i = 0; i < y.rows(); ++i)
        m_y[static_cast<size_t>(i)] << y.row(i).transpose(), 0.0;
    for (int k = 0; k < sweeps; ++k)
        if (!(sweep() > enough)) break;
    for (Eigen::Index i = 0; i < y.rows(); ++i) y.row(i) = m_y[static_cast<size_t>(i)].head<3>();
}

}  // namespace cloth
