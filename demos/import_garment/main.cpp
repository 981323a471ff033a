// import_garment: a garment that can be simulated, of somebody's mesh. See --help.
#include <cstdio>

#include "demos/compare/command_line.h"
#include "demos/import_garment/import.h"

int main(int argc, char** argv) {
    return cloth::run_program(argc, argv, [](const std::vector<std::string>& arguments) {
        const cloth::ImportOptions options = cloth::parse_import_options(arguments);
        std::printf("%s", cloth::import_file(options).text.c_str());
    });
}
