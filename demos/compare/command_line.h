#pragma once

#include <functional>
#include <string>
#include <vector>

namespace CLI {
class App;
class Option;
}  // namespace CLI

/// What the programs of this folder add to CLI11, whose header is heavy: their parsers alone
/// include it.
namespace cloth {

/// To be called before options are added. Of an option that is given twice the last one counts, so
/// that scripts can hand on what their user adds.
void set_up(CLI::App& app);

/// An option whose value is a whole number. @param value  kept if the option is not given
CLI::Option* add_whole_number(CLI::App& app, const std::string& name, int& value, int lowest,
                              int highest, const std::string& description);

/// An option whose value is a number. @param value  kept if the option is not given
CLI::Option* add_number(CLI::App& app, const std::string& name, double& value, double lowest,
                        double highest, const std::string& description);

/// The option --rate: frames and steps per second, of which 1/240 s is a whole part.
CLI::Option* add_rate(CLI::App& app, int& rate);

/// An option whose value is a list with commas, which must not be empty.
/// @param items  kept if the option is not given
CLI::Option* add_list(CLI::App& app, const std::string& name, std::vector<std::string>& items,
                      const std::string& description);

/// The option --garment; its value is not checked here. The description is followed by a list of
/// the garments there are.
/// @param garment  kept if the option is not given
CLI::Option* add_garment(CLI::App& app, std::string& garment, const std::string& description);

/// The option --body, see body_named(); its value is not checked here.
/// @param body  kept if the option is not given
CLI::Option* add_body(CLI::App& app, std::string& body);

/// An option that people look for here and that other programs have: who gives it is told `hint`.
void add_hint(CLI::App& app, const std::string& name, const std::string& hint);

/// @throws UsageError if the command line is wrong, HelpText if it asks for help
void parse(CLI::App& app, const std::vector<std::string>& arguments);

/// What main() of a program does: runs it, and prints errors or the help that was asked for.
/// @return  its exit status
int run_program(int argc, char** argv,
                const std::function<void(const std::vector<std::string>& arguments)>& program);

}  // namespace cloth
