#pragma once

#include <string>

#include "demos/compare/references.h"

namespace cloth {

/// The start and the references of a scene, computed once and kept in files: they are expensive,
/// and other solvers and shorter runs need the same.
class ReferenceCache {
 public:
    /// @param folder  made if it is not there
    /// @param name    tells scenes apart, such as "tshirt_soft"; of files also by what they hold,
    /// see
    ///                short_key()
    ReferenceCache(const std::string& folder, const std::string& name,
                   const ComparisonScene& scene);

    ClothState start(const ProgressFunction& progress) const;
    References references(const ClothState& start, const ProgressFunction& progress) const;

 private:
    const ComparisonScene& m_scene;
    std::string m_prefix;
};

}  // namespace cloth
