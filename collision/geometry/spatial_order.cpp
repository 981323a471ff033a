#include "collision/geometry/spatial_order.h"

#include <algorithm>
#include <numeric>

namespace cloth {
namespace {

using Iterator = std::vector<int>::iterator;

int longest_side(const Points& x, Iterator first, Iterator last) {
    Eigen::RowVector3d low = x.row(*first), high = low;
    for (Iterator i = first; i != last; ++i) {
        low = low.cwiseMin(x.row(*i));
        high = high.cwiseMax(x.row(*i));
    }
    int side = 0;
    (high - low).maxCoeff(&side);
    return side;
}

void halve(const Points& x, int run, Iterator first, Iterator last) {
    const auto count = last - first;
    if (count <= run) return;
    const Iterator middle = first + (count / 2 + run - 1) / run * run;
    if (middle == last) return;
    const int side = longest_side(x, first, last);
    std::nth_element(first, middle, last, [&](int a, int b) { return x(a, side) < x(b, side); });
    halve(x, run, first, middle);
    halve(x, run, middle, last);
}

}  // namespace

std::vector<int> spatial_order(const Points& x, int run) {
    std::vector<int> order(static_cast<size_t>(x.rows()));
    std::iota(order.begin(), order.end(), 0);
    const Iterator finite = std::stable_partition(order.begin(), order.end(),
                                                  [&](int i) { return x.row(i).allFinite(); });
    halve(x, run, order.begin(), finite);
    return order;
}

}  // namespace cloth
