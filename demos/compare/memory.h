#pragma once

namespace cloth {

/// Resident memory of this process (MB of 1e6 bytes); NaN where /proc does not tell.
double resident_memory_mb();

/// Highest resident memory since the last reset (MB).
double peak_memory_mb();

/// Starts a new measurement of the peak.
void reset_peak_memory();

}  // namespace cloth
