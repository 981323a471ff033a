#pragma once

#include <stdexcept>
#include <string>

namespace cloth {

/// A file cannot be used. The message names the file, the place in it, the problem and the remedy.
class LoadError : public std::runtime_error {
 public:
    LoadError(const std::string& file, const std::string& place, const std::string& problem,
              const std::string& remedy)
        : std::runtime_error(file + (place.empty() ? "" : ", " + place) + ": " + problem +
                             ". Remedy: " + remedy) {}
};

/// An argument cannot be used. The message names the argument or object, the problem, the remedy.
class ArgumentError : public std::invalid_argument {
 public:
    ArgumentError(const std::string& argument, const std::string& problem,
                  const std::string& remedy)
        : std::invalid_argument(argument + ": " + problem + ". Remedy: " + remedy) {}
};

}  // namespace cloth
