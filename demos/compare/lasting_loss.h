#pragma once

#include <optional>

namespace cloth {

/// Tells a garment that is lost from one that seems so for a moment, as while a hand reaches into
/// its own sleeve: what is lost in the last frame is, and else what is lost for a third of a
/// second.
class LastingLoss {
 public:
    /// To be called for every frame, in order.
    /// @param dt  time step (s)
    /// @return the frame from which on the garment has been lost, if it is
    std::optional<int> add(int frame, bool seems_lost, bool is_last, double dt) {
        if (!seems_lost) {
            m_since.reset();
            return std::nullopt;
        }
        if (!m_since) m_since = frame;
        const bool lasts = (frame + 1 - *m_since) * dt >= lasting;
        return lasts || is_last ? m_since : std::nullopt;
    }

 private:
    static constexpr double lasting = 1.0 / 3.0;  // s
    std::optional<int> m_since;
};

}  // namespace cloth
