#include "data/files/usd_writer.h"

#include <cctype>
#include <cstdio>
#include <filesystem>

#include "data/files/cache_format.h"

namespace cloth {
namespace {

const char* const closing_brackets = "    }\n}\n";

/// Names in a scene are letters, digits and underscores, and begin with no digit.
std::string prim_name(const std::string& path) {
    std::string name = std::filesystem::path(path).stem().string();
    for (char& c : name)
        if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
    if (name.empty() || std::isdigit(static_cast<unsigned char>(name[0]))) name = "_" + name;
    return name;
}

/// Nine digits tell every float from every other.
std::string text_of(double number) {
    char digits[32];
    std::snprintf(digits, sizeof digits, "%.9g", static_cast<double>(static_cast<float>(number)));
    return digits;
}

std::string text_of(const Points& x) {
    std::string text = "[";
    for (Eigen::Index i = 0; i < x.rows(); ++i)
        text += (i == 0 ? "(" : ", (") + text_of(x(i, 0)) + ", " + text_of(x(i, 1)) + ", " +
                text_of(x(i, 2)) + ")";
    return text + "]";
}

std::string repeated(const std::string& item, Eigen::Index count) {
    std::string text;
    for (Eigen::Index i = 0; i < count; ++i) text += (i == 0 ? "" : ", ") + item;
    return text;
}

std::string corners_of(const Faces& faces) {
    std::string text;
    for (Eigen::Index f = 0; f < faces.rows(); ++f)
        for (Eigen::Index k = 0; k < 3; ++k)
            text += (text.empty() ? "" : ", ") + std::to_string(faces(f, k));
    return text;
}

std::string header(const std::string& name, const TriMesh& mesh, const CacheSettings& settings) {
    char rate[32];
    std::snprintf(rate, sizeof rate, "%.17g", settings.rate);
    return "#usda 1.0\n(\n    defaultPrim = \"" + name +
           "\"\n    endTimeCode = " + std::to_string(settings.frames - 1) +
           "\n    framesPerSecond = " + rate +
           "\n    metersPerUnit = 1\n    startTimeCode = 0\n    timeCodesPerSecond = " + rate +
           "\n    upAxis = \"Y\"\n)\n\ndef Mesh \"" + name +
           "\"\n{\n    int[] faceVertexCounts = [" + repeated("3", mesh.faces.rows()) +
           "]\n    int[] faceVertexIndices = [" + corners_of(mesh.faces) +
           "]\n    uniform token subdivisionScheme = \"none\"\n    point3f[] points = " +
           text_of(mesh.vertices) + "\n    point3f[] points.timeSamples = {\n";
}

}  // namespace

UsdWriter::UsdWriter(const std::string& path, const TriMesh& mesh, const CacheSettings& settings,
                     CacheStart start)
    : CacheWriter(path, mesh.vertices.rows(), settings),
      m_file(unfinished_cache(path), start, closing_brackets) {
    m_file.write(header(prim_name(path), mesh, settings), "header");
}

void UsdWriter::write(int frame, const Points& x) {
    m_file.write("        " + std::to_string(frame) + ": " + text_of(x) + ",\n",
                 "frame " + std::to_string(frame));
}

}  // namespace cloth
