#include "data/authoring/make_proxy.h"
#include "demos/compare/proxy_solver.h"

namespace cloth {

Garment automatic_proxy(const std::string&, const Garment& fine, int vertices) {
    ProxySettings settings;
    settings.vertices = vertices;
    return make_proxy(fine, settings);
}

}  // namespace cloth
