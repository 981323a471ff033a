#include "collision/self_contact_settings.h"

#include <string>

#include "data/errors.h"

namespace cloth {

static void check(const char* field, double value, double low, double high) {
    if (!(value >= low && value <= high))
        throw ArgumentError(std::string("SelfContactSettings.") + field,
                            std::to_string(value) + " is out of range",
                            "use " + std::to_string(low) + " to " + std::to_string(high));
}

void check_self_contact(const SelfContactSettings& settings) {
    if (settings.thickness != 0.0) check("thickness", settings.thickness, 1e-3, 2e-2);
    check("weight", settings.weight, 1e3, 1e6);
    check("rounds", settings.rounds, 0, 100);
    check("threads", settings.threads, 0, 1024);
}

}  // namespace cloth
