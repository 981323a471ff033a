#include <cmath>
#include <cstdio>

#include "analysis.h"
#include "cloth_side.h"

int main() {
    const double before = analysed(40);
    const bool falls = cloth_falls_on_a_ball();
    const double after = analysed(40), larger = analysed(50);
    std::printf("analysed: %g, %g, %g\n", before, after, larger);
    return falls && before == after && std::isfinite(larger) ? 0 : 1;
}
