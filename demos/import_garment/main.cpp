// import_garment: a garment that can be simulated, of somebody's mesh. See --help.
#include <cstdio>

#include "demos/compare/command_line.h"
#include "demos/import_garment/import.h"

int main(int argc, char** argv) {
    return cloth::run_program(argc, argv, [argv](const std::vector<std::string>& arguments) {
        cloth::ImportOptions options = cloth::parse_import_options(arguments);
        const std::string self = argv[0];
        options.programs = self.substr(0, self.rfind('/') + 1);
        std::printf("%s", cloth::import_file(options).text.c_str());
    });
}
