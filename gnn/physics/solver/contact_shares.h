#pragma once

#include <array>
#include <vector>

#include "gnn/physics/solver/affine_fields.h"
#include "gnn/physics/solver/contact_hessian.h"
#include "gnn/physics/solver/crew.h"
#include "gnn/physics/solver/lanes.h"

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

/// What contact blocks and couplings do to one part of the rows (see Crew), packed in the layout of
/// the factor: they are gone through twice in each iteration of a solve. Each part has its own, and
/// a coupling of rows in several parts leaves a share in each:
///
///     each part:   shares[part].add_moments(fields, z, moments);
///                  curvature = shares[part].add_product(fields, c, direction, product);
///     after that:  curvature += curvature_between(shares);
///     each part:   shares[part].add_product_between(shares, product);
///
/// Arrays are n x 4, of Real. What is done to a row is in double precision: deep contacts are so
/// much stiffer than the cloth that the rounding of a sliding motion would be felt as a force.
template <class Real>
class ContactShares {
 public:
    using Parts = std::array<ContactShares, Crew::parts>;
    using Moments = double[AffineFields::count][4];  ///< F' a, with a spare column

    /// So that `take` allocates nothing. @param rows  n
    void reserve(const ContactHessian& contacts, size_t rows);
    /// Takes what anticipate() left. @param part_of  n  @param fields  F (n x 4)
    void take(const ContactHessian& contacts, size_t part,
              const std::vector<unsigned char>& part_of, const Real* fields);

    /// system += this part of F' blocks F.
    void add_to(const Real* fields, AffineFields::System& system) const;
    /// moments += this part of F' blocks z.
    void add_moments(const Real* fields, const Real* z, Moments& moments) const;
    /// product += blocks * (direction - F c), but for couplings with other parts.
    /// @return  (direction - F c)' blocks (direction - F c)
    double add_product(const Real* fields, const FieldRows<double>& c, const Real* direction,
                       Real* product);

    /// What couplings with other parts add, once all parts have been through add_product.
    static double curvature_between(const Parts& parts);
    void add_product_between(const Parts& parts, Real* product) const;

 private:
    static constexpr int none = -1;

    struct Columns {
        double of[3][4];  ///< of a symmetric matrix, with a spare row

        explicit Columns(const Stiffness& stiffness);
        DoubleLanes operator*(const DoubleLanes& u) const {
            return u[0] * load(of[0]) + u[1] * load(of[1]) + u[2] * load(of[2]);
        }
    };
    struct Block {
        int row;
        Columns stiffness;
    };
    struct Share {
        int between;       ///< number among the couplings of several parts, or none
        bool first;        ///< of the parts that have a share
        int row[4];        ///< rows of this part
        double weight[4];  ///< 0 for those to spare
        Columns stiffness;
        double field[4];  ///< how far each field moves the weighted sum, of all parts

        DoubleLanes motion(const Real* direction) const;
        void add(const DoubleLanes& force, Real* product) const;
    };

    void take(const ContactHessian::Coupling& coupling, size_t part,
              const std::vector<unsigned char>& part_of, const Real* fields);
    static DoubleLanes motion_between(const Parts& parts, size_t k);

    std::vector<Block> m_blocks;
    std::vector<Share> m_shares;
    std::vector<Columns> m_between;  ///< those of several parts, whichever these are
    std::vector<double> m_motions;   ///< |between| x 4: this part of their sums
};

}  // namespace cloth
