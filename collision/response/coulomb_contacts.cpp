#include "collision/response/coulomb_contacts.h"

#include <algorithm>
#include <utility>

namespace cloth {
namespace {

Vec3 place_of(const CoulombContacts::Contact& contact, const Points& y) {
    Vec3 place = Vec3::Zero();
    for (size_t k = 0; k < 4; ++k)
        if (contact.weight[k] != 0.0)
            place += contact.weight[k] * y.row(contact.vertex[k]).transpose();
    return place;
}

}  // namespace

CoulombContacts::CoulombContacts(VectorX inverse_masses)
    : m_inverse_masses(std::move(inverse_masses)) {
}

void CoulombContacts::add(const Contact& contact) {
    Solved solved;
    static_cast<Contact&>(solved) = contact;
    for (size_t k = 0; k < 4; ++k)
        if (contact.weight[k] != 0.0)
            solved.mobility +=
                contact.weight[k] * contact.weight[k] * m_inverse_masses[contact.vertex[k]];
    m_contacts.push_back(solved);
}

/// Returns how far the point that moved farthest did.
double CoulombContacts::sweep(Points& y) {
    double largest = 0.0;
    for (Solved& contact : m_contacts) {
        if (!(contact.mobility > 0.0)) continue;
        const Vec3 place = place_of(contact, y);
        const double missing = contact.height - contact.normal.dot(place);
        const double push = std::max(0.0, contact.push + missing / contact.mobility);
        const Vec3 off = place - contact.target;
        Vec3 rub =
            contact.rub - (off - contact.normal.dot(off) * contact.normal) / contact.mobility;
        const double most = contact.friction * push, length = rub.norm();
        if (length > most) rub *= most / length;
        const Vec3 change = (push - contact.push) * contact.normal + rub - contact.rub;
        contact.push = push;
        contact.rub = rub;
        largest = std::max(largest, change.norm() * contact.mobility);
        for (size_t k = 0; k < 4; ++k)
            if (contact.weight[k] != 0.0)
                y.row(contact.vertex[k]) +=
                    contact.weight[k] * m_inverse_masses[contact.vertex[k]] * change.transpose();
    }
    return largest;
}

void CoulombContacts::solve(int sweeps, double enough, Points& y) {
    for (Solved& contact : m_contacts) {
        contact.push = 0.0;
        contact.rub.setZero();
    }
    for (int k = 0; k < sweeps; ++k)
        if (!(sweep(y) > enough)) return;
}

}  // namespace cloth
