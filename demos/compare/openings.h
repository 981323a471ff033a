#pragma once

#include <string>
#include <utility>
#include <vector>

#include "data/body/body.h"
#include "data/core/garment.h"

namespace cloth {

/// Whether the limbs still come out of a garment's openings. A shirt of which an arm has slipped
/// out of its sleeve lies on the body all the same, outside of it and hardly stretched: neither
/// contact nor strain tells.
///
/// A line inside the body leads from the end of each limb to that of every other one, such as from
/// the left hand to the head. Those of them that pass through an opening as the garment is put on,
/// counted with their directions, pass through it as long as it is worn.
class Openings {
 public:
    /// @param start  |V| x 3 (m): as worn on the body's rest pose
    Openings(const Garment& garment, const Points& start, const Body& body);

    /// The joint at the end of a limb that came out of an opening through which all its lines
    /// passed, such as "LeftFingerBase"; empty: there is none.
    /// @param skin  vertices of the body (m)
    /// @param x     |V| x 3 (m): the garment
    std::string slipped_limb(const Points& skin, const Points& x) const;

    int count() const { return static_cast<int>(m_openings.size()); }  ///< that limbs come out of

 private:
    using Border = std::vector<std::pair<int, int>>;   ///< edges of one loop, along their faces
    using Mean = std::vector<std::pair<int, double>>;  ///< vertices and weights, which sum to 1
    struct Line {
        int from = 0, to = 0;       ///< joints
        std::vector<size_t> marks;  ///< that it leads along
    };
    /// A line from one end to another one passes through an opening.
    struct Passage {
        size_t line = 0;
        int times = 0;  ///< against the opening's sense of rotation: less than 0
    };
    struct Opening {
        Border border;
        std::vector<Passage> passages;
        std::string limb;  ///< on the side of it that has fewer ends
    };

    void find_marks(const Body& body);
    void find_lines(const Body& body);
    Points marks(const Points& skin) const;
    static int times_through(const Border& border, const Points& x, const Line& line,
                             const Points& marks);
    static std::vector<Border> borders(const Faces& faces);

    /// Points inside the body that move with its skin: each joint's, and from there on the tips of
    /// those that end a limb. Empty: the skin says nothing of it.
    std::vector<Mean> m_marks;
    std::vector<Line> m_lines;
    std::vector<Opening> m_openings;
};

}  // namespace cloth
