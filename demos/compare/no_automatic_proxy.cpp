#include "demos/compare/arguments.h"
#include "demos/compare/proxy_solver.h"

namespace cloth {

Garment automatic_proxy(const std::string& name, const Garment&, int vertices) {
    throw UsageError("solver " + name + ": this program is built without CGAL, which makes the " +
                     "proxy of " + std::to_string(vertices) +
                     " vertices; name a garment after the ~, or take the preset notorch");
}

}  // namespace cloth
