#include "render/label_placement.h"

#include <algorithm>
#include <limits>

namespace cloth {

static double area(const Box& box) {
    return std::max(0.0, box.right - box.left) * std::max(0.0, box.bottom - box.top);
}

static Box common(const Box& a, const Box& b) {
    return {std::max(a.left, b.left), std::max(a.top, b.top), std::min(a.right, b.right),
            std::min(a.bottom, b.bottom)};
}

double LabelPlacement::hidden_by(const Box& box) const {
    double sum = area(box) - area(common(box, m_picture));
    for (const Box& taken : m_taken) sum += area(common(box, taken));
    return sum;
}

Box LabelPlacement::place(double x, double y, double width, double height) {
    struct Direction {
        double x, y;
    };
    static constexpr Direction directions[] = {{1, -1}, {-1, -1}, {1, 1},  {-1, 1},
                                               {1, 0},  {-1, 0},  {0, -1}, {0, 1}};
    Box best{};
    double least = std::numeric_limits<double>::infinity();
    for (double distance : {5.0, 11.0, 18.0, 26.0})
        for (const Direction& direction : directions) {
            const double centre_x = x + direction.x * (distance + 0.5 * width);
            const double centre_y = y + direction.y * (distance + 0.5 * height);
            const Box box = {centre_x - 0.5 * width, centre_y - 0.5 * height,
                             centre_x + 0.5 * width, centre_y + 0.5 * height};
            const double hidden = hidden_by(box);
            if (hidden > least - 0.01) continue;  // of equals, the first
            least = hidden;
            best = box;
        }
    m_taken.push_back(best);
    return best;
}

}  // namespace cloth
