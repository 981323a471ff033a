#include "demos/viewer/solver_choice.h"

#include "demos/compare/solver_factory.h"

namespace cloth {
namespace {

bool ends_with(const std::string& text, const std::string& end) {
    return text.size() >= end.size() && text.substr(text.size() - end.size()) == end;
}

}  // namespace

bool SolverChoice::has_number() const {
    return ends_with(kind, "-K") || ends_with(kind, "-N") || ends_with(kind, "+K");
}

std::string SolverChoice::name() const {
    return has_number() ? kind.substr(0, kind.size() - 1) + std::to_string(k) : kind;
}

SolverChoice SolverChoice::of(const std::string& name) {
    const size_t last = name.find_last_not_of("0123456789");
    const std::string digits = last == std::string::npos ? "" : name.substr(last + 1);
    if (digits.empty() || digits.size() > 4) return {name, 10};
    for (const std::string& kind : solver_kinds()) {
        const SolverChoice choice{kind, std::stoi(digits)};
        if (choice.has_number() && choice.name() == name) return choice;
    }
    return {name, 10};
}

std::vector<std::string> solver_kinds() {
    std::vector<std::string> kinds = {"default", "quasi-newton", "quasi-newton-K",
                                      "quasi-newton-bdf2", "xpbd-N"};
    for (const std::string& network : networks_in("")) {
        kinds.push_back(network);
        kinds.push_back(network + "+K");
    }
    kinds.push_back("newton-K");
    kinds.push_back("reference");
    return kinds;
}

}  // namespace cloth
