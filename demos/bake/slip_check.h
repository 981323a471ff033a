#pragma once

#include <string>
#include <vector>

#include "data/body/skin_binding.h"
#include "data/core/garment.h"

namespace cloth {

/// How far a piece of a garment is from where it was worn, if that is too far.
struct Slip {
    int piece = 0, pieces = 1;  ///< its number from 0, and how many there are
    double way = 0.0;           ///< (m)
    bool is_held = false;       ///< by pins or goals
};

/// Tells a garment that slid off from one that drapes. Cloth hangs from the upper part of what lies
/// on the skin; its hems, and the edge of a poncho, may go anywhere. So a piece slid off if the
/// skin that it hung from is bare, wherever the body took that skin, and most of what lay there has
/// moved: cloth that only turns round the body leaves nothing bare. Pieces that are not joined are
/// judged one by one: a shirt may stay where trousers fall.
class SlipCheck {
 public:
    /// @param start   |V| x 3 (m): the garment as it is worn
    /// @param skin    in that pose
    /// @param height  of the character (m): what is far is a part of it
    SlipCheck(const Garment& garment, const Points& start, const TriMesh& skin, double height);

    /// The pieces that slid off.
    /// @param skin  its vertices now (|V| x 3, m)
    /// @param x     |V| x 3 (m): the garment now
    std::vector<Slip> slips(const Points& skin, const Points& x) const;

 private:
    struct Piece {
        std::vector<int> all;      ///< its vertices
        std::vector<int> hanging;  ///< those that it hangs from, the highest first
        SkinBinding below;         ///< the skin below them
        double far = 0.0;          ///< (m)
        bool is_held = false;
    };
    static Piece piece_of(const Points& start, const TriMesh& skin, double height,
                          std::vector<int> vertices, bool is_held);
    static double bare(const Piece& piece, const Points& below, const Points& x);

    std::vector<Piece> m_pieces;
};

/// What the user is told of the first of them; empty if there is none.
std::string slip_message(const std::vector<Slip>& slips);

}  // namespace cloth
