#pragma once

#include <stdexcept>
#include <string>
#include <vector>

namespace cloth {

/// The command line is wrong: the message is what the user shall read.
class UsageError : public std::runtime_error {
 public:
    using std::runtime_error::runtime_error;
};

/// The command line asks for help, which is the message.
class HelpText : public UsageError {
 public:
    using UsageError::UsageError;
};

/// The items of a list with commas between them; empty ones are left out.
std::vector<std::string> split_list(const std::string& list);

/// The list with `separator` between its items.
std::string join_list(const std::vector<std::string>& items, const std::string& separator = ",");

/// @throws UsageError naming option and range if `text` is no whole number from lowest to highest
int whole_number(const std::string& option, const std::string& text, int lowest, int highest);

/// @throws UsageError naming option and range if `text` is no number from lowest to highest, as NaN
double number_in_range(const std::string& option, const std::string& text, double lowest,
                       double highest);

}  // namespace cloth
