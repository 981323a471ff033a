#include "data/files/ply_length.h"

#include "data/core/errors.h"
#include "data/core/printable.h"
#include "data/core/read_file.h"
#include "data/files/ply_layout.h"

namespace cloth {

void check_ply_length(const std::string& path) {
    const std::string text = read_file(path);
    const PlyLayout layout = read_ply_layout(path, text);
    PlyCursor cursor(text, layout);
    for (const PlyElement& element : layout.elements)
        for (long row = 0; row < element.count; ++row)
            for (const PlyProperty& property : element.properties)
                if (!cursor.skip(property))
                    throw LoadError(path, printable(element.name) + " " + std::to_string(row),
                                    "the file ends too early",
                                    "it is truncated: export or download it again");
}

}  // namespace cloth
