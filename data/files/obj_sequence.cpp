#include "data/files/obj_sequence.h"

#include <fcntl.h>

#include <cstdio>
#include <filesystem>

#include "data/core/errors.h"
#include "data/core/read_file.h"
#include "data/files/make_folder.h"
#include "data/files/mesh_io.h"

namespace cloth {

namespace fs = std::filesystem;

ObjSequence::ObjSequence(const std::string& path, const TriMesh& mesh,
                         const CacheSettings& settings, CacheStart start)
    : CacheWriter(path, mesh.vertices.rows(), settings), m_mesh(mesh) {
    fs::path folder = fs::path(path).lexically_normal();
    if (!folder.has_filename()) folder = folder.parent_path();
    m_prefix = (folder / folder.filename()).string() + "_";
    make_folder(folder.string());
    m_lock.emplace(folder.string(), O_RDONLY | O_DIRECTORY);
    if (start == CacheStart::anew && fs::exists(file(0)))
        throw LoadError(file(0), "", "is there already",
                        "remove the files of the earlier sequence, give another folder, or go on "
                        "with it");
}

std::string ObjSequence::file(int frame) const {
    char number[32];
    std::snprintf(number, sizeof number, "%04d.obj", frame + 1);
    return m_prefix + number;
}

void ObjSequence::write(int frame, const Points& x) {
    m_mesh.vertices = x;
    const std::string path = file(frame);
    if (!fs::exists(path)) return save_obj(path, m_mesh);
    const std::string again = path + ".again";
    save_obj(again, m_mesh);
    const bool same = read_file(again) == read_file(path);
    std::error_code ignored;
    fs::remove(again, ignored);
    if (!same)
        throw LoadError(path, "", "it differs from what is computed now",
                        "go on with the settings, program and machine that it was begun with, or "
                        "begin it anew");
}

}  // namespace cloth
