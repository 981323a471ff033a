#pragma once

#include "collision/proximity/proximity.h"

namespace cloth {

/// Cuts the contacts of a step into equal parts in time: surface points and planes move evenly from
/// where they are at t to where they are at t + dt. The first part's distances are the contacts'
/// own; later ones are to the planes.
///
///     ContactPart part;
///     part.begin(contacts, 4);
///     for (int k = 0; k < 4; ++k) { ... part.take(k, x) ... }
class ContactPart {
 public:
    /// Keeps a reference to `contacts` until the last part is taken.
    void begin(const SurfaceContacts& contacts, int count);

    /// Part k, 0 to count - 1; valid until the next call. Faces and coordinates in them stay.
    /// @param x  |V| x 3 (m), where the part begins
    const SurfaceContacts& take(int k, const Points& x);

 private:
    const SurfaceContacts* m_whole = nullptr;
    int m_count = 1;
    SurfaceContacts m_part;
};

}  // namespace cloth
