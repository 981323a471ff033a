#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "gnn/physics/energy/lanes.h"
#include "gnn/physics/solver/affine_fields.h"
#include "gnn/physics/solver/contact_hessian.h"
#include "gnn/physics/solver/crew.h"

namespace cloth {

/// C of displacements F C, in lanes.
template <class Real>
struct FieldRows {
    Lanes<Real> of[AffineFields::count];

    explicit FieldRows(const AffineFields::Coefficients& c) {
        for (int k = 0; k < AffineFields::count; ++k)
            of[k] = Lanes<Real>{Real(c(k, 0)), Real(c(k, 1)), Real(c(k, 2)), Real(0)};
    }
    /// Of the point with these fields.
    template <class Fields>
    Lanes<Real> at(const Fields& fields) const {
        return (fields[0] * of[0] + fields[1] * of[1]) + (fields[2] * of[2] + fields[3] * of[3]);
    }
};

/// What contact blocks and couplings do to the vectors of conjugate gradients, packed for that.
/// Couplings are gone through four at a time. Their motions (weighted sums of rows) follow
/// directions, d = z + beta d, so that rows are looked up once in an iteration; and rows fetch the
/// forces of their couplings, so that no two threads add to one row:
///
///     product.take(contacts, part_of, fields);       // before the threads begin
///     each part:   product.find_motions(part, z);    // when z is there, of all parts
///                  product.add_moments(part, z, moments);
///     after that:  curvature = product.add_product(part, beta, c, d, a_d);
///     after that:  a_d of each row += product.force(row);
///
/// Arrays are n x 4, of Real; the halves share the couplings. Motions are in double precision: deep
/// contacts are so much stiffer than the cloth that the rounding of a sliding motion would be felt
/// as a force.
template <class Real>
class ContactProduct {
 public:
    using Moments = double[AffineFields::count][4];  ///< F' a, with a spare column

    /// Takes what anticipate() left. Once arrays have grown, it allocates nothing.
    /// @param part_of  n
    /// @param fields   F (n x 4), kept by reference; null: none are deflated
    void take(const ContactHessian& contacts, const std::vector<unsigned char>& part_of,
              const Real* fields);

    /// system += this part of F' blocks F.
    void add_to(size_t part, AffineFields::System& system) const;
    /// Of the couplings of this part, for what follows. @param z  its part and the others'
    void find_motions(size_t part, const Real* z);
    /// The same of z = 0.
    void stand_still(size_t part);
    /// moments += this part of F' blocks z.
    void add_moments(size_t part, const Real* z, Moments& moments) const;
    /// product += blocks * (d - F c) at single vertices; of couplings it finds the forces.
    /// @param beta  that d = z + beta d was made with
    /// @return  (d - F c)' (blocks and couplings) (d - F c)
    double add_product(size_t part, double beta, const AffineFields::Coefficients& c, const Real* d,
                       Real* product);
    /// What couplings do to a row, once add_product() has been through all parts.
    Lanes<Real> force(size_t row) const {
        Lanes<Real> sum = {};
        for (int k = m_begin[row]; k < m_begin[row + 1]; ++k) {
            const Touch& touch = m_touches[static_cast<size_t>(k)];
            sum += touch.weight * load(m_forces.data() + 4 * static_cast<size_t>(touch.coupling));
        }
        return sum;
    }

 private:
    static constexpr size_t width = 4;

    struct Block {
        int row;
        double columns[3][4];  ///< of a symmetric matrix, with a spare row

        DoubleLanes operator*(const DoubleLanes& u) const {
            return u[0] * load(columns[0]) + u[1] * load(columns[1]) + u[2] * load(columns[2]);
        }
    };
    /// Couplings, one to a lane; those to spare have weights and stiffnesses of zero.
    struct Four {
        int row[4][width];
        Real weight[4][width];
        Real normal[3][width];
        Real along[width], across[width];        ///< stiffness (N/m)
        Real field[AffineFields::count][width];  ///< how far each field moves the weighted sum
    };
    using Coordinates = std::array<DoubleLanes, 3>;  ///< x, y and z, a coupling to a lane
    /// A row's part in a coupling.
    struct Touch {
        int coupling;
        Real weight;
    };

    void take_blocks(const ContactHessian& contacts, const std::vector<unsigned char>& part_of);
    void take_couplings(const ContactHessian& contacts);
    void put(const ContactHessian::Coupling& coupling);
    void find_touches(size_t rows);
    size_t first(size_t part) const;
    static Coordinates force_of(const Four& four, const Coordinates& motion);
    double push(size_t part, double beta, const AffineFields::Coefficients& c);

    const Real* m_fields = nullptr;
    std::array<std::vector<Block>, Crew::parts> m_blocks;
    size_t m_count = 0;  ///< of couplings
    std::vector<Four> m_fours;
    std::vector<Coordinates> m_steps, m_motions;  ///< of z, and of d
    std::vector<Real> m_forces;                   ///< couplings x 4
    std::vector<int> m_begin;                     ///< n + 1: the first touch of each row
    std::vector<Touch> m_touches;                 ///< row by row
};

}  // namespace cloth
