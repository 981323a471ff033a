#include "demos/compare/command_line.h"

#include <CLI/CLI.hpp>
#include <cstdio>

#include "data/files/garment_assets.h"
#include "demos/compare/arguments.h"

namespace cloth {

void set_up(CLI::App& app) {
    app.option_defaults()->take_last();
    app.get_formatter()->column_width(26);
}

/// @param parse  throws UsageError; CLI11 says of 2.5 that it is not in a range, and takes NaN
template <typename Number>
CLI::Option* add_in_range(CLI::App& app, const std::string& name, Number& value, Number lowest,
                          Number highest, const std::string& description,
                          Number (*parse)(const std::string&, const std::string&, Number, Number)) {
    const auto check = [=](const std::string& text) {
        parse(name, text, lowest, highest);
        return std::string();
    };
    return app.add_option(name, value, description)->check(check)->type_name("N");
}

CLI::Option* add_whole_number(CLI::App& app, const std::string& name, int& value, int lowest,
                              int highest, const std::string& description) {
    return add_in_range(app, name, value, lowest, highest, description, whole_number);
}

CLI::Option* add_number(CLI::App& app, const std::string& name, double& value, double lowest,
                        double highest, const std::string& description) {
    return add_in_range(app, name, value, lowest, highest, description, number_in_range);
}

CLI::Option* add_rate(CLI::App& app, int& rate) {
    return app.add_option("--rate", rate, "frames per second, and steps: 30 (default), 60 or 120")
        ->check(CLI::IsMember({30, 60, 120}).description(""))
        ->type_name("HZ");
}

CLI::Option* add_list(CLI::App& app, const std::string& name, std::vector<std::string>& items,
                      const std::string& description) {
    const auto read = [name, &items](const std::string& text) {
        items = split_list(text);
        if (items.empty()) throw CLI::ValidationError(name, "name at least one");
    };
    return app.add_option_function<std::string>(name, read, description)->type_name("A,B,...");
}

CLI::Option* add_garment(CLI::App& app, std::string& garment, const std::string& description) {
    std::string text = description + "; a+b: a worn over b; a mesh file; or one of", line;
    for (const std::string& name : garment_names()) {
        if (line.size() + name.size() > 60) {
            text += "\n" + line;
            line.clear();
        }
        line += (line.empty() ? "" : ", ") + name;
    }
    return app.add_option("--garment", garment, text + "\n" + line)->type_name("NAME");
}

CLI::Option* add_body(CLI::App& app, std::string& body) {
    return app
        .add_option("--body", body,
                    "that wears it: default, slight, heavy, or a number, of which each is\n"
                    "a sampled shape; all but the first need the shared data")
        ->type_name("NAME");
}

void add_hint(CLI::App& app, const std::string& name, const std::string& hint) {
    app.add_option_function<std::string>(
           name, [name, hint](const std::string&) { throw CLI::ValidationError(name, hint); })
        ->group("");  // --help leaves it out
}

void parse(CLI::App& app, const std::vector<std::string>& arguments) {
    try {
        app.parse(std::vector<std::string>(arguments.rbegin(), arguments.rend()));
    } catch (const CLI::CallForHelp&) {
        throw HelpText(app.help());
    } catch (const CLI::ExtrasError&) {
        throw UsageError("unknown option " + app.remaining().front() + "; see --help");
    } catch (const CLI::ParseError& error) {
        throw UsageError(std::string(error.what()) + "; see --help");
    }
}

int run_program(int argc, char** argv,
                const std::function<void(const std::vector<std::string>& arguments)>& program) {
    try {
        program(std::vector<std::string>(argv + 1, argv + argc));
        return 0;
    } catch (const HelpText& help) {
        std::printf("%s", help.what());
        return 0;
    } catch (const std::exception& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return 1;
    }
}

}  // namespace cloth
