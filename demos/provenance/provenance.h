#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace cloth {

/// Commit of the sources that this program was built from, in ten digits: "0123456789", with
/// "-dirty" where sources had been changed since; "unknown" for sources outside git. Pages (*.md)
/// and figures do not count as sources.
std::string build_commit();

/// The processor's name and number of cores.
std::string machine_name();

/// Where the figures of a report are from: {"commit", "machine", "threads", "date"}, the date as
/// 2026-12-31, in UTC. Every report that figures in the documentation are taken from has this as
/// its member "provenance".
nlohmann::ordered_json provenance_json(int threads);

}  // namespace cloth
