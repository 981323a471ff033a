#include "data/files/cache_writer.h"

#include <limits>
#include <utility>

#include "data/core/check_range.h"
#include "data/files/cache_format.h"
#include "data/files/glb_writer.h"
#include "data/files/obj_sequence.h"
#include "data/files/point_cache_writer.h"
#include "data/files/usd_writer.h"

namespace cloth {

void CacheSettings::check() const {
    check_range("CacheSettings.rate", rate, 1.0, 1000.0);
    check_range("CacheSettings.frames", frames, 1.0, 1e6);
}

CacheWriter::CacheWriter(std::string path, Eigen::Index vertices, const CacheSettings& settings)
    : m_path(std::move(path)), m_vertices(vertices), m_settings(settings) {
    settings.check();
    check_range(m_path + ": vertices", static_cast<double>(vertices), 1.0,
                std::numeric_limits<int>::max());
}

void CacheWriter::add(const Points& x) {
    const std::string frame = m_path + ", frame " + std::to_string(m_frames);
    if (m_frames == m_settings.frames)
        throw ArgumentError(frame, "the header says that there are no more",
                            "set CacheSettings.frames to the number of frames");
    if (x.rows() != m_vertices)
        throw ArgumentError(frame,
                            "it has " + std::to_string(x.rows()) + " vertices, the mesh " +
                                std::to_string(m_vertices),
                            "give the positions of the mesh that the cache was made for");
    if (!x.allFinite() || x.cwiseAbs().maxCoeff() > std::numeric_limits<float>::max())
        throw ArgumentError(frame, "a coordinate is not finite, or too large for a float",
                            "end the cache before the simulation fails");
    write(m_frames, x);
    ++m_frames;
}

void CacheWriter::finish() {
    if (m_frames != m_settings.frames)
        throw ArgumentError(m_path,
                            "has " + std::to_string(m_frames) + " of the " +
                                std::to_string(m_settings.frames) + " frames of its header",
                            "add the others first");
    commit();
}

std::unique_ptr<CacheWriter> make_cache_writer(const std::string& path, const TriMesh& mesh,
                                               const CacheSettings& settings, CacheStart start) {
    switch (cache_format(path)) {
        case CacheFormat::pc2:
            return std::make_unique<Pc2Writer>(path, mesh.vertices.rows(), settings, start);
        case CacheFormat::mdd:
            return std::make_unique<MddWriter>(path, mesh.vertices.rows(), settings, start);
        case CacheFormat::glb:
            return std::make_unique<GlbWriter>(path, mesh, settings, start);
        case CacheFormat::usda:
            return std::make_unique<UsdWriter>(path, mesh, settings, start);
        case CacheFormat::obj_sequence:
            break;
    }
    return std::make_unique<ObjSequence>(path, mesh, settings, start);
}

}  // namespace cloth
