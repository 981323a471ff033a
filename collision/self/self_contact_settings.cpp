#include "collision/self/self_contact_settings.h"

#include "data/core/check_range.h"

namespace cloth {

void check_self_contact(const SelfContactSettings& settings) {
    if (settings.thickness != 0.0)
        check_range("SelfContactSettings.thickness", settings.thickness, 1e-3, 2e-2);
    check_range("SelfContactSettings.weight", settings.weight, 1e3, 1e6);
    check_range("SelfContactSettings.friction", settings.friction, 0.0, 1.5);
    check_range("SelfContactSettings.rounds", settings.rounds, 0, 100);
    check_range("SelfContactSettings.untangling_tension", settings.untangling_tension, 0.0, 10.0);
    check_range("SelfContactSettings.untangling_moves", settings.untangling_moves, 0, 100);
    check_range("SelfContactSettings.threads", settings.threads, 0, 1024);
}

}  // namespace cloth
