#include "demos/compare/body_named.h"

#include <algorithm>
#include <limits>
#include <optional>

#include "demos/compare/arguments.h"

namespace cloth {
namespace {

bool is_number(const std::string& text) {
    return !text.empty() &&
           std::all_of(text.begin(), text.end(), [](char c) { return c >= '0' && c <= '9'; });
}

BodyShape slight() {
    BodyShape shape;
    shape.female = 1.0;
    shape.weight = 0.35;
    shape.height = 0.45;
    return shape;
}

BodyShape heavy() {
    BodyShape shape;
    shape.female = 0.0;
    shape.weight = 0.75;
    shape.waist = 0.3;
    return shape;
}

}  // namespace

const std::vector<std::string>& body_names() {
    static const std::vector<std::string> names = {"default", "slight", "heavy"};
    return names;
}

BodyShape body_shape_named(const std::string& name) {
    if (name == "default") return {};
    if (name == "slight") return slight();
    if (name == "heavy") return heavy();
    if (!is_number(name))
        throw UsageError("body " + name + ": choose one of " + join_list(body_names(), ", ") +
                         ", or a number, of which each is a sampled shape");
    return sample_body_shape(
        static_cast<uint64_t>(whole_number("body", name, 0, std::numeric_limits<int>::max())));
}

std::shared_ptr<const Body> body_named(const std::string& name) {
    const BodyShape shape = body_shape_named(name);
    Body standard = Body::load_default();
    if (name == "default") return std::make_shared<const Body>(std::move(standard));
    const std::optional<BodyShapes> shapes = BodyShapes::load_shared();
    if (!shapes)
        throw UsageError("body " + name +
                         ": body shapes need MakeHuman's data in the shared data folder "
                         "(CLOTH_SHARED_DATA); take the body \"default\"");
    return std::make_shared<const Body>(standard.with_rest(shapes->skin(shape)));
}

}  // namespace cloth
