#include "demos/compare/arguments.h"

#include <cstdlib>
#include <sstream>

namespace cloth {

std::vector<std::string> split_list(const std::string& list) {
    std::vector<std::string> items;
    std::stringstream stream(list);
    for (std::string item; std::getline(stream, item, ',');)
        if (!item.empty()) items.push_back(item);
    return items;
}

std::string join_list(const std::vector<std::string>& items, const std::string& separator) {
    std::string list;
    for (const std::string& item : items) list += (list.empty() ? "" : separator) + item;
    return list;
}

int whole_number(const std::string& option, const std::string& text, int lowest, int highest) {
    size_t used = 0;
    int value = 0;
    try {
        value = std::stoi(text, &used);
    } catch (const std::exception&) {
        used = 0;
    }
    if (used != text.size() || text.empty() || value < lowest || value > highest)
        throw UsageError(option + " " + text + ": give a whole number from " +
                         std::to_string(lowest) + " to " + std::to_string(highest));
    return value;
}

double number_in_range(const std::string& option, const std::string& text, double lowest,
                       double highest) {
    char* end = nullptr;
    const double value = std::strtod(text.c_str(), &end);
    if (text.empty() || *end != '\0' || !(value >= lowest && value <= highest)) {
        std::ostringstream message;
        message << option << " " << text << ": give a number from " << lowest << " to " << highest;
        throw UsageError(message.str());
    }
    return value;
}

}  // namespace cloth
